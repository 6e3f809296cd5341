"""Scores against numbers worked out by hand."""

import numpy as np
import pytest

from fvcollapse.blind.calibration import calibration, calibration_error, risk_coverage, sharpness
from fvcollapse.blind.comparisons import mcnemar, parameter_scores, reduction_scores
from fvcollapse.blind.metrics import alarms, by_class, confusion, ranking, right_answers
from fvcollapse.blind.outcomes import Outcome, credit, share
from fvcollapse.diagnosis.names import UNKNOWN


def outcome(truth, verdict="effect", names=(), kind=None, **probability):
    named = {name.replace("_and_", "+"): p for name, p in probability.items()}
    return Outcome(truth, kind, verdict, named, tuple(names))


def test_one_of_two_causes_earns_half():
    assert credit("cohesion+gate", "cohesion+gate") == 1.0
    assert credit("cohesion+gate", "gate") == 0.5
    assert credit("gate", "cohesion+gate") == 0.0
    assert credit("gate", "gate") == 1.0
    one = outcome("cohesion+gate", gate=0.6, none=0.4)
    assert ranking([one])["top_1"]["value"] == 0.5


def test_first_two_names_and_sets():
    outcomes = [
        outcome("gate", gate=0.5, cohesion=0.3, none=0.2, names=("gate",)),
        outcome("cohesion", gate=0.5, cohesion=0.3, none=0.2, names=("gate", "none", "cohesion")),
        outcome("none", gate=0.5, cohesion=0.3, none=0.2, names=("gate",)),
        outcome("unknown", "unknown", gate=0.6, unknown=0.4, names=()),
    ]
    scores = ranking(outcomes)
    assert scores["top_1"]["value"] == 0.25
    assert scores["top_2"]["value"] == 0.75
    assert scores["set_holds_truth"]["value"] == 0.75  # an empty set says unknown
    assert scores["mean_set_size"]["value"] == 1.5


def test_right_answers_of_each_kind():
    """The answer counts, not the most probable cause: none may be the answer where an effect is more probable."""
    found = right_answers(
        [
            outcome("none", "none", gate=0.6, none=0.4, names=("gate", "none")),
            outcome("gate", "none", gate=0.6, none=0.4, names=("gate", "none")),
            outcome("gate", "effect", unknown=0.5, gate=0.5, names=("gate",)),
            outcome("cohesion+gate", "effect", gate=1.0, names=("gate",)),
            outcome("none", "effect", gate=1.0, names=("gate",)),
        ]
    )
    assert found["none"]["value"] == 0.5
    assert found["named"]["value"] == pytest.approx(0.5)
    assert found["named"]["n"] == 3
    assert UNKNOWN not in found


def test_equal_probabilities_earn_what_the_worst_order_earns():
    assert ranking([outcome("gate", gate=0.5, none=0.5)])["top_1"]["value"] == 0.0


def test_intervals_of_clopper_and_pearson():
    found = share([1] * 8 + [0] * 2)
    assert found["value"] == 0.8
    assert (found["low"], found["high"]) == pytest.approx((0.4439, 0.9748), abs=1e-4)
    none = share([0] * 60)
    assert none["high"] == pytest.approx(0.0596, abs=1e-4)
    assert share([])["value"] is None


def test_alarms_and_the_fate_of_the_unknown():
    found = alarms(
        [
            outcome("none", "none", none=1.0),
            outcome("none", "unknown", unknown=1.0),
            outcome("none", "effect", gate=1.0),
            outcome("unknown", "unknown", kind="drag", unknown=1.0),
            outcome("unknown", "effect", kind="strip", gate=1.0),
            outcome("unknown", "none", kind="strip", none=1.0),
        ]
    )
    assert found["false_alarm_on_none"]["value"] == pytest.approx(2 / 3)
    assert found["effect_named_on_none"]["value"] == pytest.approx(1 / 3)
    assert found["unknown"]["found"]["value"] == pytest.approx(1 / 3)
    assert found["unknown_by_kind"]["drag"]["found"]["value"] == 1.0
    assert found["unknown_by_kind"]["strip"]["wrongly_named"]["value"] == 0.5


def test_brier_and_log_score():
    outcomes = [outcome("gate", gate=0.7, none=0.3), outcome("none", gate=0.4, none=0.6)]
    scores = sharpness(outcomes)
    assert scores["brier"]["value"] == pytest.approx(0.5 * (0.18 + 0.32))
    assert scores["log_score"]["value"] == pytest.approx(-0.5 * np.log(0.7 * 0.6))
    assert scores["brier_skill"]["value"] == pytest.approx(1.0 - 0.25 / 0.5)


