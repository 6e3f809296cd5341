"""The tables of the studies: CSV files that the studies write, and that statements and figures read.

Two kinds of tables are shared by several studies. `scalars.csv` has one row for each run. `curves.csv` has one
row for each curve: equidistant values, separated by blanks, along `axis` from `start` by `step`. A front
that has stopped is cut there and stays where it is. Its velocity is not in the tables: it follows from the
front (`Tables.line` of `VELOCITY`).
"""

import csv
import io
import json
import math
import operator
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.signal import savgol_filter

from fvcollapse.files.atomic import write_atomic

RUNS = Path(__file__).parent
SCALARS, CURVES, LABELS = "scalars.csv", "curves.csv", "labels.csv"
RUN = ("case", "refinement", "cell_size_mm")
CURVE = ("quantity", "t_s", "x_m", "axis", "start", "step", "values")
FINE = 1.5  # refinement that gives the uncertainty of the tables
SAFETY = 3.0  # of the difference of two grids, as in the grid convergence index of Roache (1994)
CONVERGENCE = RUNS / "convergence"
WIDTHS = {"w10": "w10cm", "winf": "winf"}  # of the stored convergence studies
STUDIED = {  # column of the tables: observable of these studies
    "runout_10mm_m": "runout_10mm",
    "runout_5mm_m": "runout",
    "runout_1mm_m": "runout_1mm",
    "x_99_m": "x_99",
    "final_height_m": "final_thickness",
    "peak_velocity_m_s": "peak_front_velocity",
    "arrest_s": "arrest_time",
}
VELOCITY = "velocity_m_s"
VELOCITY_WINDOW = 9  # points: 80 ms, second order, so that a peak keeps its height
EARLIEST = 8  # points; before 80 ms the front is a vertical wall, read to a cell only
SAME_TIME = 0.011  # s; half the interval of the profiles, and a little


class MissingRun(LookupError):
    """A case, or a curve of it, that is not in the tables."""


class Measured(NamedTuple):
    """A value and its grid uncertainty, NaN where no finer grid was run."""

    value: float
    uncertainty: float = math.nan


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


# -- writing -------------------------------------------------------------------------------------


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


# -- reading -------------------------------------------------------------------------------------


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


class Tables:
    """All `scalars.csv` and `curves.csv` below the folder of a study.

    Attributes
    ----------
    scalars : dict
        {(case, refinement): {column: float}}; NaN where a cell is empty.
    curves : dict
        {(case, refinement, quantity): [row, …]}
    """

    def __init__(self, folder):
        self.folder, self.scalars, self.curves = Path(folder), {}, {}
        for path in sorted(self.folder.glob(f"*/{SCALARS}")):
            for row in read_table(path):
                key = row.pop("case"), float(row.pop("refinement"))
                self.scalars[key] = {name: to_float(text) for name, text in row.items()}
        for path in sorted(self.folder.glob(f"*/{CURVES}")):
            for row in read_table(path):
                key = row["case"], float(row["refinement"]), row["quantity"]
                self.curves.setdefault(key, []).append(row)

    def row(self, case, refinement=1.0):
        """All numbers of a run that reached its end.

        Raises
        ------
        MissingRun
        """
        found = self.scalars.get((case, refinement))
        if found is None or not found["complete"]:
            raise MissingRun(f"{case} at refinement {refinement:g} is not in the tables")
        return found

    def value(self, case, column):
        """A number with its grid uncertainty, `Measured`.

        The number is that of the finer grid, where there is one. The uncertainty is the grid
        convergence index of the stored study of this slope and width, where that has the number,
        else `SAFETY` times the difference to the grid 1.5 times coarser. A case that was run on the
        coarse grid alone has the uncertainty of mu(I) with the same slope and width.
        """
        value = self.row(case, FINE if self.on_both(case) else 1.0)[column]
        for name in (case, reference(case)):
            if self.on_both(name):
                fine, coarse = self.row(name, FINE)[column], self.row(name)[column]
                index = self.index(case, column) * abs(value)
                return Measured(value, index or SAFETY * abs(fine - coarse))
        return Measured(value)

    def index(self, case, column):
        """Grid convergence index (a fraction) of the convergence study of this slope and width; 0 without one."""
        slope, width = re.search(r"_a(\d+)_(w\w+)$", case).groups()
        path = CONVERGENCE / f"collapse_{slope}deg_{WIDTHS.get(width)}.json"
        if column not in STUDIED or not path.exists():
            return 0.0
        return json.loads(path.read_text(encoding="utf-8"))[STUDIED[column]]["gci"] or 0.0

    def on_both(self, *cases):
        """Whether all these cases were run on both grids."""
        return all((case, r) in self.scalars for case in cases for r in (1.0, FINE))

    def difference(self, case, other, column):
        """The number of `case` less that of `other`, `Measured`.

        Where both were run on both grids the uncertainty is that of the difference: what two runs
        have in common does not count. Two set-ups that both have an index add these as squares.
        Otherwise both numbers are those of the coarse grid, and the two uncertainties are added as
        squares.
        """
        indexed = reference(case) != reference(other) and self.index(case, column)
        indexed = indexed and self.index(other, column)
        if self.on_both(case, other) and not indexed:
            return self.measure(lambda r: self.row(case, r)[column] - self.row(other, r)[column])
        ours, theirs = self.value(case, column), self.value(other, column)
        uncertainty = math.hypot(ours.uncertainty, theirs.uncertainty)
        refinement = FINE if self.on_both(case, other) else 1.0
        rows = (self.row(name, refinement) for name in (case, other))
        return Measured(operator.sub(*(row[column] for row in rows)), uncertainty)

    def measure(self, function):
        """`function(refinement)` on the finer grid, `SAFETY` times its change from the coarse one as uncertainty."""
        coarse = function(1.0)
        try:
            fine = function(FINE)
        except MissingRun:
            return Measured(coarse)
        return Measured(fine, SAFETY * abs(fine - coarse))

    def line(self, case, quantity, t=None, x=None, refinement=1.0):
        """The `Line` of a quantity, nearest to a time [s] and a place [m] where they matter.

        Raises
        ------
        MissingRun
        """
        if quantity == VELOCITY:
            return velocity(self.line(case, "front_m", refinement=refinement))
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
