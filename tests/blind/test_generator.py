"""What is hidden: reproducible from its seed, possible in the solver, and strange to the training suite."""

import json
from collections import Counter

import numpy as np
import pytest

from fvcollapse.blind.causes import BLIND, TRAINING, draw_classes, draw_effect, known_effects
from fvcollapse.blind.generator import draw_label
from fvcollapse.blind.outside import UNKNOWNS
from fvcollapse.blind.set_ups import DESIGNS, SET_UPS, settings_text
from fvcollapse.case.case import case_from_text
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.experiment import load_experiment

STYLES = {"training": TRAINING, "blind": BLIND}
CAUSES = (NONE, UNKNOWN, *known_effects(), "cohesion+gate")


@pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
@pytest.mark.parametrize("cause", CAUSES)
def test_every_cause_makes_cases_that_the_solver_accepts(cause, style):
    for seed in range(5):
        label = draw_label(cause, style, seed)
        assert label["cause"] == cause
        for each in label["experiments"].values():
            case = case_from_text(each["case"])
            acting = {name for name in CATALOGUE if getattr(case.effects, name) is not None}
            assert acting == set(label["effects"])
            assert acting == ({*cause.split("+")} - {NONE, UNKNOWN})


def test_a_label_is_a_function_of_its_seed_and_survives_json():
    label = draw_label("gate", BLIND, 7)
    assert draw_label("gate", BLIND, 7) == label
    assert json.loads(json.dumps(label)) == label
    assert draw_label("gate", BLIND, 8) != label


def test_every_kind_of_unknown_is_drawn_in_its_own_suite_only():
    kinds = {
        name: {draw_label(UNKNOWN, style, seed)["unknown_kind"] for seed in range(80)}
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


def test_nuisances_have_the_standard_deviations_that_are_stated():
    labels = [draw_label(NONE, BLIND, seed) for seed in range(400)]
    mu_1 = [label["material"]["rheology.mu_1"] for label in labels]
    assert np.mean(mu_1) == pytest.approx(0.44, abs=0.003)
    assert np.std(mu_1) == pytest.approx(0.015, rel=0.15)
    slopes = [
        case_from_text(each["case"]).geometry.slope_angle_deg - SET_UPS[name].slope
        for label in labels
        for name, each in label["experiments"].items()
        if SET_UPS[name].slope > 0.0
    ]
    assert np.std(slopes) == pytest.approx(0.2, rel=0.15)


def test_the_truths_of_a_case_share_grains_and_grid_but_not_the_set_up():
    label = next(
        label
        for label in (draw_label(NONE, BLIND, seed) for seed in range(20))
        if len(label["experiments"]) > 1
    )
    cases = [case_from_text(each["case"]) for each in label["experiments"].values()]
    assert len({case.rheology for case in cases}) == 1
    assert len({case.grid for case in cases}) == 1
    assert len({case.geometry.height_0 for case in cases}) == len(cases)


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
    (folder / "experiment.toml").write_text(settings_text(name))
    (folder / "front.csv").write_text("t_s,x_front_m\n0,0.2\n0.1,0.3\n")
    experiment = load_experiment(folder)
    case = experiment.case()
    assert case.geometry.slope_angle_deg == SET_UPS[name].slope
    assert case.rheology.mu_1 == 0.44
    assert experiment.standard_deviation("mu_1") == 0.015
    assert not any(getattr(case.effects, effect) for effect in CATALOGUE)


def test_designs_are_made_of_set_ups():
    assert {name for design in DESIGNS for name in design} == set(SET_UPS)
