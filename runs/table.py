"""The tables of the studies: CSV files that the studies write, and that statements and figures read.

Two kinds of tables are shared by several studies. `scalars.csv` has one row for each run. `curves.csv` has one
row for each curve: equidistant values, separated by blanks, along `axis` from `start` by `step`. A front
that has stopped is cut there and stays where it is. Its velocity is not in the tables: it follows from the
front (`Tables.line` of `VELOCITY`).
"""

import csv
import io
import math
import re
from copy import copy
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.signal import savgol_filter

from fvcollapse.files.atomic import write_atomic
from runs.measured import Measured, from_grids

RUNS = Path(__file__).parent
SCALARS, CURVES, LABELS = "scalars.csv", "curves.csv", "labels.csv"
RUN = ("case", "refinement", "cell_size_mm")
CURVE = ("quantity", "t_s", "x_m", "axis", "start", "step", "values")
REFINEMENTS = (1.0, 1.5, 2.0, 3.0, 4.0)  # cells of 6, 4, 3, 2, 1.5 mm
FINE = REFINEMENTS[1]  # on which every number of a statement is known
VELOCITY = "velocity_m_s"
VELOCITY_WINDOW = 9  # points: 80 ms, second order, so that a peak keeps its height
EARLIEST = 8  # points; before 80 ms the front is a vertical wall, read to a cell only
SAME_TIME = 0.011  # s; half the interval of the profiles, and a little


class MissingRun(LookupError):
    """A case, or a curve of it, that is not in the tables."""


class Curve(NamedTuple):
    """Equidistant values along t, x or z, (n,); `t` and `x` say when and where, NaN if it has none.

    `digits`: decimals that are written; negative: that many significant digits.
    """

    quantity: str
    t: float
    x: float
    axis: str
    start: float
    step: float
    values: np.ndarray
    digits: int


class Line(NamedTuple):
    """A curve of the tables: abscissae and values, (n,) each."""

    at: np.ndarray
    values: np.ndarray


