"""Measures of the tables that several statements use; `t` are the `Tables` of the study."""

import numpy as np

from fvcollapse.studies.convergence import profile_distance

SALTATION = 0.02  # m; the paper's uncertainty of a measured front
LENGTH_0 = 0.20  # m
SAME = 5.0  # %; curves and profiles that differ by less are "nearly the same"
STATIONS = (0.15, 0.25, 0.35)  # m


def muI(slope, width):
    """Name of a mu(I) case."""
    return f"muI_a{slope}_{width}"


def shortening(t, slope, width):
    """Runout without lateral friction less that with it [m]."""
    return t.difference(muI(slope, "winf"), muI(slope, width), t.runout)


def front_gap(t, case, other, refinement):
    """Largest difference of two fronts over the second one's way from the gate, %."""
    ours, theirs = (t.line(name, t.front, refinement=refinement) for name in (case, other))
    time = max((ours.at, theirs.at), key=len)
    a, b = (np.interp(time, line.at, line.values) for line in (ours, theirs))
    return 100.0 * float(np.abs(a - b).max() / (b[-1] - LENGTH_0))


def profile_gap(t, case, other, quantity, time, refinement):
    """L1 distance of two profiles over the area of the second, %."""
    ours, theirs = (t.line(name, quantity, time, refinement=refinement) for name in (case, other))
    return 100.0 * profile_distance(*ours, *theirs)


def peak_gap(t, case, other, refinement):
    """Difference of two peaks of the front velocity over the second, %."""
    ours, theirs = (t.row(name, refinement)["peak_velocity_m_s"] for name in (case, other))
    return 100.0 * abs(ours / theirs - 1.0)


def deposit_gap(t, case, other):
    """L1 distance of two profiles at 1.76 s, `Measured`, %."""
    return t.measure(lambda r: profile_gap(t, case, other, "thickness_mm", 1.76, r))


def velocity_shape(t, case, x, refinement):
    """U over its surface value at 20 relative heights of one column, 0.48 s."""
    line = t.line(case, "u_m_s", 0.48, x, refinement)
    return np.interp(np.linspace(0.05, 0.95, 19) * line.at[-1], *line) / line.values[-1]


def shape_gap(t, case, other, refinement):
    """Root mean square difference of the shapes of the velocity in three columns."""
    gaps = [
        velocity_shape(t, case, x, refinement) - velocity_shape(t, other, x, refinement)
        for x in STATIONS
    ]
    return float(np.sqrt(np.mean(np.square(gaps))))
