"""Boxes and channels full of fluid: inertia, viscosity and pressure without a surface."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from fvcollapse.case.case import GRAVITY
from fvcollapse.verification import exact, terms
from fvcollapse.verification.boxes import Box, box_case, channel_case
from fvcollapse.verification.flows import run_until, run_until_steady
from fvcollapse.verification.problem import Problem

DENSITY = 1000.0  # kg/m3
NO_SLIP = {"boundary__mu_bed": math.inf, "boundary__mu_back_wall": math.inf}


def hydrostatic(x: Any, z: Any) -> Any:
    """Pressure at rest below a lid at z = 1 m, Pa."""
    return DENSITY * GRAVITY * (1.0 - z)


def at_rest(x: Any, z: Any) -> Any:
    """No velocity."""
    return 0.0 * x, 0.0 * z


def velocity_errors(box: Any, u: Any, w: Any) -> np.ndarray:
    """Errors of u and w on all faces of the fluid, for the exact fields on all faces."""
    inside_u, inside_w, _ = box.inside()
    return np.concatenate([(box.state.u - u)[inside_u], (box.state.w - w)[inside_w]])


def pressure_errors(box: Any, p: np.ndarray) -> np.ndarray:
    """Errors of the pressure in all cells of the fluid, but for a constant, which a closed box leaves open; Pa."""
    inside = box.inside()[2]
    error = (box.state.pressure_filled - p)[inside]
    return error - error.mean()


@lru_cache
def taylor_green(cells: int) -> Any:
    """Vortices that fade to 1/1.2; time step proportional to the cell size squared.

    Returns
    -------
    velocity, pressure : 1-D arrays
        Errors, relative to the speed at the start and to the pressure difference at the end.
    """
    nu, k, duration = 0.02, math.pi, 0.5
    case = box_case(cells, rheology__viscosity=nu * DENSITY)

    def velocity(x, z, time=0.0):
        return exact.taylor_green(x, z, time, nu, k, 1.0)

    def pressure(x, z, time=0.0):
        return hydrostatic(x, z) + DENSITY * exact.taylor_green_pressure(x, z, time, nu, k, 1.0)

    box = Box(case, 0.05 * (8 / cells) ** 2, velocity, pressure)
    run_until(box, duration)
    u, _ = velocity(box.x_u, box.z_u, duration)
    _, w = velocity(box.x_w, box.z_w, duration)
    p = pressure(box.x_p, box.z_p, duration)
    dynamic = np.ptp(p - hydrostatic(box.x_p, box.z_p))
    return velocity_errors(box, u, w), pressure_errors(box, p) / dynamic


# -- walls -------------------------------------------------------------------------------------


def poiseuille_errors(cells: int) -> np.ndarray:
    """Flow down a slope between a bed and a lid that hold it, relative to the middle."""
    case = channel_case(
        cells,
        0.1,
        rheology__viscosity=10.0,
        geometry__slope_angle_deg=20.0,
        boundary__mu_bed=math.inf,
    )

    def velocity(x, z):
        return exact.poiseuille(case, z), 0.0 * x

    h, nu = case.grid.cell_size, 0.01
    weight = DENSITY * exact.gravity_normal(case)
    box = Box(case, 0.4 * h**2 / nu, velocity, lambda x, z: weight * (0.1 - z), no_slip=True)
    run_until(box, 0.5 * 0.1**2 / nu)
    inside = box.inside()[0]
    return (box.state.u - velocity(box.x_u, box.z_u)[0])[inside] / exact.poiseuille(case, 0.05)


def poiseuille_bingham_errors(cells: int) -> np.ndarray:
    """One half of a Bingham Poiseuille flow, whose plane of symmetry is a lid that lets slip."""
    case = channel_case(
        cells,
        0.1,
        rheology__law="bingham",
        rheology__viscosity=10.0,
        rheology__cohesion=100.0,
        geometry__slope_angle_deg=20.0,
        boundary__mu_bed=math.inf,
    )

    def velocity(x, z):
        return exact.film_bingham(case, z), 0.0 * x

    weight = DENSITY * exact.gravity_normal(case)
    box = run_until_steady(Box(case, 1.0, velocity, lambda x, z: weight * (0.1 - z)))
    inside = box.inside()[0]
    return (box.state.u - velocity(box.x_u, box.z_u)[0])[inside] / exact.film_bingham(case, 0.1)


def couette_errors(cells: int) -> np.ndarray:
    """Channel at rest whose bed starts to move; time step proportional to the cell size squared."""
    case = channel_case(cells, 0.1, rheology__viscosity=10.0, boundary__mu_bed=math.inf)
    h, nu = case.grid.cell_size, 0.01
    duration = 0.1 * 0.1**2 / nu
    box = Box(
        case,
        0.4 * h**2 / nu,
        at_rest,
        lambda x, z: DENSITY * GRAVITY * (0.1 - z),
        no_slip=True,
        bed_speed=1.0,
    )
    run_until(box, duration)
    inside = box.inside()[0]
    return box.state.u[inside] - exact.couette_start_up(case, box.z_u[0][:cells], duration, 1.0)


@lru_cache
def cavity(cells: int) -> Any:
    """Steady flow in a unit box, Re = 100, whose bed moves; velocities through the middle.

    The predictor makes the steady state depend on the time step to first order, so the step is
    proportional to the cell size squared.

    Returns
    -------
    distance : (cells,) array
        Cell centres, from the wall opposite the bed (for u) and from the back wall (for w), m.
    u, w : (cells,) arrays
        Velocity along the bed on the line x = 1/2 and normal to it, upwards away from the bed
        counted negative, on the line z = 1/2, m/s.
    """
    nu = 0.01
    case = box_case(cells, rheology__viscosity=nu * DENSITY, **NO_SLIP)
    box = Box(case, 4.0 / cells**2, at_rest, hydrostatic, no_slip=True, bed_speed=1.0)
    run_until(box, 14.0)
    middle = cells // 2
    return (
        (np.arange(cells) + 0.5) / cells,
        box.state.u[middle, :cells][::-1].copy(),
        -box.state.w[:cells, middle].copy(),
    )


def cavity_errors(points_u: Any, points_v: Any) -> Callable:
    """Velocities through the middle of the cavity at the points (distance, value) of a table."""

    def errors(cells):
        distance, u, w = cavity(cells)
        return np.concatenate(
            [
                between(distance, u, points_u[:, 0], 1.0) - points_u[:, 1],
                between(distance, w, points_v[:, 0], 0.0) - points_v[:, 1],
            ]
        )

    return errors


def between(distance: np.ndarray, values: np.ndarray, points: Any, far_wall: float) -> np.ndarray:
    """Cubic interpolation of values at the cell centres, 0 at the near wall, `far_wall` at 1."""
    return CubicSpline(
        np.concatenate([[0.0], distance, [1.0]]), np.concatenate([[0.0], values, [far_wall]])
    )(points)


def sixteenths(values: Any) -> Any:
    """A table at 1/16, 2/16, ..., 15/16."""
    return np.column_stack([np.arange(1, 16) / 16, values])


GHIA_SOURCE = "Ghia's own error, up to 0.0092 from Marchi et al. (2009), and the grid"

PROBLEMS = (
    Problem(
        "taylor_green",
        terms.ADVECTION,
        lambda cells: taylor_green(cells)[0],
        (8, 16, 32, 64),
        2.0,
        1e-3,
    ),
    Problem(
        "taylor_green_pressure",
        terms.ADVECTION,
        lambda cells: taylor_green(cells)[1],
        (8, 16, 32, 64),
        2.0,
        1e-3,
    ),
    Problem(
        "poiseuille",
        terms.VISCOUS,
        poiseuille_errors,
        (8, 16, 32),
        2.0,
        1.2e-3,
    ),
    Problem(
        "poiseuille_bingham",
        terms.YIELD_STRESS,
        poiseuille_bingham_errors,
        (8, 16, 32),
        2.0,
        2e-3,
    ),
    Problem("couette_start_up", terms.INERTIA, couette_errors, (8, 16, 32), 2.0, 1e-3),
    Problem(
        "cavity",
        terms.ADVECTION,
        cavity_errors(sixteenths(exact.MARCHI_U), sixteenths(exact.MARCHI_V)),
        (12, 16, 24, 32),
        2.0,
        1e-2,
    ),
    Problem(
        "cavity_ghia",
        terms.ADVECTION,
        cavity_errors(exact.GHIA_U, exact.GHIA_V),
        (16, 24, 32),
        None,
        1.2e-2,
        GHIA_SOURCE,
    ),
)
