"""What the numbers of a report together allow to be said: one of five states, and the causes that it names.

A cause is an effect, "none" or "unknown". The probability of an effect is that of all hypotheses that hold it, alone
or together with a second one; two effects may therefore have more than 100 % between them.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.diagnosis.confirmation import CONFIRMED, CONSISTENT
from fvcollapse.diagnosis.evidence import CHECK_PASSED
from fvcollapse.diagnosis.names import BASELINE, NONE, UNKNOWN, effects_of

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Report

NAMED, LEANING, OPEN, NOTHING, UNEXPLAINED = "named", "leaning", "open", "nothing", "unexplained"
HALF = 0.5  # probability from which a cause is named, share of the gap from which it is explained
LEAST_LEAN = 1.0 / 3.0  # probability of a cause to which the data lean
AHEAD = 2.0  # and its ratio to that of the next
MOST_OPEN = 4  # causes that one sentence names
BEYOND = 2.0  # ratio of a gap to its combined standard uncertainty that is no agreement


class Best(NamedTuple):
    """The model of the ladder that closes most of the fitted gap: its effects, and the fractions that it closes."""

    effects: tuple[str, ...]
    fitted: float
    held_out: float | None


class Standing(NamedTuple):
    """The state of the question after a diagnosis.

    Attributes
    ----------
    state : str
        NAMED: one cause has half of the probability, and the runs confirm it or are consistent with it. LEANING:
        one cause is ahead. OPEN: several are left. NOTHING: no gap is left and nothing missing is the most
        probable. UNEXPLAINED: a cause outside the catalogue has half of the probability and no model that was
        run closes half of the gap.
    causes : tuple of str
        Of NAMED and LEANING the first, and the effect that probably acts beside it; of OPEN those that are
        left, at least two; else the one that the state is about.
    shares : dict
        Cause -> probability, the largest first.
    best : Best or None
        None where no model with an effect was run.
    """

    state: str
    causes: tuple[str, ...]
    shares: dict[str, float]
    best: Best | None


def causes_of(hypothesis: str) -> tuple[str, ...]:
    """The causes of a hypothesis: its effects, or itself where it is none."""
    return effects_of(hypothesis) or (hypothesis,)


def totals(probability: Mapping[str, float]) -> dict[str, float]:
    """{cause: probability of all hypotheses that hold it}, the largest first."""
    shares: dict[str, float] = {}
    for name, chance in probability.items():
        for cause in causes_of(name):
            shares[cause] = shares.get(cause, 0.0) + chance
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def alone(probability: Mapping[str, float], cause: str) -> float:
    """Probability that a cause acts and nothing beside it."""
    return probability.get(cause, 0.0)


def without(probability: Mapping[str, float], causes: Iterable[str]) -> dict[str, float]:
    """{hypothesis: probability} of the hypotheses that hold none of the causes."""
    return {
        name: chance for name, chance in probability.items() if not set(causes) & {*causes_of(name)}
    }


def beside(probability: Mapping[str, float], causes: Iterable[str]) -> dict[str, float]:
    """`totals` of the hypotheses that hold none of the causes."""
    return totals(without(probability, causes))


def standing(report: "Report") -> Standing:
    """The `Standing` of a report."""
    probability, shares = may_be_named(report), totals(report.verdict.probability)
    best = best_model(report)
    first = next(iter(totals(probability)))
    share = shares[first]
    rival = next(iter(beside(probability, [first]).values()), 0.0)
    leans = share >= HALF or (share >= LEAST_LEAN and share >= AHEAD * rival)
    if first == NONE and not is_left(report):
        state = NOTHING
    elif first == UNKNOWN and share >= HALF and not explains(report):
        state = UNEXPLAINED
    elif share >= HALF and supports(report, first):
        state = NAMED
    else:
        state = LEANING if leans else OPEN
    causes = open_causes(probability, first) if state == OPEN else (first,)
    if state in (NAMED, LEANING):
        causes = (first, *companion(probability, first))
    return Standing(state, causes, shares, best)


def may_be_named(report: "Report") -> dict[str, float]:
    """{hypothesis: probability} without "none" where a gap is left and the set of the verdict has given "none" up."""
    verdict = report.verdict
    given_up = bool(verdict.set) and NONE not in verdict.set and is_left(report)
    if not given_up or verdict.probability.get(NONE, 0.0) >= HALF:
        return dict(verdict.probability)
    return {name: chance for name, chance in verdict.probability.items() if name != NONE}


def companion(probability: Mapping[str, float], first: str) -> tuple[str, ...]:
    """The effect that acts beside the first with half of its probability or more; () without one."""
    together = {
        other: chance
        for name, chance in probability.items()
        if first in (parts := effects_of(name))
        for other in parts
        if other != first
    }
    other = max(together, key=together.__getitem__, default=None)
    if other is None or together[other] < HALF * totals(probability)[first]:
        return ()
    return (other,)


def open_causes(probability: Mapping[str, float], first: str) -> tuple[str, ...]:
    """The causes among which the data cannot tell, at least two.

    Each has half of the probability of the first, or is needed for half of the probability together.
    """
    causes, least = [first], HALF * totals(probability)[first]
    total = sum(probability.values())
    while len(causes) < MOST_OPEN:
        name, chance = next(iter(beside(probability, causes).items()), (None, 0.0))
        covered = total - sum(without(probability, causes).values())
        if name is None or (chance < least and covered >= HALF * total and len(causes) > 1):
            break
        causes.append(name)
    return tuple(causes)


def best_model(report: "Report") -> Best | None:
    """The `Best` model of the ladder with an effect; None where none was run."""
    closed = [
        (fraction, rung)
        for rung in report.details.ladder
        if rung.effects and (fraction := rung.fitted.fraction_closed) is not None
    ]
    if closed:
        fraction, rung = max(closed, key=lambda one: one[0])
        held_out = rung.held_out.fraction_closed if rung.held_out else None
        return Best(tuple(rung.effects), fraction, held_out)
    if report.reduction is None or not report.verdict.effects:
        return None
    apart = report.reduction.held_out
    return Best(
        tuple(report.verdict.effects),
        report.reduction.fitted.overall.fraction_closed,
        apart.overall.fraction_closed if apart else None,
    )


def closed_with(report: "Report", cause: str) -> float | None:
    """Largest fraction of the fitted gap that a model with a cause closes; None where none was run."""
    fractions = [
        rung.fitted.fraction_closed
        for rung in report.details.ladder
        if cause in rung.effects and rung.fitted.fraction_closed is not None
    ]
    return max(fractions, default=None)


def explains(report: "Report") -> bool:
    """Whether a model that was run closes more than half of the gap, with an effect or re-calibrated alone."""
    fractions = [
        part.fraction_closed
        for rung in report.details.ladder
        if rung.model != BASELINE
        for part in (rung.fitted, rung.held_out)
        if part is not None and part.fraction_closed is not None
    ]
    if report.reduction is not None:
        fractions.append(report.reduction.fitted.overall.fraction_closed)
    return max(fractions, default=0.0) > HALF


def is_left(report: "Report") -> bool:
    """Whether a gap is left without any effect: a region, an observable, or all points taken together."""
    none = report.details.hypotheses.get(NONE)
    rejected = (
        none is not None and none.predictive_p is not None and none.predictive_p < CHECK_PASSED
    )
    beyond = any(gap.ratio > BEYOND for gap in report.by_observable.values())
    return bool(report.where) or beyond or rejected


def agrees(report: "Report") -> bool:
    """Whether "none" has half of the probability because the model agrees, see `verdict.agreeing`."""
    larger = any(part.is_larger for part in report.details.practical.values())
    return report.verdict.probability.get(NONE) == HALF and not (larger or is_left(report))


def supports(report: "Report", cause: str) -> bool:
    """Whether the runs with a cause confirm it, or are consistent with it."""
    confirmation = report.details.confirmation
    if confirmation is None or confirmation.wording not in (CONFIRMED, CONSISTENT):
        return False
    return cause in report.verdict.effects
