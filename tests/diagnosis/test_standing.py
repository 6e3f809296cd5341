"""The headline and the answer never contradict a number of their page: stored, sealed and generated reports."""

import json
import re
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some
from msgspec.structs import replace
from report_example import EFFECTS, example

from fvcollapse.diagnosis.names import BASELINE, NONE, RECALIBRATED, RUNNER_UP, UNKNOWN, WINNER
from fvcollapse.diagnosis.report import sentences
from fvcollapse.diagnosis.report import standing as module
from fvcollapse.diagnosis.report.bars import bars, ranking_note
from fvcollapse.diagnosis.report.certainty import certainty
from fvcollapse.diagnosis.report.report_file import read_report
from fvcollapse.diagnosis.report.schema import (
    Confirmation,
    Details,
    HypothesisSummary,
    Misfit,
    Rung,
    Verdict,
)
from fvcollapse.diagnosis.report.words import hypothesis_name, percent

ROOT = Path(__file__).parents[2]
REPORTS = sorted((ROOT / "runs").rglob("report.json"))
SEALED = json.loads((ROOT / "runs" / "blind" / "answers.json").read_text(encoding="utf-8"))
NUMBER = re.compile(
    r"(?:tell between |towards |cause: |gap: | and |, perhaps with |, )([a-z ]+) \((.?\d+ %)\)"
)
STARTS = {
    "Most likely cause": module.NAMED,
    "The data lean": module.LEANING,
    "These data cannot tell": module.OPEN,
    "No missing effect is needed": module.NOTHING,
    "No effect that was tried explains": module.UNEXPLAINED,
}
WORDINGS = ("confirmed", "consistent with", "not confirmed")


@cache
def bare():
    """A report without regions, ladder and details."""
    report = example("none")
    return replace(
        report, where=[], by_observable={}, reduction=None, held_out=[], details=Details()
    )


@cache
def a_region():
    """A region of a gap."""
    return example("effect").where[0]


def report_with(probability, ladder=(), where=False, wording=None, p_value=None):
    """A report with these probabilities, rungs {model: (effects, fraction)}, and a region or none."""
    verdict_effects = next(iter(ladder.values()))[0] if ladder and wording else ()
    kind = "none" if not verdict_effects else "effect" if len(verdict_effects) == 1 else "several"
    rungs = [Rung(BASELINE, [], Misfit(2.0, None), None)]
    rungs += [
        Rung(model, list(effects), Misfit(1.0, fraction), None)
        for model, (effects, fraction) in dict(ladder).items()
    ]
    return replace(
        bare(),
        where=[a_region()] if where else [],
        verdict=Verdict(kind, list(verdict_effects), [], probability, []),
        details=Details(
            ladder=rungs if ladder else [],
            hypotheses={NONE: HypothesisSummary(0.0, predictive_p=p_value)},
            confirmation=Confirmation(wording, ["a reason"]) if wording else None,
        ),
    )


# -- the oracle ----------------------------------------------------------------------------------


def total(report, cause):
    """Probability of all hypotheses with a cause."""
    return sum(p for name, p in report.verdict.probability.items() if cause in name.split("+"))


def cause_of(words):
    """The cause that words of the headline name."""
    words = words.removeprefix("a cause ")
    if words.startswith("outside"):
        return UNKNOWN
    return NONE if words == "no missing effect" else words.replace(" ", "_")


