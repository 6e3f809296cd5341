"""Verdicts: calibrated on cases like the fitted ones, honest about the rest, and never from a pickle."""

import json

import numpy as np
import pytest
from drawn_evidence import CAUSES, EFFECTS, evidence_of, fitted, suite

from fvcollapse.blind.verdict_training import fit
from fvcollapse.diagnosis.evidence import Evidence
from fvcollapse.diagnosis.left import Left
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.separability import Separability
from fvcollapse.diagnosis.verdict import CAP, NONE_RETAINED, capped, verdict
from fvcollapse.diagnosis.verdict_features import (
    CASE_FEATURES,
    class_of,
    features,
    left_over,
    sign_of,
)
from fvcollapse.diagnosis.verdict_model import VerdictModel, class_prior, from_json, to_json
from fvcollapse.errors import InputError


@pytest.fixture(scope="module")
def model():
    return fitted()


@pytest.fixture(scope="module")
def fresh(model):
    return [(cause, verdict(evidence, model)) for evidence, cause in suite(100, 2)]


def test_probabilities_are_calibrated_to_the_stated_prior(fresh, model):
    weight = class_prior(model.classes)
    weights = np.array([weight[class_of(cause)] for cause, _ in fresh])
    top = np.array([max(found.probability.values()) for _, found in fresh])
    right = np.array([next(iter(found.probability)) == cause for cause, found in fresh])
    accuracy = np.average(right, weights=weights)
    assert accuracy > 0.75
    assert accuracy == pytest.approx(np.average(top, weights=weights), abs=0.06)


def test_false_alarms_are_rare_and_sets_hold_the_truth(fresh):
    alarms = [found.kind != NONE for cause, found in fresh if cause == NONE]
    assert np.mean(alarms) <= NONE_RETAINED + 0.06  # 100 cases: two standard deviations of chance
    held = [cause in found.set for cause, found in fresh]
    assert 0.86 <= np.mean(held) <= 0.97
    assert np.mean([len(found.set) for _, found in fresh]) < 2.5


def test_what_was_planted_is_named(fresh):
    for cause, kind in (("dots", "effect"), (UNKNOWN, UNKNOWN), ("arms+bars", "several")):
        found = [each for truth, each in fresh if truth == cause]
        assert np.mean([each.kind == kind for each in found]) > 0.7
    pair = next(each for truth, each in fresh if truth == "arms+bars" and each.kind == "several")
    assert pair.effects == ("arms", "bars")


def test_every_verdict_agrees_with_itself(fresh):
    for _, found in fresh:
        assert sum(found.probability.values()) == pytest.approx(1.0)
        assert {*EFFECTS, NONE, UNKNOWN} <= set(found.probability)
        assert set(found.set) <= set(found.probability)
        assert set(found.conformal) == set(found.probability)
        assert (found.kind == NONE) == (NONE in found.set)
        assert bool(found.effects) == (found.kind in ("effect", "several"))
        shares = list(found.probability.values())
        assert shares == sorted(shares, reverse=True)


def test_no_probability_is_larger_than_the_number_of_cases_supports(model, fresh):
    assert model.cap == pytest.approx(1.0 - 1.0 / (60 * len(CAUSES) + 1))
    assert max(max(found.probability.values()) for _, found in fresh) <= model.cap + 1e-12
    shares = capped({"arms": 0.999, NONE: 0.001, UNKNOWN: 0.0}, 0.9)
    assert shares == pytest.approx({"arms": 0.9, NONE: 0.1, UNKNOWN: 0.0})
    assert capped({"arms": 1.0, NONE: 0.0}, 0.9) == pytest.approx({"arms": 0.9, NONE: 0.1})
    tiny = capped({"arms": 1.0, NONE: 3e-17, UNKNOWN: 1e-17}, 0.9)  # below the round-off of 1
    assert tiny == pytest.approx({"arms": 0.9, NONE: 0.075, UNKNOWN: 0.025})


def test_effects_that_were_not_compared_have_no_probability(model):
    evidence, _ = suite(1, 3)[0]
    kept = ("arms", "bars", NONE, UNKNOWN)
    few = Evidence({name: evidence.hypotheses[name] for name in kept})
    found = verdict(few, model)
    assert set(found.probability) == set(kept)
    assert found.effects == ("arms",)


def test_a_case_like_none_of_the_suite_is_unknown(model):
    strange = evidence_of(dict.fromkeys((*EFFECTS, UNKNOWN), -400.0) | {NONE: -900.0})
    found = verdict(strange, model)
    assert found.kind != NONE
    assert max(found.conformal.values()) < 0.5


