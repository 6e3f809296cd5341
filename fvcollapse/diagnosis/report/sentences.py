"""The answer of a report in a few sentences, and its headline; `standing` says what they may claim."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from fvcollapse.diagnosis.names import NONE, RECALIBRATED, UNKNOWN
from fvcollapse.diagnosis.report.certainty import certainty
from fvcollapse.diagnosis.report.next_words import next_words
from fvcollapse.diagnosis.report.standing import (
    HALF,
    NAMED,
    NOTHING,
    OPEN,
    UNEXPLAINED,
    closed_with,
    is_left,
    standing,
    supports,
    without,
)
from fvcollapse.diagnosis.report.unexplained_words import unexplained_words
from fvcollapse.diagnosis.report.where_words import where_words
from fvcollapse.diagnosis.report.words import (
    effect_meaning,
    hypothesis_name,
    listed,
    number,
    percent,
    span,
)
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.measure.quantities import observable_words, shown_gap

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Closed, Report
    from fvcollapse.diagnosis.report.standing import Best

MOST_ODD = 2  # odd numbers that the answer names
LEFT_OVER = 1.0 / 3.0  # probability beside the open causes from which "others" are named too


class Answer(NamedTuple):
    """The answer in parts, each one or more sentences.

    Attributes
    ----------
    cause, certainty, closed, unexplained : str
        Which cause, how sure, how much of the gap it closes, what no hypothesis explains (may be empty).
    where : list of str
        Where the gap lies, how large it is in practice, and what is wrong with the measured profiles.
    following : list of str
        What to measure next, and what such a plan was worth; empty where nothing is left to separate.
    odd : str
        Numbers of the experiments that are to be checked first; empty without any.
    """

    cause: str
    certainty: str
    closed: str
    where: list[str]
    unexplained: str
    following: list[str]
    odd: str


def parts_of(report: "Report") -> Answer:
    """The `Answer` of a report."""
    return Answer(
        cause=cause_words(report),
        certainty=certainty(report),
        closed=closed_words(report),
        where=where_words(report),
        unexplained=unexplained_words(report.details.unexplained),
        following=next_words(report),
        odd=odd_words(report),
    )


def answer(report: "Report") -> list[str]:
    """The answer as labelled lines, the most important first, as the command line prints it."""
    parts = parts_of(report)
    lines = [f"Check first: {parts.odd}"] if parts.odd else []
    lines += [
        f"Cause: {parts.cause}",
        f"How sure: {parts.certainty}",
        f"Gap closed: {parts.closed}",
        f"Where: {' '.join(parts.where)}",
    ]
    further = {"Unexplained": parts.unexplained, "Next": " ".join(parts.following)}
    return [*lines, *(f"{label}: {text}" for label, text in further.items() if text)]


def headline(report: "Report") -> str:
    """The verdict in a few words, with the probability of every cause that it names: never firmer than its numbers."""
    state, causes, shares, best = standing(report)
    if state == NOTHING:
        return "No missing effect is needed: no significant gap is left"
    if state == UNEXPLAINED:
        chance = percent(shares[UNKNOWN])
        return (
            f"No effect that was tried explains the gap: a cause outside {tried(report)} ({chance})"
        )
    if state == OPEN:
        names = [*with_chances(causes, shares, report), *more_words(report, causes)]
        return f"These data cannot tell between {listed(names)}"
    first, *others = with_chances(causes, shares, report)
    text = first + "".join(
        f" and {name}" if shares[cause] >= HALF else f", perhaps with {name}"
        for cause, name in zip(causes[1:], others, strict=True)
    )
    if state == NAMED:
        confirmation = report.details.confirmation
        is_confirmed = confirmation is not None and confirmation.wording == "confirmed"
        return f"Most likely cause: {text}, {'confirmed' if is_confirmed else 'not yet confirmed'}"
    return f"The data lean towards {text}{doubt(report, causes[0], best)}"


def doubt(report: "Report", cause: str, best: "Best | None") -> str:
    """What speaks against the cause to which the data lean, as the end of a sentence; may be empty."""
    if cause == NONE:
        return ", but a gap is left"
    if cause == UNKNOWN:
        if best is None or best.fitted <= HALF:
            return ", but it is not sure"
        verb = "closes" if len(best.effects) == 1 else "close"
        return f", but {joined(best.effects)} {verb} {percent(best.fitted)} of the gap"
    closed = closed_with(report, cause)
    if closed is not None and closed <= 0.0:
        return ", but with it none of the gap closes"
    return ", but it is not sure" if supports(report, cause) else ", but it is not confirmed"


def more_words(report: "Report", causes: Sequence[str]) -> list[str]:
    """What stands at the end of a list of open causes that holds too little of the probability."""
    others = sum(without(report.verdict.probability, causes).values())
    return ["others"] if others > LEFT_OVER else []


def with_chances(causes: Iterable[str], shares: Mapping[str, float], report: "Report") -> list[str]:
    """Names of causes, each with its probability."""
    return [f"{cause_name(cause, report)} ({percent(shares[cause])})" for cause in causes]


def cause_name(cause: str, report: "Report") -> str:
    """A cause in words; an unknown one lies outside of what was tried."""
    return f"a cause outside {tried(report)}" if cause == UNKNOWN else hypothesis_name(cause)


def joined(effects: Iterable[str], last: str = "and") -> str:
    """Several effects, in words."""
    return listed((hypothesis_name(name) for name in effects), last)


def tried(report: "Report") -> str:
    """The effects that an unknown cause is not among."""
    known = {name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE}
    return "the catalogue" if known <= set(report.candidates) else "the effects that were tried"


# -- the cause -----------------------------------------------------------------------------------


def cause_words(report: "Report") -> str:
    """Which cause, and the meaning of it; no numbers of place and time."""
    state, causes, shares, best = standing(report)
    if state == NOTHING:
        return (
            "none is needed. The model as given and these data agree within their uncertainties. "
            "This does not show that no effect acts."
        )
    if state == UNEXPLAINED:
        closest = (
            "" if best is None else f" The best of those that were run is {joined(best.effects)}."
        )
        return (
            f"none of the {len(report.candidates)} effects that were tried, with plausible values. The "
            f"cause lies in the model, or in a measurement error larger than its stated uncertainty.{closest}"
        )
    names = [cause_name(cause, report) for cause in causes]
    if state == OPEN:
        others = [name for group in confused(report, causes) for name in group]
        more = [name for name in dict.fromkeys(others) if name not in causes]
        beside = f" Nor do they exclude {joined(more, 'or')}." if more else ""
        return f"none is named: those of the first line stay open.{beside}"
    leads = "" if state == NAMED else "probably " if shares[causes[0]] >= HALF else "perhaps "
    text = f"{leads}{listed(names)}{meaning_of(causes)}."
    return " ".join([text, *confusions(report, causes), *additions(report, causes)])


def meaning_of(causes: Iterable[str]) -> str:
    """What the effects among the causes are, in brackets and without what follows a semicolon; may be empty."""
    known = [effect_meaning(cause).partition(";")[0] for cause in causes]
    meanings = [meaning for meaning in known if meaning]
    return f" ({'; '.join(one[0].lower() + one[1:] for one in meanings)})" if meanings else ""


def confused(report: "Report", causes: Sequence[str]) -> list[Sequence[str]]:
    """Groups of hypotheses that hold a named cause; of overlapping groups only the largest."""
    groups: list[Sequence[str]] = []
    for group in sorted(report.verdict.indistinguishable, key=len, reverse=True):
        if set(causes) & set(group) and not any(set(group) & set(other) for other in groups):
            groups.append(group)
    return groups


def confusions(report: "Report", causes: Sequence[str]) -> list[str]:
    """One sentence for each group of hypotheses that holds a named cause."""
    classes = report.details.separability.classes if report.details.separability else []
    groups = confused(report, causes)
    alike = [not classes or any(set(group) <= set(each) for each in classes) for group in groups]
    return [
        f"These data {'cannot tell apart ' if same else 'leave open '}{joined(group)}."
        for group, same in zip(groups, alike, strict=True)
        if len(group) > 1 and not set(group) <= set(causes)
    ]


def additions(report: "Report", causes: Sequence[str]) -> list[str]:
    """One sentence on the second effects that the data leave open beside the causes."""
    pairs = [set(name.split("+")) for name in report.verdict.set if "+" in name]
    others = dict.fromkeys(
        hypothesis_name(name) for pair in pairs if pair & set(causes) for name in pair - set(causes)
    )
    if not others:
        return []
    return [f"The data do not exclude {listed(others, 'or')} beside it."]


# -- how much closes -----------------------------------------------------------------------------


def closed_words(report: "Report") -> str:
    """How much of the gap closes with the cause really added to the solver."""
    state, causes, _, best = standing(report)
    reduction = report.reduction
    if state == OPEN and not is_left(report):
        return "no gap is significant, so that no share of it can be given."
    if reduction is not None and set(causes) & set(report.verdict.effects):
        overall = reduction.fitted.overall
        better = "" if overall.fraction_closed > 0.0 else "the fit is no better: "
        text = (
            f"with {joined(report.verdict.effects)} really added to the solver and the model re-calibrated, "
            f"{better}{closed(overall)} of the gap closes in the experiments that were fitted"
        )
        if reduction.held_out is not None:
            text += f" and {closed(reduction.held_out.overall)} in those that were held out"
        return f"{text}."
    alone = recalibrated_words(report)
    if state == NOTHING:
        return "there is no significant gap to close."
    if best is None:
        return f"as no cause is named, no run shows how much of the gap a cause closes.{alone}"
    held_out = "" if best.held_out is None else f" and {percent(best.held_out)} in those held out"
    return (
        f"of the models that were run, that with {joined(best.effects)} closes most: {percent(best.fitted)} of "
        f"the gap in the experiments that were fitted{held_out}.{alone}"
    )


def recalibrated_words(report: "Report") -> str:
    """What a re-calibration without any effect closes; empty where it was not run."""
    for rung in report.details.ladder:
        share = rung.fitted.fraction_closed
        if rung.model == RECALIBRATED and share is not None:
            return f" Re-calibration without any effect closes {percent(share)}."
    return ""


def closed(part: "Closed") -> str:
    """Fraction of a gap that closed, with its range where that is one."""
    value = percent(part.fraction_closed)
    if not part.interval or all(percent(end) == value for end in part.interval):
        return value
    return f"{value} (90 % interval {span(part.interval, percent)})"


# -- odd numbers, and what controls taught -------------------------------------------------------


def odd_words(report: "Report") -> str:
    """Numbers of the experiments that are possible but odd, with the slip that would explain them; may be empty."""
    named = [
        f"{one.experiment}, {one.key}: {one.found}" + (f", {one.likely}" if one.likely else "")
        for one in report.warnings[:MOST_ODD]
    ]
    more = len(report.warnings) - len(named)
    if not named:
        return ""
    others = f"; {more} more" if more else ""
    return f"{'; '.join(named)}{others}. If this is a slip, the answer explains the slip."


def expected_gaps(report: "Report") -> str:
    """Root mean square of the model error learned from the controls, in words; empty without controls."""
    parts = []
    for name, size in report.details.expected.items():
        factor, shown = shown_gap(name, report.by_observable[name].units)
        parts.append(f"{observable_words(name)} {number(factor * size, 2)} {shown}".rstrip())
    return ", ".join(parts)
