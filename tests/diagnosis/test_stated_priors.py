"""Priors take what the experiments state; where they state nothing, or not the same, the catalogue holds."""

from math import radians, tan

import numpy as np
import pytest
from plausible_experiment import experiment
from toy_laboratory import ToyRunner, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.levels import closures_of
from fvcollapse.diagnosis.library import build_library
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.stated_priors import priors_of
from fvcollapse.effects.catalogue import CATALOGUE

ANGLES = {"material__repose_angle_deg": 22.0, "material__avalanche_angle_deg": 27.4}


def test_a_stated_wall_friction_is_the_centre_of_its_prior():
    slot = experiment(material__mu_wall=0.46, uncertainty__mu_wall=0.03)
    priors = priors_of("lateral_friction", (slot,))
    assert priors["mu_wall"][:3] == ("normal", 0.46, 0.03)
    others = {name: prior for name, prior in priors.items() if name != "mu_wall"}
    assert others.items() <= CATALOGUE["lateral_friction"].priors.items()
    for closure in closures_of("lateral_friction", (slot,)):
        middle = closure.values(np.full(len(closure.parameters), 0.5))
        assert middle["mu_wall"] == pytest.approx(0.46)


def test_the_default_standard_deviation_of_a_stated_friction_holds():
    priors = priors_of("lateral_friction", (experiment(material__mu_wall=0.2),))
    assert priors["mu_wall"][:3] == ("normal", 0.2, 0.02)


def test_angles_of_repose_and_avalanche_tell_the_strength_at_rest():
    prior = priors_of("friction_hysteresis", (experiment(**ANGLES),))["delta_mu"]
    assert prior.kind == "normal"
    assert prior.first == pytest.approx(tan(radians(27.4)) - tan(radians(22.0)))
    rng = np.random.default_rng(1)
    stop, start = np.radians(np.array([[22.0], [27.4]]) + 0.5 * rng.standard_normal((2, 40000)))
    assert prior.second == pytest.approx(np.std(np.tan(start) - np.tan(stop)), rel=0.02)


def test_strengths_are_never_negative():
    """Angles as near as their errors, and a smooth wall: a uniform prior from zero."""
    near = experiment(material__repose_angle_deg=23.5, material__avalanche_angle_deg=23.9)
    smooth = experiment(material__mu_wall=0.01)
    for effect, parameter, one in (
        ("friction_hysteresis", "delta_mu", near),
        ("lateral_friction", "mu_wall", smooth),
    ):
        prior = priors_of(effect, (one,))[parameter]
        assert (prior.kind, prior.first) == ("uniform", 0.0)
        assert prior.distribution().ppf(0.002) >= 0.0


def test_one_angle_alone_and_no_statement_leave_the_catalogue():
    one = experiment(material__repose_angle_deg=22.0)
    for effect in ("lateral_friction", "friction_hysteresis", "gate"):
        assert priors_of(effect, (one,)) == CATALOGUE[effect].priors
        assert priors_of(effect) == CATALOGUE[effect].priors


def test_experiments_that_disagree_leave_the_catalogue():
    rough, smooth = experiment(material__mu_wall=0.46), experiment(material__mu_wall=0.2)
    silent = experiment()
    catalogue = CATALOGUE["lateral_friction"].priors
    assert priors_of("lateral_friction", (rough, rough))["mu_wall"].first == 0.46
    assert priors_of("lateral_friction", (rough, smooth)) == catalogue
    assert priors_of("lateral_friction", (rough, silent)) == catalogue


def test_levels_of_a_diagnosis_follow_what_is_stated(tmp_path):
    place = film(tmp_path / "slot", 16.0, 0.1)
    silent = load_experiment(place)
    text = (place / "experiment.toml").read_text()
    (place / "experiment.toml").write_text(
        text.replace("mu_1 = 0.45", "mu_1 = 0.45\nmu_wall = 0.4")
    )
    stated = load_experiment(place)
    spans = []
    for one in (silent, stated):
        runner = ToyRunner()
        library = build_library(Question((one,)), runner, ("lateral_friction",), 4)
        closure = library.closures["lateral_friction"][0]
        spans.append([closure.values(u)["mu_wall"] for u in closure.levels()])
    assert 0.15 <= min(spans[0]) < max(spans[0]) <= 0.30
    assert 0.36 < min(spans[1]) < max(spans[1]) < 0.44
