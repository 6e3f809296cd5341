"""How sure an answer is, in words: probability, strength of the runs, and what makes the numbers weak."""

from typing import TYPE_CHECKING

from fvcollapse.diagnosis.confirmation import CONFIRMED, CONSISTENT
from fvcollapse.diagnosis.names import NONE
from fvcollapse.diagnosis.report.sealed import right_words
from fvcollapse.diagnosis.report.standing import (
    NOTHING,
    OPEN,
    agrees,
    beside,
    may_be_named,
    standing,
)
from fvcollapse.diagnosis.report.words import CENTIMETRES, hypothesis_name, listed, number, percent
from fvcollapse.measure.quantities import observable_words

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.schema import Confirmation, Report
    from fvcollapse.diagnosis.report.standing import Standing

NEXT = 0.05  # probability from which another cause is named after the first
MUCH = 0.5  # share of the grid in the variance of a gap that is worth a sentence
GRID = "grid"  # the source of uncertainty, as `findings.budget` names it
STRENGTH = {
    CONFIRMED: "confirmed",
    CONSISTENT: "consistent with the data, which is less than confirmed",
    "not confirmed": "not confirmed by the runs",
}


def wording(confirmation: "Confirmation") -> str:
    """The strongest statement that the runs allow, as the beginning of a sentence."""
    return f"The cause is {STRENGTH[confirmation.wording]}"


def certainty(report: "Report") -> str:
    """How sure the answer is."""
    stand = standing(report)
    parts = [probability_words(report, stand), *given_up_words(report, stand)]
    confirmation = report.details.confirmation
    if confirmation is not None and stand.causes[0] in report.verdict.effects:
        added = listed(hypothesis_name(name) for name in report.verdict.effects)
        start = f"Run with {added} added." if stand.state == OPEN else f"{wording(confirmation)}."
        parts.append(f"{start} The checks: {'; '.join(confirmation.reasons)}.")
    return " ".join([*parts, *weak_words(report)])


def probability_words(report: "Report", stand: "Standing") -> str:
    """The probabilities of the causes that the headline names, and of the next."""
    state, causes, shares, _ = stand
    if state == OPEN:
        return f"no cause is clearly ahead; the first has {percent(shares[causes[0]])}."
    others = beside(may_be_named(report), causes)
    name, chance = next(iter(others.items()), ("", 0.0))
    following = ""
    if chance >= NEXT:
        apart = percent(chance) != percent(shares[name])
        alone = f" without {listed(map(hypothesis_name, causes))}" if apart else ""
        following = f"; next is {hypothesis_name(name)}{alone} with {percent(chance)}"
    stated = listed(f"{hypothesis_name(cause)} {percent(shares[cause])}" for cause in causes)
    if state == NOTHING:
        return (
            f"the data ask for nothing, and exclude little: no missing effect has {percent(shares[NONE])}, and all "
            f"other hypotheses share the rest{following}."
        ) + (f" Reason: {agreement(report)}." if agrees(report) else "")
    both = " (each alone or with another cause)" if len(causes) > 1 else ""
    return f"{stated}{both}{following}."


def agreement(report: "Report") -> str:
    """Why "none" has half of the probability where the model agrees."""
    honest = (
        "the error of the model that the controls leave open"
        if report.details.expected
        else "what two codes for the same equations differ by"
    )
    return (
        f"the gap is neither significant nor larger than {honest}, and such an error can look like an effect, so that "
        '"no missing effect" gets half of the probability'
    )


def given_up_words(report: "Report", stand: "Standing") -> list[str]:
    """Why "none" is not among the causes although it has some probability; [] where it is, or has little."""
    chance = stand.shares.get(NONE, 0.0)
    if chance < NEXT or NONE in may_be_named(report):
        return []
    return [
        f"No missing effect ({percent(chance)}) is given up: chance leaves such a gap in fewer than one case of twenty."
    ]


def weak_words(report: "Report") -> list[str]:
    """What makes the probabilities weak, one sentence each."""
    words = []
    fitted, size = report.details.coarse_cells, report.cost.cell_size
    if fitted:
        largest = number(CENTIMETRES * min(fitted.values()))
        words.append(
            f"The cells of {number(CENTIMETRES * size)} cm are coarser than those that the verdict layer was fitted "
            f"with (at most {largest} cm), so these probabilities only rank the causes."
        )
    elif not is_calibrated(report):
        words.append(
            "These probabilities only rank the causes: how often such an answer is right was not tested."
        )
    else:
        words.append(right_words(report))
    name, share = grid_share(report)
    if share >= MUCH:
        words.append(
            f"The grid is {percent(share)} of the variance of the {observable_words(name)}: refine it."
        )
    return words


def is_calibrated(report: "Report") -> bool:
    """Whether the probabilities are those of the fitted verdict layer."""
    return any(one.conformal_p is not None for one in report.details.hypotheses.values())


def grid_share(report: "Report") -> tuple[str, float]:
    """(observable, share of the grid in its variance) where that is largest; ("", 0) without any."""
    shares = {
        name: sources.get(GRID, 0.0) ** 2 / total
        for name, sources in report.details.budget.items()
        if (total := sum(sd**2 for sd in sources.values())) > 0.0
    }
    name = max(shares, key=shares.__getitem__, default="")
    return name, shares.get(name, 0.0)
