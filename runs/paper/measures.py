"""What is read off curves and profiles: plateau of the front velocity, roughness, interface, bands.

Pure functions of arrays, SI units, no files. Every threshold stands here by name; statements quote them.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks, savgol_filter

from runs import table
from runs.table import EARLIEST

STEP = 0.01  # s, spacing of the curves in the tables
DECELERATION_WINDOW = 15  # points: 140 ms
NEAR_PEAK = 0.95  # of the peak; the time of the peak is the middle of what is faster
PEAK_LEAST = 0.1  # of the peak; a plateau is at least that fast
PEAK_MOST = 0.7  # of the peak; a plateau comes after a fast deceleration to this
STEADY = 1.0 / 3.0  # of the mean deceleration; a plateau decelerates less
PLATEAU_LEAST = 0.15  # s; a shorter slow phase is none
ABOUT_PEAK = 0.9  # of the largest velocity; the part that gives the peak
BENDS_FROM, BENDS_TO = 0.9, 0.2  # of the peak; the part of a deceleration that bends or does not
STOPPED = 0.02  # m/s; a slower front has stopped
FLOW_LEAST = 1.0e-3  # m; a thinner flowing layer is none
ROUGH_LENGTH = 0.15  # m; undulations shorter than about this are roughness
BAND_PROMINENCE = 0.2  # of the largest shear rate of its column; lesser maxima are no bands


# -- the front -----------------------------------------------------------------------------------


def front_velocity(front, step=STEP):
    """Slope of a front curve by local parabolas over 80 ms, (n,), m/s; no less than zero."""
    return table.front_velocity(front, step)


def peak_index(velocity):
    """Index of the largest velocity, the first 80 ms left out."""
    return EARLIEST + int(np.argmax(velocity[EARLIEST:]))


def peak_time(velocity, step=STEP):
    """Time of the peak [s]: the middle of the stretch about it in which the velocity is above `NEAR_PEAK` of it.

    The largest value itself is no time: the peak is flat, and its top changes from grid to grid.

    Parameters
    ----------
    velocity : (n,) array
        Front velocity [m/s] at the spacing `step`.
    step : float
        [s]
    """
    peak = peak_index(velocity)
    level = NEAR_PEAK * velocity[peak]
    slow = np.flatnonzero(velocity < level)
    before, after = slow[slow < peak], slow[slow > peak]
    start = float(EARLIEST)
    if before.size and before[-1] >= EARLIEST:
        start = crossing(velocity, int(before[-1]), level)
    end = crossing(velocity, int(after[0]) - 1, level) if after.size else len(velocity) - 1.0
    return 0.5 * (start + end) * step


def peak_velocity(velocity, about=ABOUT_PEAK):
    """Largest front velocity [m/s]: that of the least-squares parabola through what is near the largest value.

    Parameters
    ----------
    velocity : (n,) array
        Front velocity [m/s] at equidistant times, with a ripple of the cells; what is before 80 ms does not count.
    about : float
        Share of the largest value above which a velocity is near it; 1 gives the largest value itself.
    """
    peak = peak_index(velocity)
    slow = np.flatnonzero(~(velocity > about * velocity[peak]))
    before, after = slow[slow < peak], slow[slow > peak]
    start = max(EARLIEST, int(before[-1]) + 1 if before.size else EARLIEST)
    part = velocity[start : int(after[0]) if after.size else len(velocity)]
    if part.size < 6:
        return float(velocity[peak])
    at = np.linspace(-1.0, 1.0, part.size)
    found = np.polynomial.Polynomial.fit(at, part, 2, domain=[-1.0, 1.0])
    places = np.append(found.deriv().roots().real, at[[0, -1]])
    return float(found(places[np.abs(places) <= 1.0]).max())


def crossing(values, index, level):
    """Where values cross a level between an index and the next, in indices."""
    return index + (level - values[index]) / (values[index + 1] - values[index])


class Plateau(NamedTuple):
    """A slow propagation phase: when, how long [s], how fast [m/s]; zeros where there is none."""

    start: float = 0.0
    duration: float = 0.0
    velocity: float = 0.0


def plateau(velocity, step=STEP):
    """The longest stretch after the peak in which the velocity is steady and slow.

    Steady: it decelerates by less than a third of the mean deceleration from peak to stop. Slow: it
    has fallen to 0.7 of the peak, and is still above 0.1 of it. A constant deceleration has none;
    nor has an exponential decay, which is steady only where it is slower than that.

    Parameters
    ----------
    velocity : (n,) array
        Front velocity [m/s] at the spacing `step`.
    step : float
        [s]

    Returns
    -------
    Plateau
    """
    peak = peak_index(velocity)
    moving = np.flatnonzero(velocity[peak:] > STOPPED)
    if moving.size < DECELERATION_WINDOW:
        return Plateau()
    stop = peak + int(moving[-1])
    mean = (velocity[peak] - velocity[stop]) / ((stop - peak) * step)
    slope = savgol_filter(velocity, DECELERATION_WINDOW, 2, deriv=1, delta=step)
    share = velocity / velocity[peak]
    steady = (np.abs(slope) < STEADY * mean) & (share > PEAK_LEAST) & (share < PEAK_MOST)
    steady[:peak] = False
    start, length = longest_run(steady)
    if length == 0:
        return Plateau()
    mean_velocity = float(velocity[start : start + length].mean())
    return Plateau(start * step, length * step, mean_velocity)


def longest_run(mask):
    """Start and length of the longest run of True; (0, 0) if there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    starts, ends = edges[::2], edges[1::2]
    if starts.size == 0:
        return 0, 0
    longest = int(np.argmax(ends - starts))
    return int(starts[longest]), int(ends[longest] - starts[longest])


