"""Measures of the tables that several statements use; `t` are the `Tables` of the study."""

import numpy as np

from fvcollapse.measure.pile import front_position
from fvcollapse.studies.convergence import profile_distance
from runs.paper import measures
from runs.paper.verdicts import Clause
from runs.table import VELOCITY

SALTATION = 0.02  # m; the paper's uncertainty of a measured front
LENGTH_0 = 0.20  # m
SAME = 5.0  # %; curves and profiles that differ by less are "nearly the same"
STATIONS = (0.15, 0.25, 0.35)  # m
PEAKS = {  # windows of a peak: what its parabola goes through, in shares of the largest value
    "parabola above 0.9": measures.ABOUT_PEAK,
    "parabola above 0.85": 0.85,
    "parabola above 0.95": 0.95,
    "largest value": 1.0,
}
BENDS = {  # windows of a deceleration: from, to, in shares of the peak, and what gives the peak
    "0.9 to 0.2": (measures.BENDS_FROM, measures.BENDS_TO, measures.ABOUT_PEAK),
    "0.9 to 0.15": (0.9, 0.15, measures.ABOUT_PEAK),
    "0.9 to 0.25": (0.9, 0.25, measures.ABOUT_PEAK),
    "0.95 to 0.2": (0.95, 0.2, measures.ABOUT_PEAK),
    "0.85 to 0.2": (0.85, 0.2, measures.ABOUT_PEAK),
    "0.9 to 0.2 of the largest value": (0.9, 0.2, 1.0),
}
LENGTHS = {"as they are": None} | {f"by the length at {mm} mm": float(mm) for mm in (5, 1, 10)}


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


def clause_in(t, windows, number, label, sense, limit, unit="", of_paper=False):
    """The `Clause` of `number(refinement, window)` in the first of some windows, {name: window}; the others beside."""
    found = [
        (name, t.measure(lambda r, window=window: number(r, window)))
        for name, window in windows.items()
    ]
    return Clause(label, found[0][1], sense, limit, unit, of_paper, tuple(found[1:]))


def peak_at(t, case, refinement, about=measures.ABOUT_PEAK):
    """Peak of the front velocity (`measures.peak_velocity`) [m/s]."""
    return measures.peak_velocity(t.line(case, VELOCITY, refinement=refinement).values, about)


def peak_less(t, case, other, label, sense):
    """The `Clause` on the sign of the peak of a front velocity less that of another, m/s, read in `PEAKS`."""
    return clause_in(
        t,
        PEAKS,
        lambda r, about: peak_at(t, case, r, about) - peak_at(t, other, r, about),
        label,
        sense,
        0.0,
        "m/s",
    )


def peak_below(t, case, label, limit):
    """The `Clause` on a peak of the front velocity below a limit of the paper, m/s, read in `PEAKS`."""

    def number(r, about):
        return peak_at(t, case, r, about)

    return clause_in(t, PEAKS, number, label, "below", limit, "m/s", of_paper=True)


def peak_gap(t, case, other, refinement):
    """Difference of two peaks of the front velocity over the second, %."""
    return 100.0 * abs(peak_at(t, case, refinement) / peak_at(t, other, refinement) - 1.0)


def deposit_gap(t, case, other):
    """L1 distance of two profiles at 1.76 s, `Measured`, %."""
    return t.measure(lambda r: profile_gap(t, case, other, "thickness_mm", 1.76, r))


def bend(t, case, refinement, window=BENDS["0.9 to 0.2"]):
    """How the deceleration of a front bends (`measures.convexity`)."""
    return measures.convexity(t.line(case, VELOCITY, refinement=refinement).values, *window)


def shape_distance(t, case, other, refinement, least=None):
    """L1 distance of two shapes at the time of the fastest front over their area, %.

    As they are, or each in units of its own length, up to where it is `least` [mm] thick, and of the height that keeps
    its area: the velocity is so flat about its peak that these times differ by up to 26 ms, in which a front goes 3 cm.
    """
    name = "peak_thickness_mm"
    ours, theirs = (t.line(of, name, refinement=refinement) for of in (case, other))
    stretch = front_position(*theirs, least) / front_position(*ours, least) if least else 1.0
    return 100.0 * profile_distance(ours.at * stretch, ours.values / stretch, *theirs)


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