def test_features_by_hand():
    logs = {"arms": -1.0, "bars": 0.0, NONE: -3.0, UNKNOWN: -80.0, "arms+bars": 4.0}
    classes = (*EFFECTS, NONE, UNKNOWN, SEVERAL)
    own, case = features(evidence_of(logs, {NONE: 1e-20, "arms+bars": 0.01}, outside=0.5), classes)
    behind = [1.0, 0.0, np.nan, np.nan, 3.0, 80.0, -4.0]  # two were not compared
    np.testing.assert_allclose(own[:, 0], np.sign(behind) * np.log1p(np.abs(behind)))
    np.testing.assert_allclose(own[:, 1], np.clip(behind, -20.0, 20.0))
    np.testing.assert_allclose(own[0, 2:4], np.log([0.2, 0.5]))
    assert np.isnan(own[0, 4])  # nothing was asked of its sign
    signed = evidence_of(logs).hypotheses["arms"]._replace(closes=-0.1, worsens=("front", "volume"))
    assert sign_of(signed) == (0.0, 2.0)
    of_left = {"regions": np.log(3.0), "practical": np.log(20.0)}
    assert left_over(Left(2, 1e3, 0.5)) == pytest.approx(of_left)
    found = dict(zip(CASE_FEATURES, case, strict=True))
    assert found["pair_gain"] == pytest.approx(np.log(5.0))  # over the best of the others
    assert found["above_none"] == pytest.approx(np.log(4.0))
    assert found["above_unknown"] == pytest.approx(np.log(81.0))
    assert found["best_outside"] == pytest.approx(np.log(0.5))
    assert found["runs"] == 2.0


def test_a_case_whose_cause_was_not_compared_teaches_nothing():
    cases = suite(12, 5)
    logs = {"arms": 0.0, "bars": -1.0, NONE: -70.0, UNKNOWN: -30.0}
    whole, rest = (fit(cases + more, EFFECTS) for more in ([(evidence_of(logs), "dots")], []))
    assert max(whole.calibration["dots"]) == 1.0
    found = [verdict(cases[0][0], each).probability for each in (whole, rest)]
    assert found[0] == pytest.approx(found[1], abs=0.02)  # but for the means of the features


def test_the_p_value_of_none_is_that_of_its_cases_and_of_others_that_of_all(model):
    probability = {"arms": 0.4, NONE: 0.4}
    found = model.conformal(probability)
    own = model.calibration[NONE]
    assert found[NONE] == pytest.approx((1 + np.sum(own >= 0.6)) / (len(own) + 1))
    prior = class_prior(model.classes)
    share = sum(prior[name] * np.mean(each >= 0.6) for name, each in model.calibration.items())
    assert found["arms"] == pytest.approx(share, abs=0.01)


def test_the_file_is_the_model(model, tmp_path):
    path = tmp_path / "model.json"
    model.save(path)
    again = VerdictModel.load(path)
    assert to_json(again) == path.read_text()
    assert again.about == {"cases": 60 * len(CAUSES), "made": "of numbers"}
    assert again.is_of_this_solver
    for evidence, _ in suite(3, 4):
        first, second = verdict(evidence, model), verdict(evidence, again)
        assert first.kind == second.kind
        assert first.probability == pytest.approx(second.probability, abs=1e-3)


def test_a_file_that_was_changed_or_is_none_is_refused(model, tmp_path):
    text = to_json(model)
    content = json.loads(text)
    content["intercept"][0] += 0.1
    for broken in (json.dumps(content), "{", "[]", '{"hash": 1}', "\x80\x04."):
        with pytest.raises(InputError, match=r"model\.json: file: found"):
            from_json(broken, tmp_path / "model.json")
    with pytest.raises(InputError, match="no such file"):
        VerdictModel.load(tmp_path / "missing.json")


def test_a_suite_that_is_too_small_is_refused():
    with pytest.raises(InputError, match="arms: found 1 cases; allowed: >= 2"):
        fit(suite(1, 1), EFFECTS)


def test_without_a_model_evidences_are_tempered_and_capped():
    logs = {"arms": 0.0, "ears": -60.0, NONE: -90.0, UNKNOWN: -40.0}
    found = verdict(evidence_of(logs, {NONE: 1e-9}), None)
    assert found.kind == "effect"
    assert found.effects == ("arms",)
    assert found.probability["arms"] == pytest.approx(CAP)
    assert found.set == ("arms",)
    assert found.conformal == {}
    nothing = verdict(evidence_of(logs | {NONE: -1.0}, {NONE: 0.3}), None)
    assert nothing.kind == NONE
    assert NONE in nothing.set


def test_groups_that_are_left_open(model):
    logs = {"arms": 0.0, "bars": -1.0, NONE: -70.0, UNKNOWN: -30.0}
    evidence = evidence_of(logs, {NONE: 1e-9})
    found = verdict(evidence, None)
    assert found.indistinguishable == (("arms", "bars"),)
    square = np.zeros((4, 4))
    classes = (("arms", "bars", "cups"),)
    alike = Separability(EFFECTS, square, square, square[0], square[0], classes, ())
    assert verdict(evidence, None, alike).indistinguishable == classes


def test_a_class_of_two_effects_is_one(model):
    assert SEVERAL in model.classes
    assert class_of("arms+bars") == SEVERAL
    assert class_of("arms") == "arms"