def tail_ratio(velocity):
    """Time from half the peak to the stop over the time from the peak to its half.

    1 for a constant deceleration; more where a slow phase follows a fast deceleration. NaN for a
    front that is still moving at the end, or never reached half of its peak.
    """
    peak = peak_index(velocity)
    after = velocity[peak:]
    half = int(np.argmax(after < 0.5 * after[0]))
    stop = int(np.argmax(after < STOPPED))
    return (stop - half) / half if half > 0 and stop > 0 else float("nan")


def convexity(velocity, start=BENDS_FROM, stop=BENDS_TO, about=ABOUT_PEAK):
    """How a front bends while it slows down: change of the deceleration over its mean, from 0.9 to 0.2 of the peak.

    Of the least-squares parabola through that part: 0 of a constant deceleration, above 0 where it is fast first and
    slow then, below 0 where it is the other way round. A front slower than that passes fewer than three cells of 6 mm
    in the 80 ms over which its velocity is taken. NaN where fewer than six values are left.

    Parameters
    ----------
    velocity : (n,) array
        Front velocity [m/s] at equidistant times.
    start, stop, about : float
        The part that counts, in shares of the peak; and what gives the peak, see `peak_velocity`.
    """
    after = velocity[peak_index(velocity) :] / peak_velocity(velocity, about)
    first, last = (int(np.argmax(after < level)) for level in (start, stop))
    part = after[first:last]
    if part.size < 6:
        return float("nan")
    second, _, _ = np.polyfit(np.linspace(0.0, 1.0, part.size), part, 2)
    return float(2.0 * second / (part[0] - part[-1]))


def early_acceleration(time, velocity, low, high):
    """Least-squares slope of the first rise of v(t) from `low` to `high` [m/s], m/s2."""
    first = EARLIEST + int(np.argmax(velocity[EARLIEST:] >= high))
    below = np.flatnonzero(velocity[:first] < low)
    start = int(below[-1]) + 1 if below.size else 0
    if first - start < 2:
        return float("nan")
    return float(np.polyfit(time[start : first + 1], velocity[start : first + 1], 1)[0])


# -- profiles ------------------------------------------------------------------------------------


