"""What the series of a run say: front velocity and its peak, arrest, energy lost.

They are read without the compiled kernels, so that a result opens at once.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

SPEED_REST = 1.0e-3  # m/s; the collapse has arrested when nothing is faster
WORKS = ("work_bulk", "work_bed", "work_back_wall", "work_lateral", "work_gate")
LOSSES = ("loss_time", "loss_advection", "loss_surface")  # to the discretisation
ENERGY_SPENT = (*WORKS, "energy_outflow")  # since t = 0; series of these names, J/m
VELOCITY_WINDOW = 0.040  # s; width of the window of the front velocity


def front_velocity(time: ArrayLike, front: ArrayLike) -> np.ndarray:
    """Least-squares slope of front(time) over a centred window of 40 ms, (n,), m/s.

    At the ends the window is cut to what exists. A window with fewer than three points takes the
    nearest ones in time order; fewer than two points in all give zero.
    """
    time, front = np.asarray(time, float), np.asarray(front, float)
    n = len(time)
    if n < 2:
        return np.zeros(n)
    slack = 0.5 * VELOCITY_WINDOW * (1.0 + 1.0e-9)
    first = np.searchsorted(time, time - slack, side="left")
    last = np.searchsorted(time, time + slack, side="right")
    velocity = np.empty(n)
    for j in range(n):
        a, b = first[j], last[j]
        if b - a < 3:
            a = max(0, min(j - 1, n - 3))
            b = min(n, a + 3)
        t = time[a:b] - time[a:b].mean()
        velocity[j] = (t @ (front[a:b] - front[a])) / (t @ t)
    return velocity


def peak_front_velocity(time: np.ndarray, velocity: np.ndarray) -> tuple[float, float]:
    """(value [m/s], time [s]) of the largest front velocity whose window is not cut at an end.

    A one-sided slope is no peak; it counts only where the record is shorter than a window.
    """
    half = 0.5 * VELOCITY_WINDOW
    centred = (time >= time[0] + half) & (time <= time[-1] - half)
    if not centred.any():
        centred = np.ones(len(time), dtype=bool)
    peak = int(np.argmax(np.where(centred, velocity, -np.inf)))
    return float(velocity[peak]), float(time[peak])


def arrest_time(time: np.ndarray, max_speed: np.ndarray) -> float | None:
    """First time after which nothing reaches 1 mm/s any more [s]; None if still moving."""
    moving = np.flatnonzero(np.asarray(max_speed) >= SPEED_REST)
    if moving.size == 0:
        return float(time[0])
    return float(time[moving[-1] + 1]) if moving[-1] + 1 < len(time) else None


def numerical_loss(series: Mapping[str, Any]) -> np.ndarray:
    """Energy that the run has lost to the discretisation since t = 0 [J/m]; negative where it gained.

    Parameters
    ----------
    series : mapping of (n,) sequences
        With `kinetic_energy`, `potential_energy` and the names in `ENERGY_SPENT`.
    """
    total = sum(
        np.asarray(series[name], float)
        for name in ("kinetic_energy", "potential_energy", *ENERGY_SPENT)
    )
    return total[0] - total if total.size else total  # type: ignore[index, union-attr, return-value]
