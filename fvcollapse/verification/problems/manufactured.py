"""Manufactured solutions: a flow is prescribed, and the force that drives it is applied."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from fvcollapse.verification import exact, terms
from fvcollapse.verification.boxes import Box, box_case
from fvcollapse.verification.flows import run_until
from fvcollapse.verification.problem import Problem
from fvcollapse.verification.problems.box import pressure_errors, velocity_errors

# 2 mu_w p / (rho w) = 7 m/s2 at 3000 Pa
RUBBING = {"geometry__channel_width": 0.5, "effects__lateral_friction": {"mu_wall": 0.6}}


@lru_cache
def manufactured(flow: Callable, cells: int, surface: Any = None, walls: Any = False) -> Any:
    """A manufactured flow of a Drucker-Prager fluid, run until the discrete one is steady.

    With `walls` lateral friction brakes it, in every direction, about as much as gravity would.

    Returns
    -------
    velocity, pressure : 1-D arrays
        Errors, relative to the largest of the exact solution.
    """
    rubbing: dict[str, Any] = RUBBING if walls else {}
    case = box_case(
        cells,
        rheology__law="drucker_prager",
        rheology__mu_1=0.3,
        rheology__viscosity=200.0,
        numerics__shear_rate_min=1.0,
        **rubbing,
    )
    box = Box(
        case,
        0.1 * (8 / cells) ** 2,
        lambda x, z: flow(x, z)[:2],
        lambda x, z: np.maximum(flow(x, z)[2], 0.0),
        force=lambda x, z, time: exact.manufactured_force(case, flow, x, z, time),
        surface=surface,
    )
    run_until(box, 0.4)
    inside_u, inside_w, inside_p = box.inside()
    u, w = flow(box.x_u, box.z_u)[0], flow(box.x_w, box.z_w)[1]
    p = flow(box.x_p, box.z_p)[2]
    fastest = max(np.abs(u[inside_u]).max(), np.abs(w[inside_w]).max())
    return (
        velocity_errors(box, u, w) / fastest,
        (box.state.pressure_filled - p)[inside_p] / p[inside_p].max(),
    )


def manufactured_errors(part: int) -> Callable:
    """Errors of velocity (0) or pressure (1) in the full box."""
    return lambda cells: manufactured(exact.manufactured_box, cells)[part]


def curved(x: Any, z: Any) -> Any:
    """Level set of the curved surface, m."""
    return z - exact.manufactured_surface(x)


def manufactured_surface_errors(part: int) -> Callable:
    """The same below a curved free surface."""
    return lambda cells: manufactured(exact.manufactured_below_surface, cells, curved)[part]


# -- advection ---------------------------------------------------------------------------------


@lru_cache
def gyres(cells: int, refined: Any) -> Any:
    """Two swinging gyres of a nearly inviscid fluid; cell Reynolds number 1250 to 200.

    In space the advection is of second order: third-order reconstruction, but the mass fluxes
    take the mean of two faces and one point per side. In time it is of first order, as the whole
    step: its two stages share the mass fluxes of the old velocity, and the solve is implicit Euler.
    So the order is 2 with a time step proportional to the cell size to the power `refined` = 2,
    and 1 with a constant Courant number (1).

    Returns
    -------
    velocity, pressure : 1-D arrays
        Errors, relative to the largest speed, 1 m/s, and to half the density times its square.
    """
    density, viscosity_kinematic, duration = 1000.0, 1e-4, 0.5
    flow = exact.manufactured_gyres
    case = box_case(cells, rheology__viscosity=viscosity_kinematic * density)
    box = Box(
        case,
        0.02 * (8 / cells) ** refined,
        lambda x, z: flow(x, z)[:2],
        lambda x, z: flow(x, z)[2],
        force=lambda x, z, time: exact.manufactured_force(case, flow, x, z, time),
    )
    run_until(box, duration)
    u, w = flow(box.x_u, box.z_u, duration)[0], flow(box.x_w, box.z_w, duration)[1]
    p = flow(box.x_p, box.z_p, duration)[2]
    return velocity_errors(box, u, w), pressure_errors(box, p) / (0.5 * density)


PROBLEMS = (
    Problem(
        "manufactured_lateral_friction",
        terms.LATERAL_WALLS,
        lambda cells: manufactured(exact.manufactured_box, cells, walls=True)[0],
        (8, 16, 32, 48),
        2.0,
        2e-2,
    ),
    Problem(
        "manufactured_velocity",
        terms.VISCOUS,
        manufactured_errors(0),
        (8, 16, 32, 48),
        2.0,
        2e-2,
    ),
    Problem(
        "manufactured_pressure",
        terms.PRESSURE,
        manufactured_errors(1),
        (8, 16, 32, 48),
        2.0,
        1e-2,
    ),
    Problem(
        "manufactured_surface_velocity",
        terms.VISCOUS,
        manufactured_surface_errors(0),
        (8, 16, 32, 48),
        2.0,
        5e-2,
    ),
    Problem(
        "manufactured_surface_pressure",
        terms.PRESSURE,
        manufactured_surface_errors(1),
        (8, 16, 32, 48),
        2.0,
        5e-2,
    ),
    Problem(
        "manufactured_advection",
        terms.ADVECTION,
        lambda cells: gyres(cells, 2)[0],
        (8, 16, 32, 48),
        2.0,
        1.2e-2,
    ),
    Problem(
        "manufactured_advection_pressure",
        terms.ADVECTION,
        lambda cells: gyres(cells, 2)[1],
        (8, 16, 32, 48),
        2.0,
        3e-2,
    ),
    Problem(
        "manufactured_advection_courant",
        terms.ADVECTION,
        lambda cells: gyres(cells, 1)[0],
        (8, 16, 32, 48),
        1.0,
        5e-2,
    ),
)
