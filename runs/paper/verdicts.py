"""How a number becomes a verdict: a clause is a measured value against a limit, with its uncertainty.

Confirmed: beyond the limit by more than the grid uncertainty. Not confirmed: on the other side by
as much. Between: cannot tell. A statement is confirmed when all its clauses are, not confirmed when
one is not, and cannot be told otherwise, nor without any clause.
"""

import math
from typing import NamedTuple

from runs.measured import Measured
from runs.table import MissingRun

FEW = 6  # clauses that are listed one by one
CONFIRMED, REFUTED, OPEN = "confirmed", "not confirmed", "cannot tell"


class Clause(NamedTuple):
    """A value against a limit.

    Attributes
    ----------
    label : str
        Which case, in a word or two.
    measured : Measured
        NaN: not measured; with an uncertainty that is not known, "?", one cannot tell.
    sense : str
        "above", "below" or "within".
    limit : float or (float, float)
    unit : str
    """

    label: str
    measured: Measured
    sense: str
    limit: float | tuple
    unit: str = ""

    @property
    def value(self):
        """The number."""
        return self.measured.value

    @property
    def uncertainty(self):
        """Its grid uncertainty."""
        return self.measured.uncertainty

    @property
    def needed(self):
        """The uncertainty below which one could tell: the distance to the nearest limit."""
        limits = self.limit if isinstance(self.limit, tuple) else (self.limit,)
        return min(abs(self.value - limit) for limit in limits)

    @property
    def verdict(self):
        """One of the three verdicts."""
        if math.isnan(self.value) or math.isnan(self.uncertainty):
            return OPEN
        if self.sense == "within":
            low, high = self.limit
            sides = [
                self._replace(sense="above", limit=low),
                self._replace(sense="below", limit=high),
            ]
            return combined([side.verdict for side in sides])
        sign = 1.0 if self.sense == "above" else -1.0
        beyond = sign * (self.value - self.limit)
        if beyond > self.uncertainty:
            return CONFIRMED
        return REFUTED if beyond <= -self.uncertainty else OPEN

    def text(self):
        """The label, the value and its uncertainty."""
        if math.isnan(self.value):
            return f"{self.label} –".strip()
        error = "?" if math.isnan(self.uncertainty) else f"{rounded(self.uncertainty)}"
        return f"{self.label} {rounded(self.value)} ± {error}".strip()


def rounded(value):
    """Three significant digits, without an exponent where there need not be one."""
    if value == 0.0 or 1e-4 <= abs(value) < 1e4:
        digits = 0 if value == 0.0 else max(0, 2 - math.floor(math.log10(abs(value))))
        return f"{value:.{min(digits, 4)}f}"
    return f"{value:.1e}"


def combined(verdicts):
    """The verdict on a statement from those on its clauses."""
    if REFUTED in verdicts:
        return REFUTED
    return CONFIRMED if verdicts and set(verdicts) == {CONFIRMED} else OPEN


class Statement(NamedTuple):
    """What the paper says and what came of it.

    Attributes
    ----------
    place : str
        Figure or section.
    claim : str
        What is said, in short.
    criterion : str
        In words, with the threshold.
    clauses : list of Clause
    also : str
        What was measured beside it; no part of the verdict.
    """

    place: str
    claim: str
    criterion: str
    clauses: list
    also: str = ""

    @property
    def verdict(self):
        """One of the three verdicts."""
        return combined([clause.verdict for clause in self.clauses])

    def measured(self):
        """The numbers: of each clause, or of many the range and those that are not confirmed."""
        named = [clause for clause in self.clauses if clause.verdict != CONFIRMED]
        if len(self.clauses) <= FEW:
            text = listing(self.clauses)
        else:
            known = [of for of in self.clauses if not math.isnan(of.value)]
            units = dict.fromkeys(of.unit for of in known)
            text = "; ".join(span([of for of in known if of.unit == unit]) for unit in units)
            text += f"; of these {listing(named)}" if named else ""
        if len(self.clauses) > 1 and named:
            text += f" ({len(self.clauses) - len(named)} of {len(self.clauses)} confirmed)"
        return ". ".join(part for part in (text, self.also) if part)


def listing(clauses):
    """Clauses one by one, a unit that all share at the end."""
    units = {clause.unit for clause in clauses}
    if len(units) == 1:
        return f"{'; '.join(clause.text() for clause in clauses)} {units.pop()}".strip()
    return "; ".join(f"{clause.text()} {clause.unit}".strip() for clause in clauses)


def span(clauses):
    """Number and range of the values of clauses of one unit."""
    values = [clause.value for clause in clauses]
    low, high = rounded(min(values)), rounded(max(values))
    return f"{len(values)} values, {low} to {high} {clauses[0].unit}".strip()


class Claim(NamedTuple):
    """A statement still to be measured: `measure(tables)` gives its clauses, or (clauses, also).

    `front`: it reads the front, so that its answer may hang on the thickness that counts. `on_beds`: it is no
    statement about the bed itself, nor about what is not in the tables, so that other beds may answer otherwise.
    """

    place: str
    claim: str
    criterion: str
    measure: object
    front: bool = False
    on_beds: bool = True

    def statement(self, tables):
        """The `Statement` from the tables; without clauses where a run is missing."""
        try:
            found = self.measure(tables)
        except MissingRun as missing:
            return Statement(self.place, self.claim, self.criterion, [], f"not run: {missing}")
        clauses, also = found if isinstance(found, tuple) else (found, "")
        return Statement(self.place, self.claim, self.criterion, clauses, also)


def claims():
    """An empty list and the decorator that adds a measure to it."""
    listed = []

    def claim(place, text, criterion, front=False, on_beds=True):
        def add(measure):
            listed.append(Claim(place, text, criterion, measure, front, on_beds))
            return measure

        return add

    return listed, claim
