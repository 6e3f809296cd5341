"""Uniform flows in time: starting, sliding on the bed and between walls, stopping, creeping."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import layer, layer_case, run_until
from fvcollapse.verification.problem import Problem
from fvcollapse.verification.problems.steady import DEPTH, SLOPE

REGULARISATION = "regularisation: shear_rate_min and the slip speed of the walls"
WALLS = {"geometry__channel_width": 0.10, "effects__lateral_friction": {}}


def imposed_bed_stress_errors(cells: int) -> np.ndarray:
    """Newtonian film that slides steadily on a Coulomb bed with mu_b = tan(slope)."""
    slope = 20.0
    case = layer_case(
        DEPTH / cells,
        DEPTH,
        geometry__slope_angle_deg=slope,
        boundary__mu_bed=math.tan(math.radians(slope)),
        rheology__law="newtonian",
        rheology__viscosity=1.0,
    )
    z, _ = layer(case, np.zeros_like, dt=1.0).profile()
    mean = exact.film_imposed_bed_stress(case, z).mean()
    start = layer(case, lambda z: 2.0 + exact.film_imposed_bed_stress(case, z), dt=1.0, slip=2.0)
    z, u = run_until(start, 10.0).profile()
    profile = exact.film_imposed_bed_stress(case, z)
    return (u - profile - 2.0) / (2.0 + mean)


def slip_errors(**law: Any) -> Callable:
    """Gain of mean velocity of a sheared layer that slides, mu_b = mu_1 < tan(slope)."""

    def errors(cells):
        case = layer_case(
            DEPTH / cells,
            DEPTH,
            geometry__slope_angle_deg=22.0,
            rheology__mu_1=0.30,
            boundary__mu_bed=0.30,
            **law,
        )
        flow = layer(case, lambda z: 1.0 + 20.0 * z, dt=1e-3, slip=1.0)
        before = flow.mean_velocity()
        gained = run_until(flow, 0.05).mean_velocity() - before
        return gained / (0.05 * exact.block_acceleration(case)) - 1.0

    return errors


def block_errors(walls: bool) -> Callable:
    """A rigid block, braked: speed before, at and after the stop, relative to the start."""

    def errors(cells):
        case = layer_case(
            DEPTH / cells,
            DEPTH,
            geometry__slope_angle_deg=22.0,
            rheology__mu_1=0.9,
            rheology__mu_2=0.9,
            **(WALLS if walls else {}),
        )
        stop = -0.2 / exact.block_acceleration(case)
        flow = layer(case, lambda z: 0.2 + 0.0 * z, dt=stop / 100, slip=0.2)
        found = []
        for part in (0.5, 0.9, 1.0, 1.1, 1.5):
            run_until(flow, part * stop)
            found.append(flow.mean_velocity() - exact.block_speed(case, 0.2, part * stop))
        return np.array(found) / 0.2

    return errors


def split_errors(cells: int) -> np.ndarray:
    """A rigid layer braked by the walls alone: implicit friction less the exact split form, to beyond the stop."""
    speeds = []
    for scheme in ("implicit", "split"):
        case = layer_case(
            DEPTH / cells,
            DEPTH,
            geometry__slope_angle_deg=0.0,
            geometry__channel_width=0.05,
            boundary__mu_bed=0.0,
            rheology__law="bingham",
            rheology__cohesion=1e5,
            rheology__viscosity=1e4,
            effects__lateral_friction={"scheme": scheme},
        )
        stop = 0.2 / (exact.wall_ratio(case) * DEPTH * exact.gravity_normal(case))
        flow = layer(case, lambda z: 0.2 + 0.0 * z, dt=stop / 50, slip=0.2)
        speeds.append(
            [run_until(flow, part * stop).mean_velocity() for part in (0.3, 0.6, 0.9, 1.2)]
        )
    return np.subtract(speeds[0], speeds[1]) / 0.2


def start_up_errors(cells: int) -> np.ndarray:
    """Drucker-Prager layer from rest at t = 0.1 s; dt proportional to the cell size squared."""
    case = layer_case(
        DEPTH / cells,
        DEPTH,
        rheology__law="drucker_prager",
        rheology__viscosity=1.0,
        **SLOPE,
        rheology__mu_1=0.38,
    )
    flow = layer(case, np.zeros_like, dt=0.02 * (8 / cells) ** 2)
    z, u = run_until(flow, 0.1).profile()
    return (u - exact.incline_start_up(case, z, 0.1)) / exact.incline_drucker_prager(case, DEPTH)


# -- stopping from the bed upwards -------------------------------------------------------------

START = 0.2  # m/s, velocity of the surface
HALFWAY, INTERFACE_AT = 0.5, (0.2, 0.4, 0.6)  # parts of the time to the stop
INTERFACE = 0.02  # velocity at which the static-flowing interface is compared, in units of START


class Stopping:
    """A Drucker-Prager layer below yield that stops from the bed upwards.

    Parameters
    ----------
    cells : int
        Per depth.
    viscosity : float
        Pa s; without it the velocity is linear at the start, else flat at the surface.
    walls : bool
        With lateral walls.
    """

    def __init__(self, cells, viscosity, walls):
        self.case = layer_case(
            DEPTH / cells,
            DEPTH,
            rheology__law="drucker_prager",
            rheology__viscosity=viscosity,
            boundary__mu_bed=math.inf,
            numerics__max_sweeps=100,
            numerics__tolerance=1e-6,
            **(WALLS if walls else {}),
        )
        loss = exact.gravity_normal(self.case) * (0.48 - exact.slope_ratio(self.case))
        self.stop = START / loss  # of the surface, without walls and viscosity
        self.viscous = viscosity > 0.0

    def start(self, z: Any) -> Any:
        """Velocity at the start, m/s."""
        part = z / DEPTH
        return START * ((2.0 - part) * part if self.viscous else part)

    def computed(self, parts: Any) -> Any:
        """{part: (z, u)} of the solver at increasing parts of the time to the stop, m and m/s."""
        steps = 400 if self.viscous else 100  # of first order, but exact without viscosity
        flow = layer(self.case, self.start, dt=self.stop / steps)
        return {part: run_until(flow, part * self.stop).profile() for part in parts}

    def exact(self, z: Any, part: float) -> Any:
        """Exact velocity at one of them, m/s."""
        time = part * self.stop
        if self.viscous:
            return exact.stopping_viscous(self.case, self.start, z, time)
        return exact.stopping_inviscid(self.case, self.start(z), z, time)


@cache
def stopping_computed(cells: int, viscosity: float, walls: bool) -> Any:
    """{part: (z, u)} of the solver at all parts of the time to the stop that are compared."""
    return Stopping(cells, viscosity, walls).computed(sorted((HALFWAY, *INTERFACE_AT)))


@cache
def stopping_exactly(viscosity: float, walls: bool, part: float) -> Any:
    """(z, u) of the exact solution on points of its own: it does not depend on the grid."""
    z = np.linspace(0.0, DEPTH, 1601)
    return z, Stopping(8, viscosity, walls).exact(z, part)


def stopping_profile_errors(viscosity: float, walls: bool) -> Callable:
    """Velocity half-way to the stop, relative to the surface at the start."""

    def errors(cells):
        z, u = stopping_computed(cells, viscosity, walls)[HALFWAY]
        return (u - np.interp(z, *stopping_exactly(viscosity, walls, HALFWAY))) / START

    return errors


def stopping_interface_errors(viscosity: float, walls: bool) -> Callable:
    """Height of the static-flowing interface at three times, relative to the depth."""
    level = INTERFACE * START

    def errors(cells):
        computed = stopping_computed(cells, viscosity, walls)
        found = [computed[part] for part in INTERFACE_AT]
        exactly = [stopping_exactly(viscosity, walls, part) for part in INTERFACE_AT]
        heights = [[np.interp(level, u, z) for z, u in profiles] for profiles in (found, exactly)]
        return np.subtract(*heights) / DEPTH

    return errors


def stopping_problems(
    name: str, viscosity: float, walls: bool, term: Any, profile: Any, interface: Any
) -> Any:
    """Velocity and interface of a stopping layer, with their tolerances."""
    problems = (
        (name, stopping_profile_errors(viscosity, walls), profile),
        (f"{name}_interface", stopping_interface_errors(viscosity, walls), interface),
    )
    return (
        Problem(name, term, errors, (8, 16, 32), None, tolerance, REGULARISATION)
        for name, errors, tolerance in problems
    )


def creep_errors(cells: int) -> np.ndarray:
    """Creep of a layer of 0.14 m at 0.9 arctan(mu_1), relative to formula 3.8 at its surface."""
    slope = 0.9 * math.degrees(math.atan(0.48))
    case = layer_case(
        0.14 / cells,
        0.14,
        geometry__slope_angle_deg=slope,
        boundary__mu_bed=math.inf,
        rheology__law="drucker_prager",
        rheology__viscosity=0.0,
    )
    flow = layer(case, lambda z: exact.creep(case, z), dt=0.05)
    z, u = run_until(flow, 0.5).profile()
    return (u - exact.creep(case, z)) / exact.creep(case, 0.14)


PROBLEMS = (
    Problem(
        "imposed_bed_stress",
        terms.BED,
        imposed_bed_stress_errors,
        (8, 16, 32),
        None,
        1e-5,
        "tolerance of the solver",
    ),
    Problem(
        "bed_slip", terms.BED, slip_errors(), (4, 8, 16), None, 1e-5, "tolerance of the solver"
    ),
    Problem(
        "bed_slip_drucker_prager",
        terms.BED,
        slip_errors(rheology__law="drucker_prager", rheology__viscosity=1.0),
        (4, 8, 16),
        None,
        1e-5,
        "tolerance of the solver",
    ),
    Problem("block", terms.BED, block_errors(False), (4, 8, 16), None, 1e-3, "creep"),
    Problem(
        "block_walls",
        terms.LATERAL_WALLS,
        block_errors(True),
        (4, 8, 16),
        None,
        1e-3,
        "creep",
    ),
    Problem(
        "lateral_friction_split",
        terms.LATERAL_WALLS,
        split_errors,
        (4, 8, 16),
        None,
        1e-5,
        "tolerance of the solver",
    ),
    Problem("start_up", terms.INERTIA, start_up_errors, (8, 16, 32), 2.0, 1e-3),
    *stopping_problems("stopping", 0.0, False, terms.YIELD_IN_TIME, 1e-2, 1e-2),
    *stopping_problems("stopping_walls", 0.0, True, terms.LATERAL_WALLS, 1e-2, 1e-2),
    *stopping_problems("stopping_viscous", 0.4, False, terms.YIELD_IN_TIME, 5e-3, 1e-2),
    *stopping_problems("stopping_viscous_walls", 0.4, True, terms.LATERAL_WALLS, 5e-3, 1e-2),
    Problem("creep", terms.REGULARISATION, creep_errors, (8, 16, 32), None, 0.02, "formula 3.8"),
)
