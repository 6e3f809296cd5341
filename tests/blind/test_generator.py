"""What is hidden: reproducible from its seed, possible in the solver, and strange to the training suite."""

import json
from collections import Counter

import numpy as np
import pytest

from fvcollapse.blind.causes import (
    BLIND,
    TRAINING,
    dealt,
    draw_classes,
    draw_effect,
    known_effects,
)
from fvcollapse.blind.generator import (
    NoDrawError,
    draw_fitting_label,
    draw_label,
    drawn_world,
)
from fvcollapse.blind.outside import UNKNOWNS
from fvcollapse.blind.set_ups import LABORATORIES, SET_UPS, STATEMENTS, settings_text
from fvcollapse.blind.worlds import KINDS, SLIGHT, STRONG
from fvcollapse.case.case import case_from_text
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.experiment import load_experiment

STYLES = {"training": TRAINING, "blind": BLIND}
CAUSES = (NONE, UNKNOWN, *known_effects(), "cohesion+gate")


def world_without(cause, style, seed):
    """A world that has no effect of a cause itself."""
    while True:
        world = drawn_world("world_01", style, seed)
        if not set(cause.split("+")) & set(world["effects"]):
            return world
        seed += 1000


def labels_of(cause, style, seeds, design=None):
    """Labels of a cause, each in a world of its own."""
    return [
        draw_label(cause, style, seed, world_without(cause, style, seed), design) for seed in seeds
    ]


@pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
@pytest.mark.parametrize("cause", CAUSES)
def test_every_cause_makes_cases_that_the_solver_accepts(cause, style):
    for label in labels_of(cause, style, range(5)):
        assert label["cause"] == cause
        assert set(label["effects"]) == ({*cause.split("+")} - {NONE, UNKNOWN})
        own = set(label["world"]["effects"])
        hidden = [(each, own | set(label["effects"])) for each in label["experiments"].values()]
        hidden += [(each, own) for each in label["world"]["controls"].values()]
        for each, expected in hidden:
            case = case_from_text(each["case"])
            acting = {name for name in CATALOGUE if getattr(case.effects, name) is not None}
            assert acting == expected


def test_two_effects_that_no_draw_joins_in_a_world_are_replaced_by_two_others():
    """Adhesion wants implicit friction of the walls; these worlds draw the split one, or what thin layers exclude."""
    pair, seed = "cohesion+lateral_friction", 0
    while (world := drawn_world("world_01", BLIND, seed))["effects"].keys() != {"thin_layer"}:
        seed += 1
    with pytest.raises(NoDrawError, match="cohesion.lateral_friction do not fit together"):
        draw_label(pair, BLIND, 7, world)
    label = draw_fitting_label(pair, BLIND, 7, world)
    assert draw_fitting_label(pair, BLIND, 7, world) == label
    assert "+" in label["cause"]
    assert label["cause"] != pair
    assert set(label["effects"]) == set(label["cause"].split("+"))
    assert "thin_layer" not in label["effects"]
    assert draw_fitting_label("gate", BLIND, 7, world) == draw_label("gate", BLIND, 7, world)


def test_a_label_is_a_function_of_its_seed_and_survives_json():
    world = drawn_world("world_01", BLIND, 3)
    assert drawn_world("world_01", BLIND, 3) == world
    assert drawn_world("world_01", BLIND, 4) != world
    label = draw_label("gate", BLIND, 7, world)
    assert draw_label("gate", BLIND, 7, world) == label
    assert json.loads(json.dumps(label)) == label
    assert draw_label("gate", BLIND, 8, world) != label


def test_every_kind_of_unknown_is_drawn_in_its_own_suite_only():
    kinds = {
        name: {label["unknown_kind"] for label in labels_of(UNKNOWN, style, range(80))}
        for name, style in STYLES.items()
    }
    assert kinds == {name: set(style.unknowns) for name, style in STYLES.items()}
    assert kinds["training"] | kinds["blind"] == set(UNKNOWNS)
    assert not kinds["training"] & kinds["blind"]


def test_training_and_blind_suite_share_no_grid_regularisation_or_closure():
    assert max(TRAINING.cells) < min(BLIND.cells)
    assert min(TRAINING.shear_rate_min) >= max(BLIND.shear_rate_min)
    for name, effect in CATALOGUE.items():
        rng = np.random.default_rng(0)
        drawn = [{draw_effect(name, s, rng)["closure"] for _ in range(60)} for s in STYLES.values()]
        if len(effect.variants) > 1:
            assert not drawn[0] & drawn[1]
            assert drawn[0] | drawn[1] == set(range(len(effect.variants)))


