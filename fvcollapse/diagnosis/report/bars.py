"""The first causes as bars beside the answer: the same numbers, in the same order."""

from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.diagnosis.names import NONE, UNKNOWN, effects_of
from fvcollapse.diagnosis.report.certainty import agreement, is_calibrated
from fvcollapse.diagnosis.report.sentences import tried
from fvcollapse.diagnosis.report.standing import agrees, alone, standing
from fvcollapse.diagnosis.report.words import hypothesis_name, percent

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Report

MOST_BARS = 5


class Bar(NamedTuple):
    """One bar: its words, probability in all and alone, its number in words, and whether the headline names it."""

    name: str
    share: float
    alone: float
    chance: str
    is_stated: bool


def bars(report: "Report") -> list[Bar]:
    """The `Bar`s of the first five causes, the most probable first, and of all that the headline names."""
    _, causes, shares, _ = standing(report)
    shown = [cause for n, cause in enumerate(shares) if n < MOST_BARS or cause in causes]
    names = {UNKNOWN: f"outside {tried(report)}"}
    return [
        Bar(
            name=names.get(cause) or hypothesis_name(cause),
            share=shares[cause],
            alone=alone(report.verdict.probability, cause),
            chance=percent(shares[cause]),
            is_stated=cause in causes,
        )
        for cause in shown
    ]


def ranking_note(report: "Report") -> str:
    """Why the cause of the most evidence is not the most probable; empty where it is."""
    probability = report.verdict.probability
    known = {
        name: one.log_evidence
        for name, one in report.details.hypotheses.items()
        if one.log_evidence is not None and name in probability
    }
    if not known:
        return ""
    first = max(probability, key=probability.__getitem__)
    strongest = max(known, key=known.__getitem__)
    ahead = known[strongest] - known.get(first, known[strongest])
    if strongest == first or ahead <= 0.0:
        return ""
    names = [hypothesis_name(name) for name in (strongest, first)]
    return (
        f"By its evidence alone {names[0]} would be first, by {ahead:.1f} in the logarithm. {names[1].capitalize()} "
        f"is more probable ({percent(probability[first])} against {percent(probability[strongest])}) because "
        f"{reason(report, strongest, first)}"
    )


def reason(report: "Report", strongest: str, first: str) -> str:
    """What weighs against the evidence: the prior, how evidence counts, and that the model agrees."""
    if first == NONE and agrees(report):
        return f"{agreement(report)}."
    if is_calibrated(report):
        return (
            "the verdict layer has learned from simulated cases with known causes how often so much evidence "
            "stands against the true cause, and what remains of the gap counts as well."
        )
    larger = (
        "a second effect has a small probability before any data"
        if len(effects_of(strongest)) > len(effects_of(first) or (first,))
        else f"{hypothesis_name(first)} has the larger probability before any data"
    )
    divisor = report.details.temperature
    if divisor is None:
        return f"evidence is over-confident and counts less than its size here, and {larger}."
    if divisor == 1.0:
        return f"{larger}."
    return f"evidence is over-confident, so that its logarithm is divided by {divisor:g} here, and {larger}."
