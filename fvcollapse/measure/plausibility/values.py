"""Plausibility of every measured value: heights, places, changes of volume, standard deviations.

What is impossible lies beyond what any column of the stated size can do, by more than `FAR` standard
deviations of the measurement.
"""

from collections.abc import Iterator
from math import sin
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import norm

from fvcollapse.case.case import GRAVITY
from fvcollapse.measure.plausibility.finding import (
    BACK_WALL,
    CLOCK,
    ERROR,
    WARNING,
    Finding,
    scales_of,
    unit_words,
)
from fvcollapse.measure.quantities import CURVES, PROFILES

if TYPE_CHECKING:
    from fvcollapse.measure.curves import Curve
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.plausibility.finding import Scales


FAR = 5.0  # standard deviations: once in 3 million measurements
# largest thickness in heights of the column: grains only fall; a gate drags some 12 % up, and a column that
# was not level is higher at one end
HIGHEST, HIGH = 2.0, 1.4
# part of the height: erodible beds of a collapse give way by some grain diameters, up to 2 cm
DEEPEST = 0.25
# chance that the lowest of all thin heights is called odd in a right measurement
FALSE_ALARM = 0.02
THIN = 3.0  # standard deviations of the height below which a place may be bare
BEHIND = 0.1  # of the length: grains so far behind the back wall are a slip of the origin
NO_GATE = 0.5  # of the length: a case may begin with another shape than a block, but not with half of its length
FARTHEST = (
    100.0  # columns (height + length): the shipped experiments reach 3.5 on a slope of 22 deg
)
# change of the volume: from densest to loosest packing 28 %, the worst area under h 17 %
CHANGE, ODD_CHANGE = 1.0, 0.35
AT_START = 0.5  # largest change of volume within the first fall time
# standard deviations in scales of the quantity: beyond the first pair no measurement, beyond the second odd
LEAST_SIGMA, LARGEST_SIGMA = 1.0e-9, 100.0
FINE_SIGMA, COARSE_SIGMA = 1.0e-5, 1.0
LONGEST = 1.0e4  # fall times: under a slow gate a column runs out for 60


def heights(experiment: "Experiment") -> Iterator[Finding]:
    """Thickness and interface lie between the bed and the top of the column."""
    height = scales_of(experiment).height
    for name in PROFILES:
        if name not in experiment.curves:
            continue
        curve = experiment.curves[name]
        highest = int(np.argmax(curve.value - FAR * curve.sigma))
        value, spread = curve.value[highest], curve.sigma[highest]
        if value > HIGH * height + FAR * spread:
            impossible = value > HIGHEST * height + FAR * spread
            severity, most = (ERROR, HIGHEST) if impossible else (WARNING, HIGH)
            found = at_point(curve, highest)
            allowed = f"<= {most * height:.3g} m, {most:g} times height_0"
            yield of_curve(name, severity, found, allowed, unit_words(value / height))
        yield from below_the_bed(name, curve, height)


def below_the_bed(name: str, curve: "Curve", height: float) -> Iterator[Finding]:
    """Heights below the bed by more than their errors."""
    thin = curve.value < THIN * curve.sigma
    if not thin.any():
        return
    scaled = curve.value / curve.sigma
    lowest = int(np.argmin(scaled))
    least = float(norm.isf(FALSE_ALARM / np.count_nonzero(thin)))
    if scaled[lowest] >= -least:
        return
    impossible = curve.value[lowest] < -DEEPEST * height - FAR * curve.sigma[lowest]
    found = at_point(curve, lowest)
    allowed = f">= 0, within {least:.2g} standard deviations of {curve.sigma[lowest]:.2g} m"
    likely = (
        "a wrong zero of the heights?"
        if impossible
        else "a wrong zero of the heights, or a bed that is eroded?"
    )
    yield of_curve(name, ERROR if impossible else WARNING, found, allowed, likely)


def places(experiment: "Experiment") -> Iterator[Finding]:
    """Profiles begin at the back wall and end within reach."""
    scales = scales_of(experiment)
    column = scales.height + scales.length
    for name, curve in experiment.curves.items():
        if curve.x is None:
            continue
        first, last = int(np.argmin(curve.x)), int(np.argmax(curve.x))
        key = CURVES[name].columns[1]
        if curve.x[first] < -BEHIND * scales.length:
            near = curve.x[first] > -2.0 * scales.length
            found = f"{curve.x[first]:g} m at t = {curve.time[first]:g} s"
            allowed = f">= 0, the back wall (length_0 = {scales.length:g} m)"
            likely = BACK_WALL if near else unit_words(-curve.x[first] / scales.length)
            yield Finding(ERROR, f"{name}.csv", key, found, allowed, likely)
        if curve.x[last] > FARTHEST * column:
            found = f"{curve.x[last]:g} m at t = {curve.time[last]:g} s"
            allowed = f"<= {FARTHEST * column:.3g} m, {FARTHEST:g} columns"
            yield Finding(ERROR, f"{name}.csv", key, found, allowed, "in mm or cm instead of m?")


