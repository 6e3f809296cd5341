"""Plausibility of the first measurements against the stated column, and of the pace of the collapse.

At the start nothing has moved: the front stands at the gate, the profile is the column. What differs there is
no physics of grains but a unit, an origin, or another direction in which lengths were read.
"""

from collections.abc import Iterator
from itertools import pairwise
from math import cos, hypot, isfinite, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import trapezoid

from fvcollapse.measure.plausibility.finding import (
    BACK_WALL,
    CLOCK,
    ERROR,
    WARNING,
    Finding,
    scales_of,
    unit_words,
)
from fvcollapse.measure.plausibility.values import FAR, advance, at_point, of_curve

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.plausibility.finding import Scales


EARLY = 0.5  # fall times, in which the top at the gate comes down by an eighth of the height
AT_ONCE = 0.1  # fall times, in which nothing moves by more than half a percent
ODD = 3.0  # standard deviations
NEAR = 2.0  # standard deviations within which a convention explains a ratio
SCALE = 0.005  # least relative standard deviation of all lengths of a picture
LOWEST = 0.3  # of the height: the corner of a badly filled column has slumped by 60 %
EDGE = (
    0.95  # of the length: up to there the mean of a surface that was not level is nearly height_0
)
FACE = 0.2  # of the height: the face of a column is where it is thicker
# part of the length: a horizontal X is 13 % shorter on the steepest slope, a wedge seems 20 % shorter
WRONG_FACE = 0.5
# parts of the length: where complete profiles begin, and their largest step
NEAR_WALL, SPACING = 0.1, 0.25
# a place without grains: part of the height, standard deviations
BARE_SHARE, BARE = 0.03, 3.0
# factors of the area: 15 % of the grains may be lost, 17 % of the volume be gained
AREA, ODD_AREA = 5.0, 1.25
# fall times to half of the run-out: 1.8 to 5 in 35 films from a level bed to 22 deg
SLOW, TOO_SLOW = 12.0, 200.0
SLOW_GATE = 3.0  # times of opening of a gate, which then sets the pace
LEAST_TRAVEL = 0.25  # of the length: a front that hardly moves has no pace


def first_front(experiment: "Experiment") -> Iterator[Finding]:
    """The front starts at the gate."""
    if "front" not in experiment.curves:
        return
    curve, scales = experiment.curves["front"], scales_of(experiment)
    spread = hypot(curve.sigma[0], experiment.standard_deviation("length_0"), SCALE * scales.length)
    moment = curve.time[0] + experiment.time_origin
    late = NEAR * (experiment.standard_deviation("time") + CLOCK)
    low = scales.length - ODD * spread
    high = scales.length + ODD * spread + float(advance(scales, moment + late))
    if low <= curve.value[0] <= high:
        return
    allowed = f"length_0 = {scales.length:g} m, where the front starts"
    likely = other_direction(scales, curve.value[0], curve.value[0], spread)
    yield of_curve("front", WARNING, at_point(curve, 0), allowed, likely)


def first_profile(experiment: "Experiment") -> Iterator[Finding]:
    """The first profile is the column: its height, and the place of its face."""
    curve, scales = experiment.curves.get("profiles"), scales_of(experiment)
    if curve is None or curve.time[0] + experiment.time_origin > EARLY * scales.time:
        return
    first = curve.time == curve.time[0]
    x, h, sigma = curve.x[first], curve.value[first], float(np.median(curve.sigma[first]))
    inside = x < EDGE * scales.length
    if inside.any() and h.max() < LOWEST * scales.height:
        found = f"at most {h.max():.3g} m at t = {curve.time[0]:g} s"
        allowed = f"about height_0 = {scales.height:g} m in the first profile"
        likely = unit_words(h.max() / scales.height)
        yield of_curve("profiles", ERROR, found, allowed, likely)
        return
    yield from face(experiment, x, h, curve.time[0])
    if curve.time[0] + experiment.time_origin <= AT_ONCE * scales.time:
        yield from mean_height(experiment, x, h, sigma)


def mean_height(
    experiment: "Experiment", x: np.ndarray, h: np.ndarray, sigma: float
) -> Iterator[Finding]:
    """Mean thickness of a column at rest, read normal to the bed."""
    scales = scales_of(experiment)
    inside = (x >= 0.0) & (x < EDGE * scales.length)
    if not inside.any() or x[inside][0] > NEAR_WALL * scales.length:
        return
    if np.diff(x[inside], append=EDGE * scales.length).max() > SPACING * scales.length:
        return
    count = np.count_nonzero(inside)
    ratio = float(h[inside].mean()) / scales.height
    error = experiment.standard_deviation("height_0") / scales.height
    error = hypot(error, SCALE, sigma / sqrt(count) / scales.height)
    if abs(ratio - 1.0) <= ODD * error:
        return
    likely = ""
    if abs(ratio * cos(scales.slope) - 1.0) < NEAR * error:
        likely = "heights read vertically instead of normal to the bed (1/cos of the slope)?"
    elif abs(ratio / cos(scales.slope) - 1.0) < NEAR * error:
        likely = "height_0 read vertically instead of normal to the bed (1/cos of the slope)?"
    found = f"a mean of {ratio * scales.height:.4g} m in the first profile"
    allowed = f"height_0 = {scales.height:g} m within {ODD * error * scales.height:.2g} m"
    yield of_curve("profiles", WARNING, found, allowed, likely)


