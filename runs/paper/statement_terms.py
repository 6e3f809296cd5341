"""Measures of the tables that several statements use; `t` are the `Tables` of the study."""

import numpy as np

from fvcollapse.measure.pile import front_position
from fvcollapse.studies.convergence import profile_distance
from runs.paper import measures
from runs.table import VELOCITY

SALTATION = 0.02  # m; the paper's uncertainty of a measured front
LENGTH_0 = 0.20  # m
SAME = 5.0  # %; curves and profiles that differ by less are "nearly the same"
STATIONS = (0.15, 0.25, 0.35)  # m
FRONT_LEAST = 5.0  # mm; where a front is


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


def peak_at(t, case, refinement):
    """Peak of the front velocity (`measures.peak_velocity`) [m/s]."""
    return measures.peak_velocity(t.line(case, VELOCITY, refinement=refinement).values)


def peak(t, case):
    """Peak of the front velocity, `Measured`, m/s."""
    return t.measure(lambda r: peak_at(t, case, r))


def peak_less(t, case, other):
    """Peak of the front velocity of a case less that of another, `Measured`, m/s."""
    return t.measure(lambda r: peak_at(t, case, r) - peak_at(t, other, r))


def peak_gap(t, case, other, refinement):
    """Difference of two peaks of the front velocity over the second, %."""
    return 100.0 * abs(peak_at(t, case, refinement) / peak_at(t, other, refinement) - 1.0)


def deposit_gap(t, case, other):
    """L1 distance of two profiles at 1.76 s, `Measured`, %."""
    return t.measure(lambda r: profile_gap(t, case, other, "thickness_mm", 1.76, r))


def bend(t, case, refinement):
    """How the deceleration of a front bends (`measures.convexity`)."""
    return measures.convexity(t.line(case, VELOCITY, refinement=refinement).values)


def shape_distance(t, case, other, refinement):
    """L1 distance of two shapes at the time of the fastest front over their area, %.

    Each in units of its own length, up to where it is 5 mm thick, and of the height that keeps its area: the velocity
    is so flat about its peak that these times differ by up to 26 ms, in which a front goes 3 cm.
    """
    name = "peak_thickness_mm"
    ours, theirs = (t.line(of, name, refinement=refinement) for of in (case, other))
    stretch = length(theirs) / length(ours)
    return 100.0 * profile_distance(ours.at * stretch, ours.values / stretch, *theirs)


def length(profile):
    """Where a profile [mm] is last as thick as 5 mm, m."""
    return front_position(*profile, FRONT_LEAST)


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