def test_a_truth_without_a_probability_is_punished_but_not_without_end():
    scores = sharpness([outcome("cohesion+gate", gate=1.0), outcome("gate", gate=1.0)])
    assert scores["brier"]["value"] == 1.0
    assert scores["log_score"]["value"] == pytest.approx(-0.5 * np.log(1e-4))


def test_calibration_error_of_two_bins():
    confidence, right = np.array([0.9, 0.9, 0.3, 0.3]), np.array([1.0, 0.0, 0.0, 0.0])
    assert calibration_error(confidence, right, 5) == pytest.approx(0.5 * 0.4 + 0.5 * 0.3)


def test_a_perfect_diagnosis_is_within_its_own_floor_and_a_boaster_is_not():
    rng = np.random.default_rng(0)
    honest, boaster = [], []
    for p in rng.uniform(0.5, 0.95, 120):
        truth = "gate" if rng.random() < p else "none"
        honest.append(outcome(truth, gate=p, none=1.0 - p))
        boaster.append(outcome(truth, gate=0.99, none=0.01))
    scores = calibration(honest)
    assert scores["ece_10_bins"]["within_floor"]
    assert scores["ece_10_bins"]["perfect_mean"] == pytest.approx(0.07, abs=0.03)
    scores = calibration(boaster)
    assert not scores["ece_10_bins"]["within_floor"]
    assert scores["confident_errors"]["value"] > 0.1


def test_risk_falls_where_confidence_means_something():
    outcomes = [outcome("gate", gate=0.9, none=0.1)] * 5 + [outcome("none", gate=0.6, none=0.4)] * 5
    rows = risk_coverage(outcomes)
    assert rows[4] == {"coverage": 0.5, "risk": 0.0}
    assert rows[-1] == {"coverage": 1.0, "risk": 0.5}


def test_classes_and_confusion():
    outcomes = [
        outcome("gate", gate=1.0),
        outcome("gate", none=1.0),
        outcome("cohesion+gate", gate=1.0),
    ]
    classes = by_class(outcomes)
    assert classes["single"]["top_1"]["value"] == 0.5
    assert classes["pair"]["top_1"]["value"] == 0.5
    assert set(classes) == {"single", "pair"}
    assert confusion(outcomes)["gate"] == {"gate": 1, "none": 1}


def test_mcnemar_counts_only_where_two_diagnoses_differ():
    good, bad = outcome("gate", gate=1.0), outcome("gate", none=1.0)
    found = mcnemar([good] * 9 + [bad], [good] * 3 + [bad] * 7)
    assert found["only_first"] == 6
    assert found["only_second"] == 0
    assert found["p_value"] == pytest.approx(2.0**-5)
    assert mcnemar([good], [good])["p_value"] == 1.0


def test_parameters_in_units_of_their_uncertainty():
    rng = np.random.default_rng(1)
    rows = []
    for _ in range(200):
        true, error = rng.uniform(), 0.1 * rng.standard_normal()
        value = true + error
        rows.append({"true": true, "value": value, "low": value - 0.1645, "high": value + 0.1645})
    scores = parameter_scores(rows)
    assert scores["z_mean"]["value"] == pytest.approx(0.0, abs=0.2)
    assert scores["z_sd"]["value"] == pytest.approx(1.0, abs=0.15)
    assert scores["interval_90_covers"]["value"] == pytest.approx(0.9, abs=0.05)
    assert parameter_scores([])["z_mean"] is None


def test_predicted_and_actual_reduction():
    rows = [
        {"predicted": 0.5, "actual": 0.6, "runner_up": 0.4},
        {"predicted": 0.2, "actual": 0.3, "runner_up": 0.5},
        {"predicted": 0.9, "actual": 0.5, "runner_up": None},
        {"predicted": None, "actual": 0.5, "runner_up": 0.1},
        {"actual": 1.0, "predicted": 0.88, "winner": 1.0, "runner_up": 1.0}
        | {"winner_left": 0.7, "runner_up_left": 0.9},  # both close all that is beyond the noise
    ]
    scores = reduction_scores(rows)
    assert scores["within_tolerance"]["value"] == pytest.approx(3 / 4)
    assert scores["within_narrow"]["value"] == pytest.approx(2 / 4)
    assert scores["winner_beats_runner_up"]["value"] == pytest.approx(2 / 4)
    left = scores["winner_leaves_less"]
    assert (left["value"], left["n"]) == (1.0, 1)
    assert scores["rms"]["value"] == pytest.approx(np.sqrt((0.01 + 0.01 + 0.16 + 0.0144) / 4))
    assert reduction_scores([])["rms"] is None
