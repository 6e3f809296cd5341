"""The catalogue and the case file name the same effects; an effect of zero strength is no effect."""

from functools import lru_cache
from pathlib import Path
from typing import get_type_hints

import pytest
from effect_runs import collapse, same_to_the_last_bit

from fvcollapse.case.case import Case, Effects, describe_keys
from fvcollapse.effects import catalogue
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE, OBSERVATION, PHYSICAL

KEYS = {info.name for info in describe_keys()}
# the settings with which each effect does nothing
ZERO_CASES = [(name, keys) for name, effect in CATALOGUE.items() for keys in effect.zero]


def test_catalogue_and_case_name_the_same_effects():
    assert set(CATALOGUE) == set(get_type_hints(Effects))


@pytest.mark.parametrize("name", CATALOGUE)
def test_an_effect_describes_its_own_keys(name):
    effect = CATALOGUE[name]
    assert effect.name == name
    assert effect.zero
    assert set(effect.seen_keys) <= set(effect.section.__struct_fields__)
    assert bool(effect.seen_keys) == (effect.see is not None)
    assert effect.only_seen or effect.kind != OBSERVATION


def test_the_catalogue_names_every_file():
    folder = Path(catalogue.__file__).parent
    files = {path.stem for path in folder.glob("[a-z]*.py")}
    assert files - {"catalogue", "conditions", "effect", "table", "template"} == set(CATALOGUE)


@pytest.mark.parametrize("name", CATALOGUE)
def test_priors_are_of_keys_and_within_their_limits(name):
    effect = CATALOGUE[name]
    assert effect.kind in (PHYSICAL, OBSERVATION, NUISANCE)
    assert set(effect.absorbed_in) <= KEYS
    for parameter, prior in effect.priors.items():
        assert f"effects.{name}.{parameter}" in KEYS
        assert prior.grade in ("A", "A2", "comp", "C")
        assert prior.source
        assert (prior.at(0.1) < prior.at(0.9)) == (prior.strong_end == "high")


@pytest.mark.parametrize("slope", [0.0, 16.0, 22.0])
@pytest.mark.parametrize("strength", [0.02, 0.5, 0.98])
@pytest.mark.parametrize("name", CATALOGUE)
def test_every_strength_of_every_variant_is_a_case(name, strength, slope):
    """A value outside the limits of its key would be refused."""
    for variant in CATALOGUE[name].variants:
        keys = CATALOGUE[name].keys(strength, variant)
        changes = {f"effects.{name}": keys, "geometry.slope_angle_deg": slope}
        effect = getattr(Case().replace(**changes).effects, name)
        assert all(getattr(effect, key) == value for key, value in keys.items())


@pytest.mark.parametrize("name", CATALOGUE)
def test_variants_name_keys(name):
    for variant in CATALOGUE[name].variants:
        assert {f"effects.{name}.{key}" for key in variant} <= KEYS


@lru_cache
def baseline(law):
    return collapse(0.12, rheology__law=law)


@pytest.mark.parametrize("law", ["mu_I", "drucker_prager"])
@pytest.mark.parametrize(("name", "keys"), ZERO_CASES)
def test_zero_strength_is_the_baseline_to_the_last_bit(name, keys, law):
    run = collapse(0.12, **{f"effects__{name}": keys, "rheology__law": law})
    assert same_to_the_last_bit(run, baseline(law))


def test_no_effect_leaves_the_case_itself():
    case = Case().replace(**{"effects.lateral_friction": {}})
    assert case.resolved is case


@pytest.mark.parametrize(("name", "keys"), ZERO_CASES)
def test_a_change_of_keys_is_applied_once(name, keys):
    case = Case().replace(**{f"effects.{name}": keys}).resolved
    assert case.resolved == case