def check(report):
    """Every statement of the headline and the answer against the numbers."""
    text, parts = sentences.headline(report), sentences.parts_of(report)
    (state,) = (state for start, state in STARTS.items() if text.startswith(start))
    every = {part for name in report.verdict.probability for part in name.split("+")}
    largest = max(total(report, cause) for cause in every)
    told = {cause_of(name): chance for name, chance in NUMBER.findall(text)}
    for cause, chance in told.items():
        assert chance == percent(total(report, cause)), text
    first = next(iter(told), NONE)
    assert total(report, first) == pytest.approx(largest)
    fractions = [
        rung.fitted.fraction_closed for rung in report.details.ladder if rung.model != BASELINE
    ]
    closes = max([fraction for fraction in fractions if fraction is not None], default=0.0)
    if state == module.NAMED:
        assert largest >= 0.5
        assert report.details.confirmation.wording in WORDINGS[:2]
        assert first in report.verdict.effects
        assert ("not yet confirmed" in text) != (report.details.confirmation.wording == "confirmed")
    elif state == module.OPEN:
        assert largest < 0.5
        assert len(told) >= 2
    elif state == module.NOTHING:
        assert not report.where
    elif state == module.UNEXPLAINED:
        assert (first, largest >= 0.5, closes <= 0.5) == (UNKNOWN, True, True)
    if state != module.UNEXPLAINED:
        assert "none of the" not in parts.cause
    if state != module.NOTHING:
        assert "no significant gap" not in f"{text} {parts.closed}"
    check_bars(report, told)
    check_closed(report, parts)
    check_certainty(report, state, told, parts.certainty)
    check_ranking(report)


def check_bars(report, told):
    """The bars show the numbers of the headline, in falling order."""
    shown = bars(report)
    assert [bar.share for bar in shown] == sorted((bar.share for bar in shown), reverse=True)
    chances = {cause_of(bar.name): bar.chance for bar in shown}
    assert told.items() <= chances.items()
    assert all(bar.alone <= bar.share + 1e-12 for bar in shown)


def check_closed(report, parts):
    """A fraction that is said to close most is the largest of the ladder."""
    if "closes most" in parts.closed:
        fractions = [
            rung.fitted.fraction_closed
            for rung in report.details.ladder
            if rung.effects and rung.fitted.fraction_closed is not None
        ]
        assert f"closes most: {percent(max(fractions))} of" in parts.closed


def check_certainty(report, state, told, text):
    """Every probability in "How sure" is that of its cause, and none is above that of the headline's first."""
    first = next(iter(told), NONE)
    if state == module.OPEN:
        assert f"the first has {told[first]}." in text
    following = re.search(r"; next is ([a-z ]+?)( without [a-z ,]+)? with (.?\d+ %)", text)
    if following:
        cause = cause_of(following[1])
        both = sum(
            chance
            for name, chance in report.verdict.probability.items()
            if cause in name.split("+") and not set(told) & set(name.split("+"))
        )
        assert following[3] == percent(both), text
        assert bool(following[2]) == (percent(both) != percent(total(report, cause)))
        assert cause not in told
    if state in (module.NAMED, module.LEANING) and first not in (NONE, UNKNOWN):
        assert text.startswith(f"{hypothesis_name(first)} {told[first]}")
    is_firm = "The cause is confirmed" in text
    assert is_firm <= (state in (module.NAMED, module.LEANING))


def check_ranking(report):
    """Where a note says that evidence would rank otherwise, its numbers are those of the report."""
    note = ranking_note(report)
    if note:
        told = re.search(r"by (\d+\.\d) in the logarithm\. .*\((.*) against (.*)\) because", note)
        known = report.details.hypotheses
        named = {
            name: known[name].log_evidence for name in report.verdict.probability if name in known
        }
        named = {name: value for name, value in named.items() if value is not None}
        first = max(report.verdict.probability, key=report.verdict.probability.get)
        strongest = max(named, key=named.get)
        assert told[1] == f"{named[strongest] - named[first]:.1f}"
        chances = [report.verdict.probability[name] for name in (first, strongest)]
        assert list(told.groups()[1:]) == [percent(chance) for chance in chances]
        divisor = report.details.temperature
        assert divisor is None or divisor == 1.0 or f"divided by {divisor:g} here" in note


# -- stored, sealed, generated -------------------------------------------------------------------


