"""A verdict on effects that its layer does not know: these are judged by their evidence, all others by the layer."""

from dataclasses import replace

import pytest
from drawn_evidence import evidence_of, fitted, hypothesis, suite

from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN
from fvcollapse.diagnosis.report.limits import model_words
from fvcollapse.diagnosis.verdict import CAP, verdict
from fvcollapse.diagnosis.verdict_model import VerdictModel, solver_of
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior


@pytest.fixture(scope="module")
def model():
    return fitted()


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
