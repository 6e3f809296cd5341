"""Simulated and measured values on common points: the measured ones.

Both sides have gone through the same operator before (`observe` with the experiment's front
threshold and time origin). Here the simulated side is interpolated to the times and places of the
measurement, and every pair gets its units and standard deviation. Gap = simulated - measured.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.errors import InputError
from fvcollapse.measure.quantities import CURVES, SCALAR_UNITS

if TYPE_CHECKING:
    from fvcollapse.measure.curves import Scalar
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations


SAME_TIME = 1.0e-9  # s


@dataclass(frozen=True)
class Aligned:
    """One observable on its measured points, (n,) each; SI units.

    Attributes
    ----------
    name, units : str
    time, x : (n,) arrays
        On the clock of the experiment; NaN where the observable has none.
    measured, simulated, sigma : (n,) arrays
        `sigma` is the standard deviation of the measurement.
    kind : str
        "value", or "upper" or "lower": then `measured` is a bound.
    """

    name: str
    units: str
    time: np.ndarray
    x: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    sigma: np.ndarray
    kind: str = "value"

    @property
    def gap(self) -> np.ndarray:
        """Simulated - measured, (n,); of a bound only what is beyond it."""
        difference = self.simulated - self.measured
        if self.kind == "upper":
            return np.maximum(difference, 0.0)
        if self.kind == "lower":
            return np.minimum(difference, 0.0)
        return difference


def align(observations: "Observations", experiment: "Experiment") -> list[Aligned]:
    """Every observable that was measured, on the points of the measurement.

    Parameters
    ----------
    observations : Observations
        As `observe(result, experiment)` returns them.
    experiment : Experiment

    Returns
    -------
    list of Aligned
        Curves in the order of `quantities.CURVES`, then scalars. A simulation at rest keeps its last value; one
        that is still moving stops, for `time_stop`, at its end at the earliest.

    Raises
    ------
    InputError
        The simulation ends in motion before the last measured time.
    """
    for name, curve in experiment.curves.items():
        refuse_uncovered(observations, experiment.folder / f"{name}.csv", curve.time[-1])
    curves = [align_curve(observations, experiment, name) for name in experiment.curves]
    return curves + [align_scalar(observations, scalar) for scalar in experiment.scalars]


def refuse_uncovered(observations: "Observations", path: str | Path, last: float) -> None:
    """Refuse a measured time that a simulation in motion does not reach."""
    end = observations.front[-1, 0]
    if last > end + SAME_TIME and observations.scalars["time_stop"] is None:
        limit = f"<= {end:g}, where the simulation ends in motion: give it a later time.end"
        raise InputError(path, "t_s", f"{last:g}", limit)


def align_curve(observations: "Observations", experiment: "Experiment", name: str) -> Aligned:
    """One measured curve beside the simulated one."""
    curve = experiment.curves[name]
    rows = getattr(observations, name)
    if curve.x is None:
        simulated = np.interp(curve.time, rows[:, 0], rows[:, 1])
    else:
        simulated = on_points(*as_grid(rows), curve.time, curve.x)
    place = np.full(len(curve.time), np.nan) if curve.x is None else curve.x
    unit = CURVES[name].unit
    return Aligned(name, unit, curve.time, place, curve.value, simulated, curve.sigma)


def as_grid(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(time (m,), x (nx,), values (m, nx)) of profiles in rows (time, x, value)."""
    width = int(np.count_nonzero(rows[:, 0] == rows[0, 0]))
    return rows[::width, 0], rows[:width, 1], rows[:, 2].reshape(-1, width)


def on_points(
    time: np.ndarray, x: np.ndarray, values: np.ndarray, at_time: np.ndarray, at_x: np.ndarray
) -> np.ndarray:
    """Profiles interpolated linearly in time and along the bed, (n,).

    Before the first time and after the last one the nearest profile holds; beyond the last x there
    are no grains.

    Parameters
    ----------
    time, x, values : (m,), (nx,), (m, nx) arrays
        Profiles [s, m, m].
    at_time, at_x : (n,) arrays
        Points [s, m].
    """
    found = np.empty(len(at_time))
    for moment in np.unique(at_time):
        here = at_time == moment
        after = int(np.clip(np.searchsorted(time, moment), 1, max(1, len(time) - 1)))
        before, after = after - 1, min(after, len(time) - 1)
        span = time[after] - time[before]
        share = np.clip((moment - time[before]) / span, 0.0, 1.0) if span > 0.0 else 0.0
        profile = (1.0 - share) * values[before] + share * values[after]
        found[here] = np.interp(at_x[here], x, profile, right=0.0)
    return found


def align_scalar(observations: "Observations", scalar: "Scalar") -> Aligned:
    """One measured number beside the simulated one."""
    simulated = observations.scalars[scalar.name]
    if simulated is None:  # still moving: it stops at the end of the run at the earliest
        simulated = observations.front[-1, 0]
    none = np.array([np.nan])
    return Aligned(
        scalar.name,
        SCALAR_UNITS[scalar.name],
        none,
        none,
        np.array([scalar.value]),
        np.array([simulated]),
        np.array([scalar.sigma]),
        scalar.kind,
    )
