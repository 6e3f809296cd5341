"""How a number becomes a verdict: a clause is a measured value against a limit, with its uncertainty.

Confirmed: beyond the limit by more than the grid uncertainty. Not confirmed: on the other side by
as much. Between: cannot tell. A statement is confirmed when all its clauses are, not confirmed when
one is not, and cannot be told otherwise, nor without any clause.

A verdict must not hang on what a reader could as well have chosen otherwise. Of a limit that the paper does not state
every value within a quarter counts, and of a number that is read in a window (the part of a curve about its peak, say)
every window that is listed. Where two of these choices give two verdicts, one cannot tell.
"""

import math
from typing import NamedTuple

from runs.measured import Measured
from runs.table import MissingRun

FEW = 6  # clauses that are listed one by one
OURS = 0.25  # of a limit that the paper does not state; another reader may set it so much lower or higher
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
        Of "above" and "below", two numbers are the range in which a reader may set it.
    unit : str
    of_paper : bool
        The paper states the limit. Another one may be set otherwise, by `OURS`.
    windows : tuple of (str, Measured)
        The same number in other windows, with their names.
    """

    label: str
    measured: Measured
    sense: str
    limit: float | tuple
    unit: str = ""
    of_paper: bool = False
    windows: tuple = ()

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
        """The uncertainty below which one could tell: the distance to the nearest limit; 0 among those allowed."""
        both = self.sense == "within"
        sides = (
            zip(*self.limits, strict=True) if both else (self.limits,)
        )  # all lower limits, all upper ones
        return min(
            max(min(side) - self.value, self.value - max(side), 0.0) for side in map(tuple, sides)
        )

    @property
    def limits(self):
        """All limits that a reader may set: numbers, or (low, high) of "within"."""
        if self.of_paper:
            return [self.limit]
        shares = (1.0, 1.0 - OURS, 1.0 + OURS)
        if self.sense == "within":
            low, high = self.limit
            middle, factor = math.sqrt(low * high), math.sqrt(high / low)
            return [(middle / factor**share, middle * factor**share) for share in shares]
        return self.limit if isinstance(self.limit, tuple) else [self.limit * of for of in shares]

    @property
    def verdict(self):
        """That of all windows and limits, if it is the same; else one cannot tell."""
        found = {self.verdict_in(of) for of in (self.measured, *dict(self.windows).values())}
        return found.pop() if len(found) == 1 else OPEN

    def verdict_in(self, measured):
        """The verdict on the number of one window, with every limit that a reader may set."""
        found = {against(measured, self.sense, limit) for limit in self.limits}
        return found.pop() if len(found) == 1 else OPEN

    @property
    def as_read(self):
        """The verdict with the first window and the first limit alone."""
        return against(self.measured, self.sense, self.limits[0])

    def text(self):
        """The label, the value and its uncertainty; and the number of a window that says otherwise."""
        if math.isnan(self.value):
            return f"{self.label} –".strip()
        text = f"{self.label} {told(self.measured)}".strip()
        if self.verdict == self.verdict_in(self.measured):
            return text
        other = next(
            of for of in self.windows if self.verdict_in(of[1]) != self.verdict_in(self.measured)
        )
        return f"{text} ({other[0]}: {told(other[1])})"


def against(measured, sense, limit):
    """The verdict on a number against one limit."""
    if math.isnan(measured.value) or math.isnan(measured.uncertainty):
        return OPEN
    if sense == "within":
        low, high = limit
        return combined([against(measured, "above", low), against(measured, "below", high)])
    beyond = (measured.value - limit) * (1.0 if sense == "above" else -1.0)
    if beyond > measured.uncertainty:
        return CONFIRMED
    return REFUTED if beyond <= -measured.uncertainty else OPEN


def told(measured):
    """Value and uncertainty in words; "?" is one that is not known."""
    error = "?" if math.isnan(measured.uncertainty) else rounded(measured.uncertainty)
    return f"{rounded(measured.value)} ± {error}"


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

    @property
    def as_read(self):
        """The verdict with the first windows and limits alone."""
        return combined([clause.as_read for clause in self.clauses])

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