def fronts(experiment: "Experiment") -> Iterator[Finding]:
    """The front is neither behind the gate nor ahead of an ideal fluid at any time."""
    if "front" not in experiment.curves:
        return
    curve, scales = experiment.curves["front"], scales_of(experiment)
    slack = BEHIND * scales.length + FAR * curve.sigma
    behind = NO_GATE * scales.length - FAR * curve.sigma - curve.value
    worst = int(np.argmax(behind))
    if behind[worst] > 0.0:
        found = f"{at_point(curve, worst)}, behind the gate"
        allowed = f">= length_0 = {scales.length:g} m at all times"
        from_gate = abs(curve.value[0]) <= FAR * curve.sigma[0]
        likely = BACK_WALL if from_gate else unit_words(curve.value[0] / scales.length)
        yield of_curve("front", ERROR, found, allowed, likely)
    late = FAR * (experiment.standard_deviation("time") + CLOCK)
    most = scales.length + advance(scales, curve.time + experiment.time_origin + late)
    ahead = curve.value - slack - most
    worst = int(np.argmax(ahead))
    if ahead[worst] > 0.0:
        found = f"{at_point(curve, worst)}, ahead of a fluid without friction"
        allowed = f"<= {most[worst] + slack[worst]:.3g} m then"
        likely = (
            unit_words(curve.value[0] / scales.length)
            or "lengths in mm or cm, times in minutes or on another clock?"
        )
        yield of_curve("front", ERROR, found, allowed, likely)


def advance(scales: "Scales", time: ArrayLike) -> np.ndarray:
    """Distance from the gate that a fluid without friction runs in a time, m (Ritter 1892, on a slope)."""
    time = np.maximum(time, 0.0)
    return 2.0 * scales.speed * time + 0.5 * GRAVITY * sin(scales.slope) * time**2


def volumes(experiment: "Experiment") -> Iterator[Finding]:
    """The relative change of volume begins at zero and stays small."""
    if "volume" not in experiment.curves:
        return
    curve, scales = experiment.curves["volume"], scales_of(experiment)
    early = curve.time + experiment.time_origin <= scales.time
    limit = np.where(early, AT_START, CHANGE) + FAR * curve.sigma
    beyond = np.abs(curve.value) - limit
    worst = int(np.argmax(beyond))
    odd = np.abs(curve.value) - ODD_CHANGE - FAR * curve.sigma
    if beyond[worst] > 0.0:
        severity, allowed = ERROR, f"within +-{limit[worst] - FAR * curve.sigma[worst]:g} then"
    elif odd.max() > 0.0:
        severity, worst = WARNING, int(np.argmax(odd))
        allowed = f"within +-{ODD_CHANGE:g}"
    else:
        return
    ratio = abs(curve.value[0] - 1.0) < AT_START
    likely = "V/V0 instead of V/V0 - 1?" if ratio else "in per cent?"
    yield of_curve("volume", severity, at_point(curve, worst), allowed, likely)


def deviations(experiment: "Experiment") -> Iterator[Finding]:
    """Standard deviations are neither round-off nor larger than what is measured."""
    scales = scales_of(experiment)
    column = scales.height + scales.length
    for name, curve in experiment.curves.items():
        scale = 1.0 if CURVES[name].unit == "1" else column
        for sigma in (curve.sigma.min(), curve.sigma.max()):
            yield from deviation(f"{name}.csv", CURVES[name].sigma_column, float(sigma), scale)
    sizes = {"time_stop": 10.0 * scales.time, "peak_front_velocity": scales.speed}
    for scalar in experiment.scalars:
        key = f"sigma of {scalar.name}"
        yield from deviation("scalars.csv", key, scalar.sigma, sizes.get(scalar.name, column))


def deviation(file: str, key: str, sigma: float, scale: float) -> Iterator[Finding]:
    """One standard deviation beside the scale of its quantity."""
    if not LEAST_SIGMA * scale <= sigma <= LARGEST_SIGMA * scale:
        allowed = f"{LEAST_SIGMA * scale:.2g} to {LARGEST_SIGMA * scale:.3g}"
        yield Finding(ERROR, file, key, f"{sigma:g}", allowed)
    elif not FINE_SIGMA * scale <= sigma <= COARSE_SIGMA * scale:
        allowed = f"{FINE_SIGMA * scale:.2g} to {COARSE_SIGMA * scale:.2g}"
        likely = "in mm, cm or per cent?" if sigma > scale else ""
        yield Finding(WARNING, file, key, f"{sigma:g}", allowed, likely)


def times(experiment: "Experiment") -> Iterator[Finding]:
    """All times lie within what a collapse can take."""
    limit = LONGEST * scales_of(experiment).time
    for name, curve in experiment.curves.items():
        clock = curve.time + experiment.time_origin
        worst = int(np.argmax(np.abs(clock)))
        if abs(clock[worst]) > limit:
            allowed = f"within {limit:.3g} s, {LONGEST:g} times sqrt(height_0/g)"
            likely = "in ms, or frame numbers?"
            yield Finding(ERROR, f"{name}.csv", "t_s", f"{curve.time[worst]:g} s", allowed, likely)


def of_curve(name: str, severity: str, found: str, allowed: str, likely: str = "") -> Finding:
    """The `Finding` about the measured value of a curve."""
    return Finding(severity, f"{name}.csv", CURVES[name].columns[-1], found, allowed, likely)


def at_point(curve: "Curve", row: int) -> str:
    """A value with its time and place, in words."""
    place = "" if curve.x is None else f", x = {curve.x[row]:g} m"
    return f"{curve.value[row]:g} at t = {curve.time[row]:g} s{place}"


CHECKS = (times, deviations, fronts, places, heights, volumes)