def face(
    experiment: "Experiment", x: np.ndarray, h: np.ndarray, moment: float
) -> Iterator[Finding]:
    """The face of the column in the first profile, between two places, stands at the gate."""
    scales = scales_of(experiment)
    thick = np.flatnonzero(h > FACE * scales.height)
    if not len(thick) or thick[-1] + 1 == len(x):  # no place beyond the face
        return
    low, high = x[thick[-1]], x[thick[-1] + 1]
    late = NEAR * (experiment.standard_deviation("time") + CLOCK)
    moved = float(advance(scales, moment + experiment.time_origin + late))
    spread = hypot(experiment.standard_deviation("length_0"), SCALE * scales.length)
    if low - moved - ODD * spread <= scales.length <= high + ODD * spread:
        return
    nearest = high if high < scales.length else low
    wrong = (
        not scales.length * (1 - WRONG_FACE) <= nearest <= scales.length * (1 + WRONG_FACE) + moved
    )
    found = f"the face of the column between {low:g} and {high:g} m at t = {moment:g} s"
    allowed = f"length_0 = {scales.length:g} m"
    likely = unit_words(nearest / scales.length) or other_direction(scales, low, high, spread)
    severity = ERROR if wrong else WARNING
    yield Finding(severity, "profiles.csv", "x_m", found, allowed, likely)


def other_direction(scales: "Scales", low: float, high: float, spread: float) -> str:
    """The origin or direction of X that a face of the column between two places fits to, as a question."""
    if low - ODD * spread < 0.0 < high + ODD * spread:
        return BACK_WALL
    level = scales.length * cos(scales.slope)
    near = low - NEAR * spread < level < high + NEAR * spread
    return "X read horizontally instead of along the bed (cos of the slope)?" if near else ""


def area(experiment: "Experiment") -> Iterator[Finding]:
    """Complete profiles hold the grains of the column."""
    curve, scales = experiment.curves.get("profiles"), scales_of(experiment)
    if curve is None:
        return
    areas = []
    for now in pictures(curve.time):
        x, h = curve.x[now], curve.value[now]
        bare = max(BARE * curve.sigma[now][-1], BARE_SHARE * scales.height)
        steps = np.diff(x, prepend=0.0)
        if (
            x[0] <= NEAR_WALL * scales.length
            and steps.max() <= SPACING * max(scales.length, x[-1] / 10.0)
            and abs(h[-1]) <= bare
        ):
            areas.append(h[0] * x[0] + trapezoid(h, x))
    if not areas:
        return
    ratio = float(np.median(areas)) / (scales.height * scales.length)
    if 1.0 / ODD_AREA <= ratio <= ODD_AREA:
        return
    severity = WARNING if 1.0 / AREA <= ratio <= AREA else ERROR
    found = f"an area of {ratio:.3g} times that of the column, median of {len(areas)} profiles"
    allowed = f"{1 / ODD_AREA:.2g} to {ODD_AREA:.3g}"
    likely = unit_words(ratio) or (unit_words(sqrt(ratio)) if ratio > 0.0 else "")
    yield of_curve("profiles", severity, found, allowed, likely)


def pace(experiment: "Experiment") -> Iterator[Finding]:
    """Grains fall: the front covers half of its way within a few fall times."""
    scales, gate = scales_of(experiment), experiment.settings.gate
    file, time, place = travel(experiment, scales)
    if time is None or gate.speed == 0.0:
        return
    way = place.max() - place[0]
    behind = np.flatnonzero(place < place[0] + 0.5 * way)
    if way < LEAST_TRAVEL * scales.length or not len(behind):
        return
    half = float(time[int(np.argmax(place >= place[0] + 0.5 * way)) - 1]) + experiment.time_origin
    opening = 0.0
    if gate.speed is not None and isfinite(gate.speed):
        opening = SLOW_GATE * (scales.height / gate.speed + (gate.time_constant or 0.0))
    if half <= SLOW * scales.time + opening:
        return
    severity = ERROR if half > TOO_SLOW * scales.time + FAR * opening else WARNING
    found = f"half of the way of the front after {half:.3g} s"
    allowed = f"<= {SLOW * scales.time + opening:.2g} s for a column of {scales.height:g} m"
    yield Finding(severity, file, "t_s", found, allowed, other_clock(time, half, scales))


def travel(experiment: "Experiment", scales: "Scales") -> tuple[str, Any, Any]:
    """(file, times, places) of the front as measured, or as the profiles show it; None without either."""
    curves = experiment.curves
    if "front" in curves:
        return "front.csv", curves["front"].time, curves["front"].value
    if "profiles" not in curves:
        return "", None, None
    profiles = curves["profiles"]
    thick = np.maximum(FACE * scales.height / 2.0, BARE * profiles.sigma)
    shown = profiles.value > thick
    if not shown.any():
        return "", None, None
    time, x = profiles.time[shown], profiles.x[shown]
    last = np.array([now.stop - 1 for now in pictures(time)])
    return "profiles.csv", time[last], x[last]


def pictures(time: np.ndarray) -> list[slice]:
    """A slice of each run of equal times, in their order."""
    starts = np.flatnonzero(np.diff(time, prepend=-np.inf))
    return [slice(start, stop) for start, stop in pairwise((*starts.tolist(), len(time)))]


def other_clock(time: np.ndarray, half: float, scales: "Scales") -> str:
    """What a time that is too long may be, as a question."""
    whole = len(time) > 2 and (time == np.round(time)).all()
    if 0.5 <= half / scales.time / 1000.0 <= SLOW:
        return "in ms, or frame numbers, instead of s?" if whole else "in ms instead of s?"
    if whole:
        return "frame numbers instead of s?"
    if 0.5 <= half <= SLOW:
        return "times divided by sqrt(height_0/g)?"
    return ""


CHECKS = (pace, first_front, first_profile, area)
