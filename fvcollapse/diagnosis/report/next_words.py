"""What to measure next, in words: the set-ups that the plan cannot tell apart, and what became of such plans."""

from typing import TYPE_CHECKING

from fvcollapse.diagnosis.report.sealed import sealed_scores, worth_words
from fvcollapse.diagnosis.report.standing import UNEXPLAINED, standing
from fvcollapse.diagnosis.report.words import hypotheses_listed

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import NextExperiment, Report

UNPLANNED = (
    "no experiment is proposed, since nobody can predict what a cause outside the catalogue would do in it. Check the "
    "uncertainties of what was measured where the gap lies."
)
MOST_NAMED = 3  # set-ups in the answer; the table has all


def planned(report: "Report") -> "tuple[list[NextExperiment], list[NextExperiment]]":
    """(those that cannot be told from the first, by name; those of which less is expected, the best first)."""
    first = report.next_experiment
    if first is None:
        return [], []
    margin = sealed_scores().next.margin
    rest = report.details.alternatives
    alike = [first, *(one for one in rest if first.expected_gain - one.expected_gain <= margin)]
    less = [one for one in rest if first.expected_gain - one.expected_gain > margin]
    return sorted(alike, key=lambda one: one.description), less


def with_case(report: "Report") -> "NextExperiment | None":
    """The experiment of the case file: the first that has another set-up, else the first."""
    first = report.next_experiment
    if first is None:
        return None
    return next((one for one in [first, *report.details.alternatives] if one.set_up), first)


def next_words(report: "Report") -> list[str]:
    """What to measure next, what it would separate, and what such a plan was worth; empty where nothing is open.

    Where nothing in the catalogue explains the gap, why there is no plan.
    """
    alike, _ = planned(report)
    if not alike:
        return [UNPLANNED] if standing(report).state == UNEXPLAINED else []
    separated = dict.fromkeys(name for one in alike for name in one.separates)
    return [
        f"{choice_words(alike)}.",
        f"To separate: {hypotheses_listed(separated)}.",
        worth_words(),
    ]


def choice_words(alike: "list[NextExperiment]") -> str:
    """The set-ups that cannot be told apart."""
    names = [one.description for one in alike]
    if len(names) == 1:
        return names[0]
    more = len(names) - MOST_NAMED
    named = "; ".join(names[:MOST_NAMED]) + (f"; {more} more" if more > 0 else "")
    return f"one of {len(names)} experiments that the plan cannot tell apart: {named}"