def roughness(x, h, low, high):
    """Root mean square of what a smooth curve over 15 cm leaves of a surface, m.

    Parameters
    ----------
    x, h : (n,) arrays
        Profile on equidistant abscissae [m].
    low, high : float
        The stretch that is measured [m]; the curve is fitted (local cubics) to all of it.
    """
    inside = (x >= low) & (x <= high)
    window = round(ROUGH_LENGTH / (x[1] - x[0])) // 2 * 2 + 1
    if inside.sum() <= window:
        return float("nan")
    rest = (h - savgol_filter(h, window, 3))[inside]
    return float(np.sqrt(np.mean(rest**2)))


class Interface(NamedTuple):
    """Angle to the bed [deg] and mean curvature [1/m] of the static–flowing interface."""

    angle: float = float("nan")
    curvature: float = float("nan")


def interface(x, static, h):
    """Parabola through the falling part of the interface, from 80 to 10 % of its largest height.

    Parameters
    ----------
    x, static, h : (n,) arrays
        Abscissae, height of the interface above the bed, and thickness [m]. Columns that are at
        rest up to 1 mm below the surface are left out.

    Returns
    -------
    Interface
        NaN where fewer than six points are left. The curvature is the modulus of the second
        derivative of the parabola.
    """
    top = int(np.argmax(static))
    falling = np.arange(len(x)) >= top
    low = np.flatnonzero(falling & (static < 0.1 * static[top]))
    if low.size:
        falling[low[0] :] = False
    part = falling & (static > 0.0) & (static <= 0.8 * static[top]) & (h - static > FLOW_LEAST)
    if part.sum() < 6:
        return Interface()
    second, _, _ = np.polyfit(x[part], static[part], 2)
    slope = np.polyfit(x[part], static[part], 1)[0]
    return Interface(float(np.degrees(np.arctan(-slope))), float(abs(2.0 * second)))


def surface_slope(x, h, threshold):
    """Mean angle of a deposit's surface to the bed, from its top to where it is thin, deg."""
    top = int(np.argmax(h))
    part = (np.arange(len(x)) >= top) & (h >= threshold)
    if part.sum() < 3:
        return float("nan")
    return float(np.degrees(np.arctan(-np.polyfit(x[part], h[part], 1)[0])))


# -- columns -------------------------------------------------------------------------------------


def bands(shear_rate, flowing):
    """Mean number of shear bands per flowing column: maxima of the shear rate along it.

    Parameters
    ----------
    shear_rate : (nx, nz) array
        [1/s]
    flowing : (nx, nz) bool array
        Cells that count; columns with fewer than six are passed over.
    """
    counts = []
    for column, mask in zip(shear_rate, flowing, strict=True):
        if mask.sum() >= 6:
            rates = np.concatenate([[0.0], column[mask], [0.0]])
            counts.append(len(find_peaks(rates, prominence=BAND_PROMINENCE * rates.max())[0]))
    return float(np.mean(counts)) if counts else float("nan")


def unevenness(shear_rate, flowing, dz, length):
    """Root mean square of the shear rate less its mean over `length` [m] along z, over its own.

    Small where the shear is smooth on that length; grows with bands thinner than it.
    """
    weight = flowing.astype(float)
    sigma = 0.5 * length / dz
    smooth = gaussian_filter1d(weight * shear_rate, sigma, axis=1, mode="constant")
    norm = gaussian_filter1d(weight, sigma, axis=1, mode="constant")
    rest = np.where(flowing, shear_rate - smooth / np.maximum(norm, 1e-9), 0.0)
    whole = (weight * shear_rate**2).sum()
    return float(np.sqrt((weight * rest**2).sum() / whole)) if whole > 0.0 else float("nan")


def weighted_quantiles(values, weights, shares):
    """Quantiles of values that carry weights (cell volumes), at the given shares."""
    order = np.argsort(values)
    cumulated = np.cumsum(weights[order])
    if cumulated.size == 0 or cumulated[-1] <= 0.0:
        return np.full(len(shares), np.nan)
    return np.interp(np.asarray(shares) * cumulated[-1], cumulated, values[order])
