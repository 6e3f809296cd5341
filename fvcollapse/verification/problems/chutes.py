"""Steady flow between lateral walls with friction; the error is split into grid and regularisation."""

from collections.abc import Callable
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import layer, layer_case, run_until_steady
from fvcollapse.verification.problem import Problem
from fvcollapse.verification.problems.steady import DEPTH, GLASS, SLOPE, steady_errors

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


WALLS = {"geometry__channel_width": 0.10, "effects__lateral_friction": {}}
LAWS = {  # exact solution, and what the case changes
    "drucker_prager": (
        exact.chute_drucker_prager,
        {
            **SLOPE,
            **WALLS,
            "geometry__slope_angle_deg": 25.0,
            "rheology__law": "drucker_prager",
            "rheology__mu_1": 0.38,
            "rheology__viscosity": 20.0,
        },
    ),
    "mu_I": (exact.chute_mu_I, {**SLOPE, **GLASS, **WALLS, "geometry__slope_angle_deg": 26.0}),
}
DEEP = {"drucker_prager": 0.06, "mu_I": 0.08}  # m; at rest below 0.048 and 0.060 m
FLOWING = 0.05  # shear rate at which the flowing depth is compared, in units of the largest


def shallow_errors(law: str) -> Callable:
    """A layer that flows down to the bed."""
    solution, changes = LAWS[law]
    return steady_errors(solution, DEPTH, **changes)


# -- a layer that rests on its lower part ------------------------------------------------------


@lru_cache
def deep_chute(law: str, cells: int) -> Any:
    """The case of a deep layer, heights (m) and steady velocity (m/s)."""
    solution, changes = LAWS[law]
    case = layer_case(DEEP[law] / cells, DEEP[law], **changes)
    flow = layer(case, lambda z: solution(case, z), dt=10.0)
    return case, *run_until_steady(flow).profile()


@cache
def regularised(law: str) -> Any:
    """The regularised profile u(z), m/s: it does not depend on the grid."""
    return exact.chute_regularised(deep_chute(law, 8)[0])


def surface_velocity(law: str, case: "Case") -> float:
    """Exact velocity of the surface, the scale of the errors, m/s."""
    return LAWS[law][0](case, np.array([DEEP[law]]))[0]


def deep_errors(law: str) -> Callable:
    """All of the error: against the rigid-plastic law."""

    def errors(cells):
        case, z, u = deep_chute(law, cells)
        return (u - LAWS[law][0](case, z)) / surface_velocity(law, case)

    return errors


def grid_errors(law: str) -> Callable:
    """The part of the grid: against the same law regularised as in the solver."""

    def errors(cells):
        case, z, u = deep_chute(law, cells)
        return (u - regularised(law)(z)) / surface_velocity(law, case)

    return errors


def regularisation_errors(law: str) -> Callable:
    """The part of the regularisation, by the two exact solutions at the centres of the cells."""

    def errors(cells):
        case, z, _ = deep_chute(law, cells)
        return (regularised(law)(z) - LAWS[law][0](case, z)) / surface_velocity(law, case)

    return errors


def flowing_depth_errors(law: str) -> Callable:
    """Depth where the shear rate has fallen to `FLOWING` of its largest, relative to w (T - mu_1)/mu_w.

    The exact shear rate vanishes at that depth, the regularised one nowhere.
    """

    def errors(cells):
        case, z, u = deep_chute(law, cells)
        fine = np.linspace(0.0, DEEP[law], 2001)
        exactly = LAWS[law][0](case, fine)
        level = FLOWING * np.diff(exactly).max() / fine[1]
        found, expected = (
            height_of_shear_rate(z, u, level),
            height_of_shear_rate(fine, exactly, level),
        )
        return (expected - found) / exact.flowing_depth(case)

    return errors


def height_of_shear_rate(z: np.ndarray, u: np.ndarray, level: float) -> float:
    """Height at which the shear rate first exceeds `level`, m."""
    shear_rate, middle = np.diff(u) / np.diff(z), 0.5 * (z[1:] + z[:-1])
    first = np.argmax(shear_rate > level)
    part = slice(first - 1, first + 1)
    return np.interp(level, shear_rate[part], middle[part])


def problems(law: str, tolerances: Any) -> Any:
    """The problems of one law; the last tolerances are of the whole error, grid, rest, and depth."""
    whole, grid, rest, depth = tolerances
    name, term, grids = f"chute_{law}", terms.LATERAL_WALLS, (8, 16, 32, 64)
    exactly = "regularisation: difference of the two exact solutions"
    return (
        Problem(f"{name}_shallow", term, shallow_errors(law), grids, 1.8, 1e-3),
        Problem(f"{name}_deep", term, deep_errors(law), grids, None, whole, "the two parts below"),
        Problem(f"{name}_deep_grid", term, grid_errors(law), grids, 1.8, grid),
        Problem(
            f"{name}_deep_regularisation",
            term,
            regularisation_errors(law),
            grids,
            None,
            rest,
            exactly,
        ),
        Problem(
            f"{name}_flowing_depth",
            term,
            flowing_depth_errors(law),
            grids,
            None,
            depth,
            "regularisation, and the shear rate between two cells",
        ),
    )


PROBLEMS = (
    *problems("drucker_prager", (5e-3, 1e-3, 3e-3, 1e-2)),
    *problems("mu_I", (5e-3, 1e-3, 3e-3, 1e-2)),
)
