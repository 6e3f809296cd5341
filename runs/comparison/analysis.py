"""Reductions of other people's profiles: symmetric halves, interfaces, L1 differences, power laws."""

import numpy as np


def mean_half(x, h, at):
    """Mean of both sides of a two-sided pile at the distances `at` from its symmetry plane.

    Parameters
    ----------
    x, h : arrays
        Outline of the whole pile, x ascending, both in column heights; nothing outside.
    at : array
        Distances, not negative.
    """
    return 0.5 * (np.interp(at, x, h, 0.0, 0.0) + np.interp(-at, x, h, 0.0, 0.0))


def asymmetry(x, h, at):
    """L1 distance of one side of a two-sided pile from the mean of both, relative to its area."""
    mean = mean_half(x, h, at)
    return l1_difference(at, np.interp(at, x, h, 0.0, 0.0), mean)


def top_of_segments(x, y, at):
    """Highest crossing of the verticals `at` with an interface given as segments, 0 beyond its ends.

    Between two segments whose ends were rounded apart, the top is linear.

    Parameters
    ----------
    x, y : (2 n,) arrays
        End points of n segments, in pairs.
    at : array
        Abscissae, ascending.
    """
    top = np.full(len(at), np.nan)
    for (x_a, x_b), (y_a, y_b) in zip(np.reshape(x, (-1, 2)), np.reshape(y, (-1, 2)), strict=True):
        crossed = (at >= min(x_a, x_b)) & (at <= max(x_a, x_b))
        share = (at[crossed] - x_a) / (x_b - x_a) if x_a != x_b else 0.0
        top[crossed] = np.fmax(top[crossed], y_a + share * (y_b - y_a))
    met = np.isfinite(top)
    return np.interp(at, at[met], top[met], 0.0, 0.0)


def l1_difference(x, h, reference):
    """Area between two profiles over the area below the reference (trapezoidal rule)."""
    return float(np.trapezoid(np.abs(h - reference), x) / np.trapezoid(reference, x))


def power_coefficient(aspect, value, exponent):
    """Mean of value / aspect^exponent, and its relative standard deviation over the points."""
    ratio = np.asarray(value) / np.asarray(aspect) ** exponent
    spread = ratio.std(ddof=1) / ratio.mean() if ratio.size > 1 else 0.0
    return float(ratio.mean()), float(spread)


def on_curve(aspect, value, at):
    """A computed curve at other aspect ratios, linear in the logarithms; NaN outside its range."""
    logs = np.interp(np.log(at), np.log(aspect), np.log(value), np.nan, np.nan)
    return np.exp(logs)


def scaled_to_area(x, h, reference):
    """A profile scaled to the area of another (grain area against bulk volume)."""
    return h * np.trapezoid(reference, x) / np.trapezoid(h, x)
