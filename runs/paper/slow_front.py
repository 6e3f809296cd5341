"""A slow phase of a front: how fast a front moves to the size of a cell, and where its speed stays.

A front that is read off a grid moves from cell to cell, so its speed is known over whole cells only: two of them, or as
many as take 80 ms. A phase is a stretch of time after the peak in which the speed

- stays within 15 % of its mean,
- has fallen to half of the peak, where its mean stays, and is at least a tenth of it,
- falls by a smaller fraction per time than a third of what it fell per time from the peak to there,
- brings the front at least six cells farther: three speeds that share none.

The third tells it from a front that merely slows down: a constant deceleration takes a growing fraction of the speed,
an exponential decay always the same one. Pure functions of arrays, SI units.
"""

import math
from typing import NamedTuple

import numpy as np

STEP = 0.01  # s, between the times at which the speed is read
SMOOTHED = 0.08  # s, least time over which a speed is taken
MOST_CELLS = 60  # half of the largest way over which a speed is taken; 12 m/s on 8 mm cells
EARLIEST = 0.08  # s; before, the front is a vertical wall that is read to a cell
BAND = 0.15  # of the mean speed
SLOWED, CREEPING = 0.5, 0.1  # of the peak: where a front is slow, and where it creeps
LEAST_WAY = 6.0  # cells: three speeds that share none
STEADIER = 1.0 / 3.0  # of the relative deceleration before
LEAST_TIME = 0.15  # s; the paper's slow phases are no shorter


class Motion(NamedTuple):
    """Equidistant times [s], (n,), and place [m] and speed [m/s] of a front there; `cell` [m] is that of the grid."""

    time: np.ndarray
    front: np.ndarray
    speed: np.ndarray
    cell: float

    @property
    def peak(self):
        """Index of the largest speed, the first 80 ms left out."""
        first = round(EARLIEST / STEP)
        return first + int(np.argmax(self.speed[first:]))


class Phase(NamedTuple):
    """The longest slow phase: start, duration [s] and mean speed [m/s]; zeros where there is none."""

    start: float = 0.0
    duration: float = 0.0
    speed: float = 0.0


def motion(time, front, cell):
    """The `Motion` of the farthest place that a front has reached.

    The speed at a time is that between two places, a whole number of cells behind and ahead. The last cell of the way
    has none, zero.

    Parameters
    ----------
    time, front : (n,) arrays
        [s, m]
    cell : float
        Size of the cells along the bed [m].
    """
    reached = np.maximum.accumulate(np.asarray(front, float))
    first = np.concatenate([[True], np.diff(reached) > 0.0])  # when a place is reached
    low, high = math.ceil(reached[0] / cell), math.floor(reached[-1] / cell - 0.5)
    between = cell * (np.arange(low, high + 1) + 0.5)  # half-way between two nodes
    passed = np.interp(between, reached[first], time[first])
    at = STEP * np.arange(int(time[-1] / STEP + 1e-6) + 1)
    if len(between) < 3:
        return Motion(at, np.full_like(at, reached[0]), np.zeros_like(at), cell)
    place = np.interp(at, passed, between)
    speed, known = np.zeros(len(at)), np.zeros(len(at), bool)
    for cells in range(1, MOST_CELLS + 1):
        ahead = np.interp(place + cells * cell, between, passed, right=math.inf)
        behind = np.interp(place - cells * cell, between, passed, left=-math.inf)
        took = ahead - behind
        new = ~known & (took >= SMOOTHED)
        speed[new] = 2.0 * cells * cell / took[new]
        known |= new
    return Motion(at, place, speed, cell)


def slow_phase(of, band=BAND):
    """The longest `Phase` of a `Motion`; `band` is relative to its mean speed."""
    best = Phase()
    for start, duration, speed, steady, ratio in stretches(of, band):
        fits = np.flatnonzero(steady & (ratio <= STEADIER))
        if fits.size and duration[fits[-1]] > best.duration + 1e-9:
            longest = fits[-1]
            best = Phase(float(start), float(duration[longest]), float(speed[longest]))
    return best


def least_ratio(of):
    """The least relative deceleration over 0.15 s of slow motion, over the mean one from the peak to there.

    Over more than 0.15 s where six cells take longer. 1 of an exponential decay, more of a constant deceleration, at
    most a third in a slow phase. NaN where the front is never slow, or creeps, for that long.
    """
    least = math.nan
    for _, duration, _, slow, ratio in stretches(of, math.inf):
        fits = np.flatnonzero(slow & (duration >= LEAST_TIME - 0.5 * STEP))
        if fits.size:
            least = float(np.fmin(least, ratio[fits[0]]))
    return least


def stretches(of, band):
    """What there is between each time after the peak and all later ones.

    Yields
    ------
    start : float
        [s]
    duration, speed : (m,) arrays
        [s], mean [m/s]
    steady : (m,) bool array
        Within the band of the mean, slow, no creep, and far enough.
    ratio : (m,) array
        Relative deceleration by least squares over the mean one from the peak to the start.
    """
    peak = of.peak
    for first in range(peak + 1, len(of.time) - 2):
        stop = first + int(np.argmin(np.append(of.speed[first:], 0.0) > 0.0))
        if stop - first < 3 or of.speed[first] > SLOWED * of.speed[peak]:
            continue
        part = slice(first, stop)
        duration, fall = of.time[part] - of.time[first], np.log(of.speed[part])
        way = of.front[part] - of.front[first]
        speed = np.concatenate([[of.speed[first]], way[1:] / duration[1:]])
        low, high = np.minimum.accumulate(of.speed[part]), np.maximum.accumulate(of.speed[part])
        steady = (high - speed <= band * speed) & (speed - low <= band * speed)
        steady &= (speed <= SLOWED * of.speed[peak]) & (speed >= CREEPING * of.speed[peak])
        steady &= way >= LEAST_WAY * of.cell
        before = math.log(of.speed[peak] / of.speed[first]) / (of.time[first] - of.time[peak])
        ratio = np.abs(slopes(duration, fall)) / before if before > 0.0 else np.inf + duration
        yield of.time[first], duration, speed, steady, ratio


def slopes(x, y):
    """Slopes of the least-squares lines through the first 1, 2, …, n points; of one point infinite."""
    count = np.arange(1, len(x) + 1)
    sx, sy, sxx, sxy = (np.cumsum(of) for of in (x, y, x * x, x * y))
    spread = sxx - sx * sx / count
    spread[0] = math.inf
    found = (sxy - sx * sy / count) / spread
    found[0] = math.inf
    return found
