"""A collapse by formula, in the place of the solver, and a laboratory that films it.

The front advances as 1 - exp(-(t/T)^2); reach, duration and shape of the pile follow from the resolved case
with its effects, so that every effect has a signature of its own and calibrated parameters another.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import cos, inf, radians, sqrt, tan
from pathlib import Path

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.runner import RunRecord
from fvcollapse.measure.curves import curve_text
from fvcollapse.measure.observables import Observations
from fvcollapse.measure.quantities import CURVES

TIMES = np.linspace(0.0, 1.6, 81)
PLACES = np.linspace(0.0, 1.4, 141)
SIGMA = {"front": 0.004, "profiles": 0.0012, "volume": 0.003, "interface": 0.002}


def shape_of(case):
    """(start [s], duration [s], reach [m], exponent, share at rest) of a collapse."""
    case = case.resolved
    geometry, law, effects = case.geometry, case.rheology, case.effects
    fall = sqrt(geometry.height_0 / GRAVITY)
    friction = law.mu_1 + 0.15 * (law.mu_2 - law.mu_1) * (0.5 + 0.5 * sqrt(0.3 / law.I_0))
    cohesion = law.cohesion
    if effects.cohesion is not None:
        cohesion += 0.1 * effects.cohesion.adhesion
    friction += cohesion / (1550.0 * GRAVITY * geometry.height_0)
    wall = effects.lateral_friction
    if wall is not None and geometry.channel_width < inf:
        mu_wall = wall.mu_wall * wall.pressure_ratio
        friction += 0.5 * mu_wall * geometry.height_0 / geometry.channel_width
    drive = max(0.08, friction - 0.6 * tan(radians(geometry.slope_angle_deg)))
    reach = 0.75 * geometry.height_0 / drive * cos(radians(geometry.slope_angle_deg))
    exponent = 1.6
    if case.boundary.mu_bed < law.mu_1:
        slip = law.mu_1 - case.boundary.mu_bed
        reach, exponent = reach * (1.0 + 1.2 * slip), exponent + 3.0 * slip
    exponent -= 0.004 * cohesion
    duration = fall * (1.5 + 1.0 * law.mu_2) * (reach / geometry.height_0) ** 0.5
    gate = effects.gate
    start = 0.4 * geometry.height_0 / case.gate.speed if case.gate.speed else 0.0
    start += 0.7 * case.gate.time_constant
    if gate is not None:
        start += gate.delay + 0.05 * gate.mu_gate
    reach *= 1.0 + 0.08 * case.grid.cell_size / geometry.height_0
    if effects.transverse_profile is not None:
        excess = effects.transverse_profile.velocity_ratio - 1.0
        reach *= (
            1.0
            + {"average": 0.02, "wall": -0.3, "centre": 0.3}[effects.transverse_profile.view]
            * excess
        )
    rest = 0.6 + 0.2 * case.boundary.mu_back_wall
    if effects.erodible_bed is not None:
        rest -= 8.0 * effects.erodible_bed.thickness
        reach *= 1.0 + 3.0 * effects.erodible_bed.thickness
    return start, duration, reach, exponent, rest


def collapse(case, swelling=0.0):
    """The `Observations` of a case; `swelling`: a change of the volume that no effect knows."""
    start, duration, reach, exponent, rest = shape_of(case)
    geometry = case.geometry
    progress = 1.0 - np.exp(-((np.maximum(TIMES - start, 0.0) / duration) ** 2))
    front = geometry.length_0 + reach * progress
    swollen = 1.0 + swelling * progress
    mean = geometry.height_0 * geometry.length_0 * swollen / front
    share = np.clip(1.0 - PLACES / front[:, None], 0.0, 1.0)
    power = progress / exponent  # from a block to a wedge
    height = (1.0 + power)[:, None] * mean[:, None] * share ** power[:, None]
    height[front[:, None] < PLACES] = 0.0
    static = rest * progress[:, None] ** 2 * height
    rows = np.repeat(TIMES, len(PLACES)), np.tile(PLACES, len(TIMES))
    return Observations(
        np.column_stack([TIMES, front]),
        np.column_stack([*rows, height.ravel()]),
        np.column_stack([TIMES, swollen - 1.0]),
        np.column_stack([*rows, static.ravel()]),
        {
            "runout": float(front.max()),
            "final_height": float(height[-1].max()),
            "time_stop": start + 2.2 * duration,
            "peak_front_velocity": reach / duration,
        },
    )


class ToyRunner:
    """In the place of `runner.Runner`; counts what was asked for."""

    def __init__(self, *_, **__):
        self.asked, self.computed, self.failed, self.record = set(), set(), set(), {}

    def observations(self, wanted, phase=""):
        for experiment, case in wanted.values():
            self.asked.add(case.to_toml())
            self.record.setdefault(case.to_toml(), RunRecord(experiment.name, case, Path()))
        self.computed = set(self.asked)
        return {label: collapse(case) for label, (_, case) in wanted.items()}, {}


@dataclass(frozen=True)
class PlannedQuestion(Question):
    """A question whose cases are given, {name: Case}."""

    planned: dict = field(default_factory=dict)

    @cached_property
    def cases(self):
        return self.planned


def film(folder, slope=16.0, width=0.10, effects=None, seed=0, swelling=0.0, **changes):
    """An experiment folder of a collapse with effects, noise included.

    Parameters
    ----------
    folder : Path
    slope, width : float
        [deg], [m].
    effects : dict, optional
        {effect: {key: value}} that are hidden.
    seed : int
        Of the noise.
    swelling : float
        See `collapse`.
    **changes
        Keys of the true material that differ from what is stated: mu_1=0.47, ...
    """
    from fvcollapse.measure.experiment import load_experiment

    folder.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.toml").write_text(settings(slope, width), encoding="utf-8")
    (folder / "front.csv").write_text("t_s,x_front_m\n0.1,0.2\n", encoding="utf-8")
    case = load_experiment(folder).case()
    true = {f"rheology.{key}": value for key, value in changes.items()}
    true |= {f"effects.{name}": section for name, section in (effects or {}).items()}
    true["grid.cell_size"] = 0.004
    seen, rng = collapse(case.replace(**true), swelling), np.random.default_rng(seed)
    for name in CURVES:
        rows = getattr(seen, name).copy()
        rows = rows[(rows[:, 0] > 0.0) & (np.round(rows[:, 0] / 0.02) % 2 == 0)]
        if rows.shape[1] == 3:
            rows = rows[rows[:, 1] <= 1.15 * seen.front[-1, 1]]
        rows[:, -1] += SIGMA[name] * rng.standard_normal(len(rows))
        (folder / f"{name}.csv").write_text(curve_text(name, rows), encoding="utf-8")
    return folder


def three_films(folder, **hidden):
    """Experiment folders of two slopes and, on the steeper one, two widths."""
    set_ups = ((10.0, 0.1), (16.0, 0.1), (16.0, 0.2))
    return [
        film(folder / f"s{slope:g}_w{width:g}", slope, width, seed=number, **hidden)
        for number, (slope, width) in enumerate(set_ups)
    ]


def only_numbers(folder, *rows):
    """The experiment without its curves, and with these rows of `scalars.csv`."""
    for name in CURVES:
        (folder / f"{name}.csv").unlink()
    text = "\n".join(("name,value,sigma,kind", *rows, ""))
    (folder / "scalars.csv").write_text(text, encoding="utf-8")
    return folder


def settings(slope, width):
    """`experiment.toml` of a set-up."""
    return f"""title = "toy, {slope:g} deg"
source = "formulas of the tests"
[geometry]
slope_angle_deg = {slope}
height_0 = 0.14
length_0 = 0.2
channel_width = {width}
[gate]
speed = 2.3
[material]
mu_1 = 0.45
mu_2 = 0.7
I_0 = 0.3
mu_back_wall = 0.4
[uncertainty]
thickness = {SIGMA["profiles"]}
front = {SIGMA["front"]}
relative_volume = {SIGMA["volume"]}
interface = {SIGMA["interface"]}
time = 0.003
mu_1 = 0.012
mu_2 = 0.02
I_0 = 0.03
slope_angle_deg = 0.1
"""
