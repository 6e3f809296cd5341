"""Steady uniform flow of a layer on a bed that holds it."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import layer, layer_case, run_until_steady
from fvcollapse.verification.problem import Problem

DEPTH = 0.02  # m, of the layers, unless said otherwise
SLOPE = {"geometry__slope_angle_deg": 24.0, "boundary__mu_bed": math.inf}
GLASS = {"rheology__mu_1": 0.38, "rheology__mu_2": 0.64}


def steady_errors(solution: Callable, depth: float = DEPTH, **changes: Any) -> Callable:
    """Errors of a steady layer on a bed that holds it, as a function of the cells per depth."""

    def errors(cells):
        case = layer_case(depth / cells, depth, **changes)
        flow = layer(case, lambda z: solution(case, z), dt=10.0)
        z, u = run_until_steady(flow).profile()
        return (u - solution(case, z)) / solution(case, np.array([depth]))[0]

    return errors


def bagnold_errors(slope_angle_deg: float) -> Callable:
    """Bagnold flow of glass beads."""
    return steady_errors(
        exact.bagnold, **{**SLOPE, **GLASS, "geometry__slope_angle_deg": slope_angle_deg}
    )


def bagnold_gerris_errors(cells: int) -> np.ndarray:
    """The Bagnold flow that Gerris ships, in its units (H = g = rho = 1): absolute errors."""
    unit = math.sqrt(GRAVITY)
    case = layer_case(
        1.0 / cells,
        1.0,
        geometry__slope_angle_deg=math.degrees(0.43),
        boundary__mu_bed=math.inf,
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
        rheology__I_0=0.3,
        rheology__grain_diameter=0.04,
        rheology__density_grain=1550.0,
    )
    flow = layer(case, lambda z: exact.bagnold(case, z), dt=100.0)
    z, u = run_until_steady(flow).profile()
    return (u - exact.bagnold(case, z)) / unit


PROBLEMS = (
    Problem("bagnold_22deg", terms.MU_I, bagnold_errors(22.0), (8, 16, 32, 64), 1.8, 1e-3),
    Problem("bagnold_24deg", terms.MU_I, bagnold_errors(24.0), (8, 16, 32, 64), 1.8, 1e-3),
    Problem("bagnold_28deg", terms.MU_I, bagnold_errors(28.0), (8, 16, 32, 64), 1.8, 1e-3),
    Problem("bagnold_gerris", terms.MU_I, bagnold_gerris_errors, (8, 16, 32, 64), 1.8, 8e-4),
    Problem(
        "incline_drucker_prager",
        terms.DRUCKER_PRAGER,
        steady_errors(
            exact.incline_drucker_prager,
            **SLOPE,
            rheology__law="drucker_prager",
            rheology__mu_1=0.38,
            rheology__viscosity=1.0,
        ),
        (8, 16, 32, 64),
        2.0,
        1e-4,
    ),
    Problem(
        "film_newtonian",
        terms.VISCOUS,
        steady_errors(
            exact.film_newtonian, **SLOPE, rheology__law="newtonian", rheology__viscosity=1.0
        ),
        (8, 16, 32, 64),
        2.0,
        1e-4,
    ),
    Problem(
        "film_bingham",
        terms.YIELD_STRESS,
        steady_errors(
            exact.film_bingham,
            **SLOPE,
            rheology__law="bingham",
            rheology__viscosity=1.0,
            rheology__cohesion=50.0,
        ),
        (8, 16, 32, 64),
        2.0,
        5e-4,
    ),
)
