"""A run beside another run, or beside an experiment: the differences of all observables."""

from collections.abc import Sequence
from math import isclose
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.errors import InputError
from fvcollapse.measure.align import align, as_grid, on_points
from fvcollapse.measure.observables import observe
from fvcollapse.measure.quantities import CURVES, SCALAR_UNITS

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations
    from fvcollapse.output.result import Result


COLUMNS = ("observable", "unit", "first", "second", "difference", "uncertainty")
RUNOUTS = ("runout_10mm", "runout_1mm", "x_99")  # of the series, beside the observables
SAME = 1.0e-6  # relative difference of sizes that are the same
RMS = "rms difference of "


class Difference(NamedTuple):
    """One row; `difference` is first - second.

    Attributes
    ----------
    observable, unit : str
    first, second : float or None
        None for a curve, and where a run has no such number.
    difference : float or None
        Of a curve the root mean square over the common points.
    uncertainty : float or None
        Standard deviation of the measurement, of a curve the root mean square; None between runs.
    """

    observable: str
    unit: str
    first: float | None
    second: float | None
    difference: float | None
    uncertainty: float | None = None


def between_runs(first: "Result", second: "Result") -> list[Difference]:
    """The `Difference` list of two `Result`s, on the times of the second one that both cover."""
    seen = [observe(result) for result in (first, second)]
    rows = [
        numbers(name, unit, *(one.scalars[name] for one in seen))
        for name, unit in SCALAR_UNITS.items()
    ]
    rows += [
        numbers(name, "m", *(float(result.series[name][-1]) for result in (first, second)))
        for name in RUNOUTS
    ]
    return rows + [curve(name, *seen) for name in CURVES]


def numbers(name: str, unit: str, first: float | None, second: float | None) -> Difference:
    """The row of two numbers."""
    difference = None if first is None or second is None else first - second
    return Difference(name, unit, first, second, difference)


def curve(name: str, first: "Observations", second: "Observations") -> Difference:
    """The row of a curve of two `Observations`."""
    one, other = getattr(first, name), getattr(second, name)
    common = other[other[:, 0] <= one[-1, 0]]
    if CURVES[name].is_profile:
        values = on_points(*as_grid(one), common[:, 0], common[:, 1])
    else:
        values = np.interp(common[:, 0], one[:, 0], one[:, 1])
    return Difference(f"{RMS}{name}", CURVES[name].unit, None, None, rms(values - common[:, -1]))


def to_experiment(result: "Result", experiment: "Experiment") -> list[Difference]:
    """The `Difference` list of a `Result` and an `Experiment`, on the measured points.

    Raises
    ------
    InputError
        The run is of another set-up, or ends in motion before the last measured time.
    """
    refuse_other_set_up(result, experiment)
    rows = []
    for one in align(observe(result, experiment), experiment):
        sigma = rms(one.sigma)
        if one.name in CURVES:
            rows.append(Difference(f"{RMS}{one.name}", one.units, None, None, rms(one.gap), sigma))
        else:
            pair = float(one.simulated[0]), float(one.measured[0])
            rows.append(Difference(one.name, one.units, *pair, float(one.gap[0]), sigma))
    return rows


def refuse_other_set_up(result: "Result", experiment: "Experiment") -> None:
    """Refuse a run whose slope or column is not that of the experiment."""
    for name in ("slope_angle_deg", "height_0", "length_0"):
        stated = getattr(experiment.settings.geometry, name)
        given = getattr(result.case.geometry, name)
        if not isclose(stated, given, rel_tol=SAME):
            allowed = f"{stated:g}, as {experiment.name} has it"
            raise InputError(result.path or "result", f"geometry.{name}", f"{given:g}", allowed)


def rms(values: np.ndarray) -> float:
    """Root mean square; NaN of none."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def table(rows: list[Difference], names: Sequence[str]) -> str:
    """The rows as aligned plain text; `names` are those of the first and of the second."""
    cells: list[tuple[str, ...]] = [("", "unit", *names, "difference", "uncertainty")]
    cells += [
        (row.observable.replace("_", " "), row.unit, *(shown(value) for value in row[2:]))
        for row in rows
    ]
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    lines = [
        "  ".join(
            word.ljust(width) if n < 2 else word.rjust(width)
            for n, (word, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in cells
    ]
    return "\n".join(lines)


def shown(value: float | None) -> str:
    """A number in four digits; a dash for none."""
    return "-" if value is None else f"{value:.4g}"