def test_training_and_blind_worlds_share_no_physics_and_no_set_up():
    assert not set(TRAINING.worlds) & set(BLIND.worlds)
    assert set(TRAINING.worlds) | set(BLIND.worlds) == set(KINDS)
    places = [{name for design in style.designs for name in design} for style in (TRAINING, BLIND)]
    assert not places[0] & places[1]
    assert places[0] | places[1] == set(SET_UPS)


@pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
def test_worlds_are_slight_or_strong_and_have_one_to_four_controls(style):
    worlds = [drawn_world("world_01", style, seed) for seed in range(200)]
    assert {world["strength"] for world in worlds} == {SLIGHT, STRONG}
    assert {len(world["controls"]) for world in worlds} == {1, 2, 3, 4}
    assert {world["statement"] for world in worlds} == set(LABORATORIES)
    assert {kind for world in worlds for kind in world["kinds"]} == set(style.worlds)
    assert all(world["kinds"] for world in worlds if world["strength"] == STRONG)
    assert all(bool(world["common"]) == STATEMENTS[world["statement"]].common for world in worlds)


def test_nuisances_have_the_standard_deviations_that_are_stated():
    labels = labels_of(NONE, BLIND, range(400))
    mu_1 = [label["world"]["material"]["rheology.mu_1"] for label in labels]
    assert np.mean(mu_1) == pytest.approx(0.44, abs=0.003)
    assert np.std(mu_1) == pytest.approx(0.015, rel=0.15)
    for statement in LABORATORIES:
        about = STATEMENTS[statement]
        slopes = [
            case_from_text(each["case"]).geometry.slope_angle_deg - SET_UPS[name].slope
            for label in labels
            if label["world"]["statement"] == statement
            for name, each in label["experiments"].items()
        ]
        assert np.std(slopes) == pytest.approx(about.sd["geometry.slope_angle_deg"], rel=0.2)


def test_the_runs_of_a_world_share_grains_and_numerics_and_one_tank_its_errors():
    for statement in LABORATORIES:
        about = STATEMENTS[statement]
        label = next(
            label
            for label in labels_of(NONE, BLIND, range(40))
            if len(label["experiments"]) > 2 and label["world"]["statement"] == statement
        )
        runs = label["experiments"] | label["world"]["controls"]
        cases = [case_from_text(each["case"]) for each in runs.values()]
        assert len({case.rheology for case in cases}) == 1
        assert len({case.numerics for case in cases}) == 1
        speeds = {case.gate.speed for case in cases}
        assert len(speeds) == (1 if about.common else len(cases))


def test_causes_are_dealt_to_worlds_that_do_not_have_them():
    hidden = [("gate",), ("gate",), (), ("cohesion",), ()]
    causes = ["gate", "cohesion+gate", "none", "cohesion", "none"]
    found = dealt(causes, hidden)
    assert sorted(found) == sorted(causes)
    assert not any(
        set(cause.split("+")) & set(own) for cause, own in zip(found, hidden, strict=True)
    )


def test_classes_of_a_suite():
    counts = Counter()
    for seed in range(10):
        classes = draw_classes(220, np.random.default_rng(seed))
        assert len(classes) == 220
        assert classes.count(NONE) >= 60
        assert classes.count(UNKNOWN) >= 37
        counts.update(classes)
    assert set(known_effects()) <= set(counts)
    assert any("+" in name for name in counts)
    for name in counts:
        assert name == "+".join(sorted(name.split("+")))


def test_a_suite_of_one_case_is_possible():
    assert len(draw_classes(1, np.random.default_rng(0))) == 1


@pytest.mark.parametrize("name", SET_UPS)
def test_what_is_stated_is_an_experiment(name, tmp_path):
    folder = tmp_path / name
    folder.mkdir()
    (folder / "experiment.toml").write_text(settings_text(SET_UPS[name], "careful"))
    (folder / "front.csv").write_text("t_s,x_front_m\n0,0.2\n0.1,0.3\n")
    experiment = load_experiment(folder)
    case = experiment.case()
    assert case.geometry.slope_angle_deg == SET_UPS[name].slope
    assert case.rheology.mu_1 == 0.44
    assert experiment.standard_deviation("mu_1") == 0.015
    assert not any(getattr(case.effects, effect) for effect in CATALOGUE)
    assert not experiment.has_common("height_0")
    (folder / "experiment.toml").write_text(settings_text(SET_UPS[name], "one_tank"))
    assert load_experiment(folder).has_common("height_0")
