"""What moves the odds of a verdict: a mass balance that is off, a gap that asks for nothing, sharpness of the layer."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest
from drawn_evidence import EFFECTS, evidence_of, fitted, suite

from fvcollapse.blind.verdict_fit import sharpness_of
from fvcollapse.diagnosis.left import Left
from fvcollapse.diagnosis.mass_balance import MassBalance
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.verdict import EVEN, agreeing, named, probable, verdict
from fvcollapse.diagnosis.verdict_features import asks, class_of, known_logits
from fvcollapse.diagnosis.verdict_model import class_prior, softmax


@pytest.fixture(scope="module")
def model():
    return fitted()


def balance(shift, stretch):
    return MassBalance(np.array([shift, stretch]), np.diag([0.012, 0.015]) ** 2)


def test_a_mass_balance_that_is_off_points_outside_the_catalogue(model):
    logs = {"arms": 0.0, "bars": -8.0, NONE: -30.0, UNKNOWN: -8.0}
    evidence = evidence_of(logs, {NONE: 1e-9})
    for each, sharpness in ((model, model.sharpness), (None, 1.0)):
        right, wrong = (
            verdict(replace(evidence, balance=balance(shift, 0.0)), each).probability
            for shift in (0.0, 0.03)
        )
        odds = [found[UNKNOWN] / found["bars"] for found in (right, wrong)]
        assert odds[1] / odds[0] == pytest.approx(
            np.exp(
                sharpness * (balance(0.03, 0.0).logit(UNKNOWN) - balance(0.0, 0.0).logit(UNKNOWN))
            )
        )


def test_two_effects_share_the_odds_of_their_pairs():
    logs = {
        "arms": 0.0,
        NONE: -9.0,
        UNKNOWN: -8.0,
        "arms+bars": 1.0,
        "arms+transverse_profile": 1.0,
    }
    evidence = replace(evidence_of(logs), balance=balance(0.0, -0.12))
    view = evidence.balance.logit("transverse_profile")
    found = known_logits(evidence, ("arms", NONE, UNKNOWN, SEVERAL))
    assert found[:2].tolist() == [0.0, 0.0]
    assert found[2] == evidence.balance.logit(UNKNOWN)
    assert found[3] == pytest.approx(np.log((1.0 + np.exp(view)) / 2.0))
    shares = named(evidence, {SEVERAL: 1.0})
    assert shares["arms+transverse_profile"] / shares["arms+bars"] == pytest.approx(np.exp(view))


def test_nothing_unknown_where_nothing_asks_for_an_explanation(model):
    logs = {name: -3.0 for name in EFFECTS} | {NONE: 0.0, UNKNOWN: 12.0}
    quiet = dataclasses.replace(evidence_of(logs), left=Left(0, 0.3, 0.0))
    loud = dataclasses.replace(evidence_of(logs), left=Left(2, 3.0, 0.0))
    assert not asks(quiet)
    assert asks(loud)
    assert asks(evidence_of(logs, {NONE: 0.01}))
    for layer in (model, None):
        chances = [verdict(each, layer).probability[UNKNOWN] for each in (quiet, loud)]
        assert chances[0] < 0.1 < 0.4 < chances[1]


def test_none_is_the_answer_where_the_model_agrees(model):
    logs = {name: 0.0 if name == "arms" else -30.0 for name in (*EFFECTS, NONE, UNKNOWN)}
    quiet = dataclasses.replace(evidence_of(logs), left=Left(0, 0.3, 0.0))
    for layer in (model, None):
        before = probable(quiet, layer, None, None)
        assert before.effects == ("arms",)
        found = verdict(quiet, layer)
        assert found.kind == NONE
        assert found.effects == ()
        assert found.probability[NONE] == EVEN  # exactly: the headline asks for half
        assert sum(found.probability.values()) == pytest.approx(1.0)
        assert set(found.set) == {NONE, *before.set}  # what was open stays open
        others = {name: share for name, share in before.probability.items() if name != NONE}
        ratio = {name: found.probability[name] / share for name, share in others.items()}
        assert np.ptp(list(ratio.values())) < 1e-9  # the others keep their odds


def test_nothing_that_was_open_is_closed_where_the_model_agrees(model):
    """Effects that are ruled out stay out, and where nothing was open something unknown is."""
    logs = {name: 0.0 if name == "arms" else -30.0 for name in (*EFFECTS, NONE, UNKNOWN)}
    quiet = dataclasses.replace(evidence_of(logs), left=Left(0, 1.0, 0.0))
    arms = quiet.hypotheses["arms"]._replace(closes=-0.1)
    out = dataclasses.replace(quiet, hypotheses=quiet.hypotheses | {"arms": arms})
    found = verdict(out, model)
    assert found.probability["arms"] == 0.0
    assert found.probability[NONE] >= EVEN
    assert "arms" not in found.set
    strange = probable(quiet, model, None, None)._replace(set=())
    assert set(agreeing(strange, None).set) == {NONE, UNKNOWN}
    sure = strange._replace(probability={NONE: 1.0, "arms": 0.0})
    assert agreeing(sure, None).probability == {NONE: 1.0, "arms": 0.0}


def test_the_answer_stands_where_the_model_does_not_agree(model):
    logs = {name: 0.0 if name == "arms" else -30.0 for name in (*EFFECTS, NONE, UNKNOWN)}
    seen = dataclasses.replace(evidence_of(logs), left=Left(1, 3.0, 0.9))
    failed = dataclasses.replace(evidence_of(logs, {NONE: 0.04}), left=Left(0, 0.3, 0.0))
    sure = dataclasses.replace(evidence_of(logs | {NONE: 40.0}), left=Left(0, 0.3, 0.0))
    large = dataclasses.replace(evidence_of(logs), left=Left(0, 1.1, 0.0))
    untold = evidence_of(logs)
    for evidence in (seen, failed, large, untold):
        for layer in (model, None):
            assert verdict(evidence, layer) == probable(evidence, layer, None, None)
    assert verdict(sure, model).probability[NONE] == pytest.approx(
        probable(sure, model, None, None).probability[NONE]
    )  # never less probable than it was


@pytest.mark.parametrize("factor", [0.25, 0.5, 0.9])
def test_the_sharpness_of_cases_left_out_is_recovered(factor):
    """Causes are drawn with the probabilities of some logits; those of the fit are sharper by a factor."""
    rng = np.random.default_rng(4)
    classes = (*EFFECTS, NONE, UNKNOWN)
    right = 2.0 * rng.standard_normal((6000, len(classes)))
    shares = softmax(right)
    truth = (shares.cumsum(axis=1) > rng.random((len(right), 1))).argmax(axis=1)
    prior, counts = class_prior(classes), np.bincount(truth)
    right -= np.log([counts[n] / prior[name] for n, name in enumerate(classes)])
    assert sharpness_of(right / factor, truth, classes) == pytest.approx(factor, rel=0.08)


def test_a_cause_that_was_not_compared_has_no_part_in_the_sharpness():
    rng = np.random.default_rng(5)
    logits, truth = 3.0 * rng.standard_normal((300, 4)), rng.integers(4, size=300)
    more, absent = np.vstack([logits, logits[:9]]), np.concatenate([truth, truth[:9]])
    more[300 + np.arange(9), absent[300:]] = -np.inf
    found = sharpness_of(more, absent, EFFECTS)
    assert found == pytest.approx(sharpness_of(logits, truth, EFFECTS), rel=1e-6)


def test_probabilities_are_those_that_the_calibration_was_made_with(model):
    """On the cases of the fit those of all of them are a little better than those of the cases left out."""
    left_out = np.concatenate([*model.calibration.values()])
    shares = [
        model.probabilities(evidence)[class_of(cause)]
        for evidence, cause in suite(60, 1)
        if class_of(cause) in model.probabilities(evidence)
    ]
    assert np.mean(1.0 - np.array(shares)) == pytest.approx(left_out.mean(), abs=0.03)


def test_sharpness_acts_on_known_odds_as_well(model):
    evidence, _ = suite(1, 1)[0]
    sharp = replace(model, sharpness=1.0).probabilities(evidence)
    flat = replace(model, sharpness=0.5).probabilities(evidence)
    roots = {name: share**0.5 for name, share in sharp.items()}
    total = sum(roots.values())
    assert flat == pytest.approx({name: root / total for name, root in roots.items()})
