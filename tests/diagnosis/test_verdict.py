"""Verdicts: calibrated on cases like the fitted ones, honest about the rest, and never from a pickle."""

import dataclasses
import json
from dataclasses import replace

import numpy as np
import pytest

from fvcollapse.blind.verdict_fit import sharpness_of
from fvcollapse.blind.verdict_training import fit
from fvcollapse.diagnosis.evidence import Evidence, Hypothesis
from fvcollapse.diagnosis.left import Left
from fvcollapse.diagnosis.mass_balance import MassBalance
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.report.limits import model_words
from fvcollapse.diagnosis.separability import Separability
from fvcollapse.diagnosis.verdict import CAP, NONE_RETAINED, capped, named, verdict
from fvcollapse.diagnosis.verdict_features import (
    CASE_FEATURES,
    asks,
    class_of,
    features,
    known_logits,
    left_over,
    sign_of,
)
from fvcollapse.diagnosis.verdict_model import (
    VerdictModel,
    class_prior,
    from_json,
    softmax,
    solver_of,
    to_json,
)
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior
from fvcollapse.errors import InputError

EFFECTS = ("arms", "bars", "cups", "dots")
CAUSES = (*EFFECTS, NONE, UNKNOWN, "arms+bars")
PAIRS = ("arms+bars", "bars+cups")


def hypothesis(name, log_evidence, p_value=0.5, sigma=0.2, outside=1.0, runs=2):
    nothing = np.empty(0)
    by_run = dict.fromkeys(range(runs), p_value)
    return Hypothesis(
        *(name, log_evidence, log_evidence, -2.3 if "+" in name else 0.0, sigma, (0,)),
        *(nothing, nothing, nothing, p_value, by_run, {}, outside, nothing),
    )


def evidence_of(log_evidences, p_values=None, **keys):
    p_values = p_values or {}
    found = [
        hypothesis(name, value, p_values.get(name, 0.5), **keys)
        for name, value in log_evidences.items()
    ]
    found.sort(key=lambda each: -(each.log_evidence + each.log_prior))
    return Evidence({each.name: each for each in found})


def draw(cause, rng):
    """An over-confident evidence: the truth wins by some strength, with a noise of its own."""
    strength = rng.gamma(3.0, 10.0)
    logs = {name: -strength + 4.0 * rng.standard_normal() for name in EFFECTS}
    logs[NONE], logs[UNKNOWN] = -2.0 * strength, -1.2 * strength
    p_values = {name: float(rng.uniform()) for name in (*EFFECTS, NONE, UNKNOWN)}
    if cause == NONE:
        logs = {name: rng.normal(-1.0, 2.0) for name in EFFECTS}
        logs |= {NONE: 0.0, UNKNOWN: rng.normal(-6.0, 1.0)}
    elif cause == UNKNOWN:
        logs[UNKNOWN] = rng.normal(5.0, 2.0)
        p_values |= dict.fromkeys(EFFECTS, 1e-4)
    elif "+" in cause:
        logs |= {"arms": -5.0, "bars": -6.0, "arms+bars": rng.normal(10.0, 3.0)}
        logs["bars+cups"] = rng.normal(-5.0, 3.0)
        p_values |= dict.fromkeys(EFFECTS, 1e-3)
    else:
        logs[cause] = 4.0 * rng.standard_normal()
    return evidence_of(logs, p_values)


def suite(per_class, seed):
    rng = np.random.default_rng(seed)
    return [(draw(cause, rng), cause) for cause in CAUSES for _ in range(per_class)]


@pytest.fixture(scope="module")
def model():
    return fit(suite(60, 1), EFFECTS, {"made": "of numbers"})


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
    assert left_over(Left(2, 1e3, 0.5)) == {"regions": np.log(3.0), "practical": np.log(20.0)}
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


# -- effects that the model does not know --------------------------------------------------------


def with_ears(evidence, log_evidence, *others):
    """The evidence with the new effect "ears", and with pairs of it."""
    added = [hypothesis(name, log_evidence) for name in ("ears", *others)]
    return replace(evidence, hypotheses=evidence.hypotheses | {each.name: each for each in added})


