"""A run beside another run, or beside an experiment: the differences of all observables.

A run that still moves at its end has no deposit: its runout, final height and time of arrest are shown beside those
that were measured, without a difference, and its curves are compared over the time that it covers.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import isclose, isinf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fvcollapse.errors import InputError
from fvcollapse.measure.align import SAME_TIME, align, as_grid, on_points
from fvcollapse.measure.experiment_keys import CASE_KEYS, REQUIRED
from fvcollapse.measure.observables import observe
from fvcollapse.measure.quantities import (
    CENTIMETRE,
    CURVES,
    PERCENT,
    QUANTITIES,
    SCALAR_UNITS,
    Shown,
    observable_words,
)

if TYPE_CHECKING:
    from fvcollapse.measure.curves import Curve
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations
    from fvcollapse.output.result import Result


COLUMNS = ("observable", "unit", "first", "second", "difference", "uncertainty", "note")
RUNOUTS = ("runout_10mm", "runout_1mm", "x_99")  # of the series, beside the observables
DEPOSIT = ("deposit", "arrest")  # phases whose numbers only a pile at rest has
MOVES = "still moves"
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
        Of a curve the root mean square over the common points; None of a deposit beside a run that still moves.
    uncertainty : float or None
        Standard deviation of the measurement, of a curve the root mean square; None between runs.
    note : str
        What limits the row; empty where nothing does.
    """

    observable: str
    unit: str
    first: float | None
    second: float | None
    difference: float | None
    uncertainty: float | None = None
    note: str = ""


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
    if any(moves(one) for one in seen):
        rows = [row._replace(note=MOVES) if is_of_deposit(row.observable) else row for row in rows]
    return rows + [curve(name, *seen) for name in CURVES]


def moves(observations: "Observations") -> bool:
    """Whether a run still moves at its end."""
    return observations.scalars["time_stop"] is None


def is_of_deposit(name: str) -> bool:
    """Whether a number is one that only a pile at rest has."""
    return name in RUNOUTS or (name in QUANTITIES and QUANTITIES[name].phase in DEPOSIT)


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
        The run is of another set-up.
    """
    refuse_other_set_up(result, experiment)
    observations = observe(result, experiment)
    common = replace(experiment, curves=covered(observations, experiment.curves))
    rows = []
    for one in align(observations, common):
        sigma = rms(one.sigma)
        if one.name in CURVES:
            note = points_left_out(experiment.curves[one.name], common.curves[one.name])
            row = Difference(f"{RMS}{one.name}", one.units, None, None, rms(one.gap), sigma, note)
        elif moves(observations) and is_of_deposit(one.name):
            simulated = observations.scalars[one.name]
            row = Difference(
                one.name, one.units, simulated, float(one.measured[0]), None, sigma, MOVES
            )
        else:
            pair = float(one.simulated[0]), float(one.measured[0])
            row = Difference(one.name, one.units, *pair, float(one.gap[0]), sigma)
        rows.append(row)
    return rows


def covered(observations: "Observations", curves: "dict[str, Curve]") -> "dict[str, Curve]":
    """The measured points that a run reaches: all, if it came to rest; no curve without any."""
    if not moves(observations):
        return curves
    end = observations.front[-1, 0] + SAME_TIME
    cut = {name: of_times(curve, curve.time <= end) for name, curve in curves.items()}
    return {name: curve for name, curve in cut.items() if len(curve.time)}


def of_times(curve: "Curve", here: np.ndarray) -> "Curve":
    """Some of the points of a curve."""
    time, x, value, sigma = curve
    return type(curve)(time[here], None if x is None else x[here], value[here], sigma[here])


def points_left_out(measured: "Curve", common: "Curve") -> str:
    """How much of a curve is compared; empty if all is."""
    count, total = len(common.time), len(measured.time)
    return "" if count == total else f"to {common.time[-1]:.4g} s, {count} of {total} points"


def remarks(
    names: Sequence[str],
    result: "Result",
    other: "Result | None" = None,
    experiment: "Experiment | None" = None,
) -> list[str]:
    """What a reader of the differences has to know: which run still moves, and which settings are not the same.

    Parameters
    ----------
    names : (str, str)
    result : Result
    other : Result, optional
    experiment : Experiment, optional
        One of the two is given.
    """
    runs = [(names[0], result)] + ([] if other is None else [(names[1], other)])
    found = []
    for name, run in runs:
        if moves(observe(run)):
            time, speed = run.series["time"][-1], run.series["max_speed"][-1]
            found.append(
                f"{name} still moves at its end, t = {time:.4g} s ({speed:.2g} m/s): its runout, final height and time"
                " of arrest are not those of a deposit. Give it a later time.end."
            )
    if experiment is not None:
        observations = observe(result, experiment)
        left = sorted(set(experiment.curves) - set(covered(observations, experiment.curves)))
        found += [
            f"{name} was measured after the end of the run only: not compared" for name in left
        ]
        other_settings = differing_settings(result, experiment)
        found += [f"another setting: {words}" for words in other_settings]
    return found


def differing_settings(result: "Result", experiment: "Experiment") -> list[str]:
    """The settings that a case has otherwise than an experiment has them, in words."""
    given, own = result.case, experiment.case()
    found = []
    for key, (path, absent) in CASE_KEYS.items():
        stated = experiment.stated(key)
        if key in REQUIRED or (stated is None and absent is None):
            continue
        value, wanted = (value_of(case, path) for case in (given, own))
        if same(value, wanted):
            continue
        reason = "" if stated is not None else f", as it states no {key}"
        found.append(f"{path} is {value:g} in the run, {wanted:g} in {experiment.name}{reason}")
    return found


def value_of(case: Any, path: str) -> float:
    """The value of a dotted key."""
    section, _, name = path.partition(".")
    return float(getattr(getattr(case, section), name))


def same(one: float, other: float) -> bool:
    """Whether two numbers are the same setting."""
    return one == other or (not isinf(one) and isclose(one, other, rel_tol=SAME))


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
    """The rows as aligned plain text, lengths in cm; `names` are those of the first and of the second."""
    cells: list[tuple[str, ...]] = [("", "unit", *names, "difference", "uncertainty", "")]
    for row in rows:
        factor, unit = shown_in(row.unit)
        numbers = (None if value is None else factor * value for value in row[2:6])
        cells.append(
            (in_words(row.observable), unit, *(shown(value) for value in numbers), row.note)
        )
    last = len(cells[0]) - 1
    widths = [max(len(row[column]) for row in cells) for column in range(last + 1)]
    lines = [
        "  ".join(
            word.ljust(width) if n in (0, 1, last) else word.rjust(width)
            for n, (word, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in cells
    ]
    return "\n".join(lines)


def in_words(name: str) -> str:
    """The observable of a row in words."""
    is_curve = name.startswith(RMS)
    return (RMS if is_curve else "") + observable_words(name.removeprefix(RMS))


def shown_in(unit: str) -> Shown:
    """Factor and unit in which the table prints a quantity of an SI unit, as the picture has it."""
    return {"m": CENTIMETRE, "1": PERCENT}.get(unit, Shown(1.0, unit))


def shown(value: float | None) -> str:
    """A number in four digits; a dash for none."""
    return "-" if value is None else f"{value:.4g}"