@pytest.mark.parametrize("path", REPORTS, ids=lambda path: path.parent.name)
def test_stored_reports_contradict_nothing(path):
    check(read_report(path))


def test_there_are_stored_reports():
    assert len(REPORTS) >= 16
    assert len(SEALED) == 201


@pytest.mark.parametrize("where", [False, True])
@pytest.mark.parametrize("wording", [None, *WORDINGS])
@pytest.mark.parametrize("fraction", [0.0, 0.4, 1.0])
def test_sealed_cases_contradict_nothing(where, wording, fraction):
    """The probabilities of the 210 sealed cases, with every outcome of the runs."""
    for answer in SEALED.values():
        probability = answer["probability"]
        named = [name for name in probability if name not in (NONE, UNKNOWN)]
        first = max(named, key=probability.get).split("+")
        ladder = {WINNER: (first, fraction), RECALIBRATED: ([], 0.5 * fraction)}
        check(report_with(probability, ladder, where, wording))


names = some.sampled_from([NONE, UNKNOWN, *EFFECTS[:5]])
pairs = some.sampled_from(["+".join(sorted((EFFECTS[0], other))) for other in EFFECTS[1:4]])
fractions = some.floats(-1.0, 1.0)


@settings(max_examples=300, deadline=None)
@given(
    weights=some.dictionaries(names | pairs, some.floats(0.0, 1.0), min_size=1),
    outcomes=some.tuples(fractions, fractions, fractions),
    where=some.booleans(),
    wording=some.sampled_from([None, *WORDINGS]),
    p_value=some.none() | some.floats(0.0, 1.0),
)
def test_generated_reports_contradict_nothing(weights, outcomes, where, wording, p_value):
    weights = dict.fromkeys([NONE, UNKNOWN, *EFFECTS], 0.001) | weights
    probability = {name: value / sum(weights.values()) for name, value in weights.items()}
    effects = (EFFECTS[:1], EFFECTS[1:2])
    ladder = {
        WINNER: (effects[0], outcomes[0]),
        RUNNER_UP: (effects[1], outcomes[1]),
        RECALIBRATED: ((), outcomes[2]),
    }
    check(report_with(probability, ladder, where, wording, p_value))


# -- the cases of the five states ----------------------------------------------------------------


def spread(**given):
    """Probabilities: those that are given, the rest shared by the other effects."""
    others = [name for name in (NONE, UNKNOWN, *EFFECTS) if name not in given]
    rest = (1.0 - sum(given.values())) / len(others)
    return given | dict.fromkeys(others, rest)


def test_a_cause_whose_hypotheses_share_it_is_not_called_unknown():
    """Unknown leads every single hypothesis, but lateral friction is in hypotheses with 57 % together."""
    walls = {f"{other}+lateral_friction": 0.19 for other in ("cohesion", "gate")}
    probability = spread(unknown=0.36, lateral_friction=0.19, **walls)
    report = report_with(probability, {WINNER: (["lateral_friction"], 1.0)}, where=True)
    assert sentences.headline(report) == (
        "The data lean towards lateral friction (57 %), but it is not confirmed"
    )
    assert "lateral friction closes most: 100 %" in sentences.parts_of(report).closed
    confirmed = report_with(probability, {WINNER: (["lateral_friction"], 1.0)}, True, "confirmed")
    assert sentences.headline(confirmed) == "Most likely cause: lateral friction (57 %), confirmed"


def test_a_cause_that_closes_nothing_is_said_to_close_nothing():
    probability = spread(front_saltation=0.45)
    report = report_with(probability, {WINNER: (["front_saltation"], -0.09)}, where=True)
    told = sentences.headline(report)
    assert told.startswith("The data lean towards front saltation (45 %)")
    assert told.endswith(", but with it none of the gap closes")


