"""A statement under all readings: on each bed, and with the front at 1, 5 and 10 mm of thickness.

The paper's reading is grains that slide on the bed, fronts at 5 mm. A statement is confirmed or refuted when this
reading is and none contradicts it, and depends on the bed, or on the front, when two readings contradict each other. It
cannot be told otherwise, nor when a reading contradicts with our limit and not with a little other one (`verdicts`).
"""

from typing import NamedTuple

from runs.paper.beds import SLIDES, WORDS
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED, Claim

FRONTS = (5, 1, 10)  # mm, the paper's reading first
ON_BED, ON_FRONT = "depends on the bed", "depends on the front"
VERDICTS = (CONFIRMED, REFUTED, ON_BED, ON_FRONT, OPEN)


class Settled(NamedTuple):
    """One claim with its `Statement` under each reading, {(bed, front in mm): Statement}; the paper's is the first."""

    claim: Claim
    readings: dict

    @property
    def paper(self):
        """The statement as the paper reads it."""
        return self.readings[SLIDES, FRONTS[0]]

    @property
    def verdict(self):
        """One of `VERDICTS`."""
        found = {key: statement.verdict for key, statement in self.readings.items()}
        decided = {verdict for verdict in found.values() if verdict != OPEN}
        if len(decided) < 2:
            as_read = {statement.as_read for statement in self.readings.values()} - {OPEN}
            return OPEN if as_read - {self.paper.verdict} else self.paper.verdict
        for front in FRONTS:
            if len({v for (_, mm), v in found.items() if mm == front and v != OPEN}) == 2:
                return ON_BED
        return ON_FRONT

    def others(self):
        """The readings beside the paper's in words, those of one verdict together."""
        told = []
        for verdict in (CONFIRMED, REFUTED, OPEN):
            names = [
                reading_name(key, self.claim.front)
                for key, statement in self.readings.items()
                if statement.verdict == verdict and statement is not self.paper
            ]
            if names:
                told.append(f"{verdict}: {', '.join(names)}")
        return "; ".join(told)

    def contrary(self):
        """Bed, front and the `Statement` of the first reading that contradicts the paper's; None without one."""
        first = self.paper.verdict
        for (bed, front), statement in self.readings.items():
            if statement.verdict not in (first, OPEN) and self.verdict in (ON_BED, ON_FRONT):
                return bed, front, statement
        return None


def reading_name(key, with_front):
    """A reading in words."""
    bed, front = key
    return f"{WORDS[bed]}, {front} mm" if with_front else WORDS[bed]


def settle(claims, tables):
    """The `Settled` of claims, from {bed: Tables} of the beds that were run.

    Parameters
    ----------
    claims : sequence of Claim
    tables : dict
        The bed that slides is among them.
    """
    at = {(bed, mm): of.read_at(mm) for bed, of in tables.items() for mm in FRONTS}
    return [Settled(claim, readings(claim, at)) for claim in claims]


def readings(claim, at):
    """The `Statement` of a claim under each reading that it has and that was run; the paper's in any case."""
    found = {
        (bed, mm): claim.statement(tables)
        for (bed, mm), tables in at.items()
        if (claim.front or mm == FRONTS[0]) and (claim.on_beds or bed == SLIDES)
    }
    first = SLIDES, FRONTS[0]
    return {key: of for key, of in found.items() if of.clauses or key == first}
