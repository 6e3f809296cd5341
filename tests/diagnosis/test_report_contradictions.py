"""The headline and the answer never contradict a number of their page: stored, sealed and generated reports."""

import json
import re
from pathlib import Path

import pytest
from bare_report import report_with
from hypothesis import given, settings
from hypothesis import strategies as some
from report_example import EFFECTS

from fvcollapse.diagnosis.names import BASELINE, NONE, RECALIBRATED, RUNNER_UP, UNKNOWN, WINNER
from fvcollapse.diagnosis.report import sentences
from fvcollapse.diagnosis.report import standing as module
from fvcollapse.diagnosis.report.bars import bars, ranking_note
from fvcollapse.diagnosis.report.report_file import read_report
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