@pytest.mark.parametrize("log_evidence", [-300.0, -40.0, 0.0, 40.0])
def test_a_new_effect_leaves_all_others_to_the_model(model, log_evidence):
    for evidence, _ in suite(2, 6):
        before = verdict(evidence, model)
        after = verdict(with_ears(evidence, log_evidence, "arms+ears"), model)
        assert sum(after.probability.values()) == pytest.approx(1.0)
        known = {name: after.probability[name] for name in before.probability}
        total = sum(known.values())
        assert {name: share / total for name, share in known.items()} == pytest.approx(
            before.probability
        )
        assert after.conformal == pytest.approx(before.conformal)
        assert [name for name in after.set if name in known] == list(before.set)


def test_a_new_effect_is_judged_by_its_tempered_evidence(model):
    logs = {"arms": 0.0, "bars": -8.0, NONE: -30.0, UNKNOWN: -25.0}
    evidence = with_ears(evidence_of(logs, {NONE: 1e-9}), 5.0)
    alone = verdict(evidence, None).probability["ears"]  # all of them tempered
    assert 0.1 < alone < CAP
    assert verdict(evidence, model).probability["ears"] == pytest.approx(alone)
    far = verdict(with_ears(evidence_of(logs, {NONE: 1e-9}), -200.0), model)
    assert far.probability["ears"] < 1e-6
    assert far.effects == ("arms",)
    assert "ears" not in far.set
    first = verdict(with_ears(evidence_of(logs, {NONE: 1e-9}), 90.0), model)
    assert first.effects == ("ears",)
    assert first.probability["ears"] == pytest.approx(CAP)
    assert "ears" in first.set
    assert "ears" not in first.conformal
    assert first.probability["arms"] < 1.0 - CAP


def test_none_stands_beside_a_new_effect_that_is_not_ten_times_as_probable(model):
    logs = {"arms": -1.0, "bars": -2.0, NONE: 0.0, UNKNOWN: -6.0}
    for log_evidence, kind in ((0.0, NONE), (60.0, "effect")):
        found = verdict(with_ears(evidence_of(logs, {NONE: 0.5}), log_evidence), model)
        assert found.kind == kind
        assert NONE in found.set


def test_a_model_that_knows_none_of_the_effects_judges_none(model):
    logs = {"ears": 0.0, NONE: -90.0, UNKNOWN: -40.0}
    evidence = evidence_of(logs, {NONE: 1e-9})
    assert not model.judges(evidence)
    assert verdict(evidence, model) == verdict(evidence, None)


def test_a_new_effect_of_the_catalogue_leaves_the_shipped_model_valid(monkeypatch):
    shipped = VerdictModel.load()
    before = shipped.is_of_this_solver, solver_of(shipped.effects)
    drag = Effect("drag", PHYSICAL, None, {"c": Prior("uniform", 0.0, 1.0, "C", "a guess")})
    monkeypatch.setitem(CATALOGUE, "drag", drag)
    assert (shipped.is_of_this_solver, solver_of(shipped.effects)) == before
    assert solver_of((*shipped.effects, "drag")) != before[1]
    logs = dict.fromkeys(shipped.classes, -20.0) | {"cohesion": 0.0, NONE: -30.0}
    del logs[SEVERAL]
    evidence = evidence_of(logs, {NONE: 1e-9})
    alone = verdict(evidence, shipped)
    added = hypothesis("drag", -10.0)
    both = verdict(replace(evidence, hypotheses=evidence.hypotheses | {"drag": added}), shipped)
    assert 0.0 < both.probability["drag"] < CAP
    rest = 1.0 - both.probability["drag"]
    for name, share in alone.probability.items():
        assert both.probability[name] == pytest.approx(rest * share)
    assert both.conformal == alone.conformal


def test_the_report_says_which_effects_are_new(model):
    evidence, _ = suite(1, 3)[0]
    assert "not trained on" not in model_words(model, evidence)
    words = model_words(model, with_ears(evidence, 0.0, "arms+ears"))
    assert (
        "verdict layer was not fitted to ears: the probability of this effect is a tempered evidence"
        in words
    )


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
