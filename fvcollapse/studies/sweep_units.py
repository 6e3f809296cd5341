"""Unit and meaning of the columns of `sweep.csv`, for its heading on the screen and `sweep_units.csv` beside it."""

import csv
import io
from collections.abc import Sequence

from fvcollapse.case.case import describe_keys

UNITS_TABLE = "sweep_units.csv"
NUMBERS = {  # of `Result.summary`: unit (1: a plain number), and what it is
    "time": ("s", "end of the run"),
    "runout_10mm": ("m", "the farthest X from the back wall that a layer of 10 mm has reached"),
    "runout": (
        "m",
        "the farthest X from the back wall that a layer of front.thickness has reached",
    ),
    "final_front": ("m", "where that layer ends at the end, perhaps nearer"),
    "runout_1mm": ("m", "the farthest X from the back wall that a layer of 1 mm has reached"),
    "x_99": ("m", "X up to which 99 % of the volume lies at the end"),
    "final_thickness": ("m", "largest thickness at the end: height of the deposit"),
    "max_thickness": ("m", "largest thickness at any time"),
    "peak_front_velocity": ("m/s", "largest slope of the front over 40 ms"),
    "peak_front_velocity_time": ("s", "when that is"),
    "arrest_time": ("s", "first time after which nothing reaches 1 mm/s; empty: still moving"),
    "final_max_speed": ("m/s", "largest speed at the end"),
    "volume_error_max": ("1", "largest relative change of the volume"),
    "volume_correction": (
        "1",
        "sum of the absolute corrections of the volume, of that at the start",
    ),
    "loss_time": ("J/m", "energy lost to the time step"),
    "loss_advection": ("J/m", "energy lost to the advection"),
    "loss_surface": ("J/m", "energy lost to the motion of the surface"),
    "numerical_loss": ("J/m", "energy lost to the discretisation, the sum of these"),
    "dissipation": ("J/m", "work of friction in the grains, on bed, walls and gate"),
    "detached_volume_max": ("1", "largest part of the volume beyond the 1 mm front"),
    "negative_pressure_cells_max": ("1", "largest number of cells in suction"),
    "steps": ("1", "number of time steps"),
    "sweeps": ("1", "number of nonlinear sweeps"),
    "capped_steps": ("1", "steps whose sweeps stopped above the tolerance"),
    "residual_max": ("1", "largest residual of a step"),
    "wall_time": ("s", "time on the clock that the time loop took"),
}
WORDS = {  # of the columns that are no numbers
    "point": "folder of the run",
    "status": "complete, failed or missing",
    "problem": "why it failed",
    "complete": "whether the run has reached its end",
    "ended_at_rest": "whether it ended before, since the pile rests",
    "trust": "how far the run is to be trusted: fine, look at it or do not use",
    "trust_reasons": "why",
}


def unit_of(column: str) -> str:
    """Unit of a column; "" of words."""
    return about(column)[0]


def about(column: str) -> tuple[str, str]:
    """(unit, meaning) of a column: a key of the case, a number of the summary, or words, which have no unit."""
    if "." in column:
        keys = {info.name: (info.unit, info.description) for info in describe_keys()}
        return keys.get(column, ("", ""))
    return NUMBERS.get(column, ("", WORDS.get(column, "")))


def headed(column: str) -> str:
    """A column with its unit in brackets, where it has one that is worth a word."""
    unit = unit_of(column)
    return f"{column} [{unit}]" if unit not in ("", "1", "-") else column


def units_table(columns: Sequence[str]) -> str:
    """The columns, their units and what they mean as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([("column", "unit", "meaning"), *((name, *about(name)) for name in columns)])
    return text.getvalue()