def test_two_effects_close_and_one_closes():
    for effects, verb in ((["dilatancy", "gate"], "close"), (["gate"], "closes")):
        report = report_with(spread(unknown=0.84), {WINNER: (effects, 1.0)}, where=True)
        assert f" {verb} 100 % of the gap" in sentences.headline(report)


def test_nothing_is_needed_only_where_nothing_is_left():
    probability = spread(none=0.22, unknown=0.216)
    left, gone = (report_with(probability, where=where) for where in (True, False))
    assert sentences.headline(left).startswith(
        "These data cannot tell between no missing effect (22 %), a cause outside the catalogue (22 %)"
    )
    assert sentences.headline(gone) == "No missing effect is needed: no significant gap is left"
    assert module.standing(report_with(probability, p_value=0.01)).state == module.OPEN


def test_a_five_way_draw_names_no_cause():
    five = dict(zip(EFFECTS[:5], (0.24, 0.2, 0.19, 0.18, 0.17), strict=True))
    told = sentences.headline(report_with(spread(**five), where=True, wording=None))
    assert told.startswith("These data cannot tell between ")
    assert told.endswith(" and others") or told.count("%") >= 4


def test_unknown_does_not_deny_what_a_rung_closes():
    probability = spread(unknown=0.7)
    for fraction, state in ((0.4, module.UNEXPLAINED), (0.7, module.LEANING)):
        report = report_with(probability, {WINNER: (["cohesion"], fraction)}, where=True)
        assert module.standing(report).state == state
    assert sentences.headline(report).endswith("but cohesion closes 70 % of the gap")


def test_two_effects_that_act_together_are_both_named():
    probability = spread(**{"dilatancy+gate": 0.6, "gate": 0.25})
    report = report_with(
        probability, {WINNER: (["dilatancy", "gate"], 0.9)}, True, "consistent with"
    )
    assert sentences.headline(report).startswith("Most likely cause: gate (8")
    assert " and dilatancy (6" in sentences.headline(report)


def test_outside_of_what_was_tried():
    """Of a few effects that were tried "unknown" says nothing about the rest of the catalogue."""
    every = report_with(spread(unknown=0.8), where=True)
    few = replace(every, candidates=dict(list(every.candidates.items())[:2]))
    assert "a cause outside the catalogue (80 %)" in sentences.headline(every)
    assert "a cause outside the effects that were tried (80 %)" in sentences.headline(few)


def test_none_that_is_given_up_is_no_cause_to_name():
    """A gap that chance leaves in fewer than one case of twenty: no other cause is probable, and none is wrong."""
    given = {"none": 0.3, "cohesion": 0.27, "unknown": 0.2}
    report = report_with(spread(**given), where=True)
    kept, given_up = (
        replace(report, verdict=replace(report.verdict, set=list(names)))
        for names in (given, ("cohesion", "unknown"))
    )
    assert sentences.headline(kept).startswith(
        "These data cannot tell between no missing effect (30 %)"
    )
    assert sentences.headline(given_up).startswith(
        "These data cannot tell between cohesion (27 %), a cause outside the catalogue (20 %)"
    )
    assert "No missing effect (30 %) is given up" in certainty(given_up)
    assert "given up" not in certainty(kept)
    probable = replace(given_up.verdict, probability=spread(none=0.6, cohesion=0.2))
    assert "no missing effect (60 %)" in sentences.headline(replace(given_up, verdict=probable))


def test_coarse_cells_are_in_the_answer():
    report = report_with(spread(lateral_friction=0.6), where=True)
    budget = {"front": {"grid": 0.02, "measurement, single points": 0.01}}
    details = replace(report.details, coarse_cells={"beads": 0.0117}, budget=budget)
    told = certainty(replace(report, details=details, cost=replace(report.cost, cell_size=0.02)))
    assert "cells of 2 cm are coarser" in told
    assert "at most 1.17 cm" in told
    assert "only rank the causes" in told
    assert "The grid is 80 % of the variance of the front position: refine it." in told
    assert "coarser" not in certainty(report)
