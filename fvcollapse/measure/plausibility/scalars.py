"""Plausibility of single numbers: run-out, final height, time of arrest, peak velocity, and their bounds."""

from collections.abc import Iterator
from math import hypot, radians, sin, tan
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.measure.plausibility.column import ODD
from fvcollapse.measure.plausibility.finding import (
    BACK_WALL,
    ERROR,
    WARNING,
    Finding,
    scales_of,
    unit_words,
)
from fvcollapse.measure.plausibility.values import FAR, FARTHEST, HIGH, HIGHEST, LONGEST

if TYPE_CHECKING:
    from fvcollapse.measure.curves import Scalar
    from fvcollapse.measure.experiment import Experiment


FILE = "scalars.csv"
LEAST_FRICTION = 0.3  # where none is stated; glass beads have 0.36 to 0.44
STEEP = 0.05  # least difference of friction and slope in the energy balance of the run-out
REACH = (
    3.0  # times the way height/(friction - slope) of a block that falls by the height of the column
)
SLOW_STOP, SHORT_STOP = 100.0, 0.5  # fall times of a collapse: up to 21 in films and tables
THINNEST = 0.01  # of the height: deposits of columns 20 times as high as long keep a tenth
FLOW_TIME = 30.0  # fall times over which a slope may drive the front


def runout(experiment: "Experiment") -> Iterator[Finding]:
    """The grains reach at least the gate, and no farther than a block would slide."""
    scales = scales_of(experiment)
    column = scales.height + scales.length
    for scalar in named(experiment, "runout"):
        spread = hypot(scalar.sigma, experiment.standard_deviation("length_0"))
        found = words(scalar, "m")
        if scalar.kind != "lower" and scalar.value < scales.length - ODD * spread:
            severity = ERROR if scalar.value < scales.length - FAR * spread else WARNING
            allowed = f">= length_0 = {scales.length:g} m, where the front starts"
            likely = BACK_WALL if scalar.value > 0.0 else ""
            yield about(scalar, severity, found, allowed, likely)
        if scalar.kind == "lower" and scalar.value < 0.0:
            yield about(scalar, ERROR, found, ">= 0")
        if scalar.value > FARTHEST * column:
            allowed = f"<= {FARTHEST * column:.3g} m, {FARTHEST:g} columns"
            yield about(scalar, ERROR, found, allowed, "in mm or cm instead of m?")
        elif scalar.kind != "upper":
            most = scales.length + REACH * block_way(experiment)
            if scalar.value > most + FAR * spread:
                allowed = f"<= {most:.3g} m with the friction stated"
                yield about(scalar, WARNING, found, allowed, "in cm or dm instead of m?")


def block_way(experiment: "Experiment") -> float:
    """Way of a block that falls by the height of the column and slides with the friction of the grains, m."""
    material, scales = experiment.settings.material, scales_of(experiment)
    friction = material.mu_1
    if friction is None and material.repose_angle_deg:
        friction = tan(radians(material.repose_angle_deg))
    friction = LEAST_FRICTION if friction is None else friction
    return scales.height / max(friction - tan(scales.slope), STEEP)


def final_height(experiment: "Experiment") -> Iterator[Finding]:
    """The deposit is no higher than the column."""
    height = scales_of(experiment).height
    for scalar in named(experiment, "final_height"):
        found, spread = words(scalar, "m"), FAR * scalar.sigma
        ratio = scalar.value / height
        if scalar.value < (-spread if scalar.kind == "value" else 0.0):
            yield about(scalar, ERROR, found, ">= 0")
        elif scalar.value > (FARTHEST if scalar.kind == "upper" else HIGHEST) * height + spread:
            allowed = f"<= height_0 = {height:g} m"
            yield about(scalar, ERROR, found, allowed, unit_words(ratio))
        elif scalar.kind != "upper" and scalar.value > HIGH * height + spread:
            yield about(scalar, WARNING, found, f"<= height_0 = {height:g} m")
        elif scalar.kind == "value" and scalar.value < THINNEST * height - spread:
            allowed = f">= {THINNEST * height:.2g} m, a hundredth of height_0"
            yield about(scalar, WARNING, found, allowed, unit_words(ratio))