def write_table(path, rows, columns=None):
    """Write a table as a whole, or not at all, and make its folder.

    Parameters
    ----------
    path : Path
    rows : iterable of dict
        Column -> value. Numbers are written to six digits; None, NaN and what is missing are empty cells.
    columns : sequence of str, optional
        Default: all columns of the rows, in the order in which they come up.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    rows = [{name: cell(value) for name, value in row.items()} for row in rows]
    columns = columns or list(dict.fromkeys(name for row in rows for name in row))
    stream = io.StringIO(newline="")
    writer = csv.DictWriter(stream, columns, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomic(path, stream.getvalue().encode())


def cell(value):
    """The text of one cell."""
    if value is None or (isinstance(value, float | np.floating) and math.isnan(value)):
        return ""
    return f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)


def curve_row(first, curve):
    """A `Curve` as a row, `first` being its first cells."""
    return first | {
        "quantity": curve.quantity,
        "t_s": curve.t,
        "x_m": curve.x,
        "axis": curve.axis,
        "start": float(curve.start),
        "step": float(curve.step),
        "values": " ".join(number(value, curve.digits) for value in curve.values),
    }


def number(value, digits):
    """A value with `digits` decimals (negative: that many significant ones), short; "-" for NaN."""
    if math.isnan(value):
        return "-"
    if digits < 0:
        return f"{value:.{-digits}g}"
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"
    return "0" if text in ("-0", "") else text


def read_table(path):
    """The rows of a table as dictionaries of texts; [] if there is no such file."""
    csv.field_size_limit(1_000_000)
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def to_float(text):
    """A number, NaN for an empty cell."""
    return float(text) if text not in ("", "-") else math.nan


def as_line(row):
    """The `Line` of a row of curves."""
    values = np.array([to_float(text) for text in row["values"].split()])
    at = float(row["start"]) + float(row["step"]) * np.arange(len(values))
    return Line(at, values)


def front_velocity(front, step):
    """Slope of a front curve by local parabolas over 80 ms, (n,), m/s; no less than zero."""
    slope = savgol_filter(front, VELOCITY_WINDOW, 2, deriv=1, delta=step)
    return np.maximum(slope, 0.0)


def velocity(front):
    """The `Line` of the velocity of a front, from 80 ms up to where it is at rest."""
    still = 10  # points; more than the window of the slope
    position = np.concatenate([front.values, np.full(still, front.values[-1])])
    step = front.at[1] - front.at[0]
    at = np.concatenate([front.at, front.at[-1] + step * np.arange(1, still + 1)])
    slope = front_velocity(position, step)
    slope[:EARLIEST] = math.nan  # a vertical wall is read to a cell only
    return Line(at, slope)


def reference(case):
    """The mu(I) case of the same slope and width."""
    return re.sub(r"^.*(_a\d+_w\w+)$", r"muI\1", case)


class Row(dict):
    """The numbers of a run by column; a column that the table does not have is a `MissingRun`."""

    def __missing__(self, column):
        raise MissingRun(f"the tables have no {column}")


class Tables:
    """All `scalars.csv` and `curves.csv` below the folder of a study.

    Attributes
    ----------
    scalars : dict
        {(case, refinement): {column: float}}; NaN where a cell is empty.
    curves : dict
        {(case, refinement, quantity): [row, …]}
    front_mm : int
        Thickness at which the front is read [mm]: 1, 5 or 10.
    asked : dict
        Names of the cases that were read, in their order (the values say nothing).
    """

    def __init__(self, folder, front_mm=5):
        self.front_mm = front_mm
        self.folder, self.scalars, self.curves, self.asked = Path(folder), {}, {}, {}
        for path in sorted(self.folder.glob(f"*/{SCALARS}")):
            for row in read_table(path):
                key = row.pop("case"), float(row.pop("refinement"))
                self.scalars[key] = Row((name, to_float(text)) for name, text in row.items())
        for path in sorted(self.folder.glob(f"*/{CURVES}")):
            for row in read_table(path):
                key = row["case"], float(row["refinement"]), row["quantity"]
                self.curves.setdefault(key, []).append(row)

    @property
    def runout(self):
        """Column of the runout."""
        return f"runout_{self.front_mm}mm_m"

    @property
    def front(self):
        """Quantity of the front curve at this thickness."""
        return "front_m" if self.front_mm == 5 else f"front_{self.front_mm}mm_m"

    def read_at(self, front_mm):
        """The same tables with the front read at another thickness [mm]."""
        other = copy(self)
        other.front_mm, other.asked = front_mm, {}
        return other

    def row(self, case, refinement=1.0):
        """All numbers of a run that reached its end.

        Raises
        ------
        MissingRun
        """
        self.asked[case] = None
        found = self.scalars.get((case, refinement))
        if found is None or not found["complete"]:
            raise MissingRun(f"{case} at refinement {refinement:g} is not in the tables")
        return found

    def value(self, case, column):
        """A number with its grid uncertainty, `Measured`.

        A case that was run on one grid has the uncertainty of mu(I) with the same slope and width.
        """
        found = self.measure(lambda r: self.row(case, r)[column])
        like = reference(case)
        if (case, FINE) in self.scalars or (like, FINE) not in self.scalars:
            return found
        return found._replace(uncertainty=self.measure(lambda r: self.row(like, r)[column])[1])

    def difference(self, case, other, column):
        """The number of `case` less that of `other`, `Measured`.

        Where both were run on the same two grids or more the uncertainty is that of the difference:
        what two runs have in common does not count. Otherwise both numbers are those of the coarse
        grid, and the two uncertainties are added as squares.
        """
        if all((name, FINE) in self.scalars for name in (case, other)):
            return self.measure(lambda r: self.row(case, r)[column] - self.row(other, r)[column])
        ours, theirs = self.value(case, column), self.value(other, column)
        value = self.row(case)[column] - self.row(other)[column]
        error = math.hypot(ours.uncertainty, theirs.uncertainty)
        return Measured(value, error, ours.cases | theirs.cases)

    def measure(self, function):
        """`function(refinement)` on the finest grid with runs of the same length, `Measured`; or `MissingRun`."""
        before, self.asked = self.asked, {}
        sizes, values = [], []
        try:
            for refinement in REFINEMENTS:
                try:
                    value = float(function(refinement))
                except MissingRun:
                    if refinement == 1.0:
                        raise
                    continue
                if self.ends(refinement) == self.ends(1.0):
                    values.append(value)
                    sizes.append(1.0 / refinement)
            return from_grids(sizes, values, frozenset(self.asked))
        finally:
            self.asked = before | self.asked

    def ends(self, refinement):
        """Last times of the runs that were read."""
        return [self.scalars.get((case, refinement), {}).get("end_s") for case in self.asked]

    def line(self, case, quantity, t=None, x=None, refinement=1.0):
        """The `Line` of a quantity, nearest to a time [s] and a place [m] where they matter.

        Raises
        ------
        MissingRun
        """
        if quantity == VELOCITY:
            return velocity(self.line(case, "front_m", refinement=refinement))
        self.asked[case] = None
        found = self.curves.get((case, refinement, quantity), [])
        for name, wanted in (("t_s", t), ("x_m", x)):
            if wanted is not None:
                found = [row for row in found if abs(float(row[name]) - wanted) < SAME_TIME]
        if not found:
            raise MissingRun(f"{case} at refinement {refinement:g} has no {quantity}")
        return as_line(found[0])

    def columns(self, case, quantity, refinement=1.0):
        """Time, and {x: Line} of a field that is kept by columns."""
        found = self.curves.get((case, refinement, quantity), [])
        if not found:
            raise MissingRun(f"{case} at refinement {refinement:g} has no {quantity}")
        return float(found[0]["t_s"]), {float(row["x_m"]): as_line(row) for row in found}

    def cell_size(self, case, refinement=1.0):
        """Cell size of a run [mm]."""
        return self.row(case, refinement)["cell_size_mm"]
