"""Units of the columns of `sweep.csv`, for its heading on the screen and for `sweep_units.csv` beside it."""

import csv
import io
from collections.abc import Sequence

from fvcollapse.case.case import describe_keys

UNITS_TABLE = "sweep_units.csv"
UNITS = {  # of the numbers of `Result.summary`; 1: a plain number
    "time": "s",
    "runout_10mm": "m",
    "runout": "m",
    "final_front": "m",
    "runout_1mm": "m",
    "x_99": "m",
    "final_thickness": "m",
    "max_thickness": "m",
    "peak_front_velocity": "m/s",
    "peak_front_velocity_time": "s",
    "arrest_time": "s",
    "final_max_speed": "m/s",
    "volume_error_max": "1",
    "volume_correction": "1",
    "loss_time": "J/m",
    "loss_advection": "J/m",
    "loss_surface": "J/m",
    "numerical_loss": "J/m",
    "dissipation": "J/m",
    "detached_volume_max": "1",
    "negative_pressure_cells_max": "1",
    "steps": "1",
    "sweeps": "1",
    "capped_steps": "1",
    "residual_max": "1",
    "wall_time": "s",
}


def unit_of(column: str) -> str:
    """Unit of a column; "" of words."""
    if "." in column:
        units = {info.name: info.unit for info in describe_keys()}
        return units.get(column, "")
    return UNITS.get(column, "")


def headed(column: str) -> str:
    """A column with its unit in brackets, where it has one that is worth a word."""
    unit = unit_of(column)
    return f"{column} [{unit}]" if unit not in ("", "1", "-") else column


def units_table(columns: Sequence[str]) -> str:
    """The columns and their units as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([("column", "unit"), *((name, unit_of(name)) for name in columns)])
    return text.getvalue()