def time_stop(experiment: "Experiment") -> Iterator[Finding]:
    """The grains stop after the start, and within the time of a collapse."""
    time = scales_of(experiment).time
    for scalar in named(experiment, "time_stop"):
        moment, found = scalar.value + experiment.time_origin, words(scalar, "s")
        slack = FAR * scalar.sigma if scalar.kind == "value" else 0.0
        if moment < -slack:
            yield about(scalar, ERROR, found, ">= 0, when the gate starts")
        elif moment > LONGEST * time:
            allowed = f"<= {LONGEST * time:.3g} s, {LONGEST:g} times sqrt(height_0/g)"
            yield about(scalar, ERROR, found, allowed, "in ms, or a frame number?")
        elif scalar.kind != "upper" and moment > SLOW_STOP * time + FAR * scalar.sigma:
            allowed = f"<= {SLOW_STOP * time:.3g} s, {SLOW_STOP:g} times sqrt(height_0/g)"
            yield about(scalar, WARNING, found, allowed, "in ms, or a frame number?")
        elif scalar.kind != "lower" and 0.0 < moment < SHORT_STOP * time - ODD * scalar.sigma:
            allowed = f"0, or >= {SHORT_STOP * time:.2g} s, in which grains fall"
            yield about(scalar, WARNING, found, allowed, "in minutes instead of s?")


def velocity(experiment: "Experiment") -> Iterator[Finding]:
    """The front is no faster than a fluid without friction."""
    scales = scales_of(experiment)
    most = scales.speed * (2.0 + FLOW_TIME * sin(scales.slope))
    for scalar in named(experiment, "peak_front_velocity"):
        found, spread = words(scalar, "m/s"), FAR * scalar.sigma
        if scalar.value < (-spread if scalar.kind == "value" else 0.0):
            yield about(scalar, ERROR, found, ">= 0")
        elif scalar.value > most + spread:
            impossible = scalar.value > FARTHEST * most or scalar.kind != "upper"
            allowed = f"<= {most:.3g} m/s, a fluid without friction"
            severity = ERROR if impossible else WARNING
            yield about(scalar, severity, found, allowed, "in mm/s or cm/s instead of m/s?")


def bounds(experiment: "Experiment") -> Iterator[Finding]:
    """A lower bound, the value and an upper bound follow one another."""
    for name in dict.fromkeys(scalar.name for scalar in experiment.scalars):
        kinds = {scalar.kind: scalar for scalar in named(experiment, name)}
        for low, high in (("lower", "upper"), ("lower", "value"), ("value", "upper")):
            if low not in kinds or high not in kinds:
                continue
            below, above = kinds[low], kinds[high]
            slack = 0.0 if "value" not in kinds else FAR * hypot(below.sigma, above.sigma)
            if below.value > above.value + (slack if "value" in (low, high) else 0.0):
                allowed = f">= the {low} {'bound' if low != 'value' else ''} {below.value:g}"
                found = f"{above.value:g} as the {high}{' bound' if high != 'value' else ''}"
                yield about(above, ERROR, found, " ".join(allowed.split()))


def runout_beside_front(experiment: "Experiment") -> Iterator[Finding]:
    """The run-out is the farthest place of the front."""
    curve = experiment.curves.get("front")
    if curve is None:
        return
    length, last = scales_of(experiment).length, int(np.argmax(curve.value))
    for scalar in named(experiment, "runout"):
        slack = FAR * hypot(scalar.sigma, curve.sigma[last])
        if scalar.kind != "lower" and scalar.value < curve.value[last] - slack:
            gate = abs(scalar.value + length - curve.value[last]) < slack
            allowed = f">= {curve.value[last]:g} m, the farthest front of front.csv"
            likely = BACK_WALL if gate else ""
            yield about(scalar, WARNING, words(scalar, "m"), allowed, likely)


def named(experiment: "Experiment", name: str) -> "list[Scalar]":
    """Scalars of a name."""
    return [scalar for scalar in experiment.scalars if scalar.name == name]


def words(scalar: "Scalar", unit: str) -> str:
    """A value and its kind in words."""
    kind = "" if scalar.kind == "value" else f" as {scalar.kind} bound"
    return f"{scalar.value:g} {unit}{kind}"


def about(scalar: "Scalar", severity: str, found: str, allowed: str, likely: str = "") -> Finding:
    """The `Finding` about a scalar."""
    return Finding(severity, FILE, scalar.name, found, allowed, likely)


CHECKS = (runout, final_height, time_stop, velocity, bounds, runout_beside_front)
