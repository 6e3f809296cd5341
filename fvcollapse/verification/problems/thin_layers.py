"""Layers on a rough bed that flow or stay, by their thickness; a thick layer flows as without the effect."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.verification import exact, terms
from fvcollapse.verification.exact import stopping_thickness
from fvcollapse.verification.flows import layer, layer_case, run_until
from fvcollapse.verification.problem import Problem
from fvcollapse.verification.problems.steady import GLASS, SLOPE, steady_errors

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


ANGLES = (22.0, 24.0, 27.0, 30.0)  # deg
ROOM = 1.5  # height of the grid over the stopping thickness: the largest thickness that is tried
HALVINGS = 9  # of the interval of the thickness, whose middle is the answer: 0.1 % of the stopping thickness
SHEAR_RATE = 0.05  # 1/s, a hundred times that of creep: the slowest that counts as flow
SOON = 2.0  # s, after which a layer that was sheared so fast flows faster or creeps
NONLOCAL = {"length": 10.0, "closure": "nonlocal"}  # h_stop of 10 to 30 diameters


def least_thickness(cells: int, angle: float, bed: Any, effect: Any) -> float:
    """Least thickness of a layer that goes on flowing, over the stopping thickness of the formula.

    The cells are `cells` per stopping thickness, so that one cell is an error of 1/cells.
    """
    changes = {
        **GLASS,
        "geometry__slope_angle_deg": angle,
        "boundary__mu_bed": bed,
        "numerics__film_thickness": 0.0,  # these layers are films
    }
    effect = {"effects__thin_layer": effect}
    expected = stopping_thickness(layer_case(0.01, 1.0, **changes, **effect))
    case = layer_case(expected / cells, ROOM * expected, **changes, **effect)
    low, high = 0.5, ROOM
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if flows(case, middle * expected):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def flows(case: "Case", depth: float) -> bool:
    """Whether a layer of `depth` (m) that is sheared slowly gains speed."""
    flow = layer(case, lambda z: SHEAR_RATE * z, dt=0.1, depth=depth)
    return run_until(flow, SOON).mean_velocity() > 0.5 * SHEAR_RATE * depth


def stopping_errors(bed: Any, effect: Any) -> Callable:
    """Relative errors of the stopping thickness at the angles, as a function of cells per stopping thickness."""

    def errors(cells):
        return np.array([least_thickness(cells, angle, bed, effect) - 1.0 for angle in ANGLES])

    return errors


CELL = "a cell, 1/16 of the thickness"
PROBLEMS = (
    Problem(
        "thin_layer_stop",
        terms.THIN_LAYER,
        stopping_errors(math.inf, {}),
        (4, 8, 16),
        None,
        1 / 16,
        CELL,
    ),
    Problem(
        "thin_layer_stop_sliding",
        terms.THIN_LAYER,
        stopping_errors(GLASS["rheology__mu_1"], {}),
        (4, 8, 16),
        None,
        1 / 16,
        CELL,
    ),
    Problem(
        "thin_layer_stop_nonlocal",
        terms.FLUIDITY,
        stopping_errors(math.inf, NONLOCAL),
        (4, 8, 16),
        None,
        0.05,
        "grid; the shear rate that counts as flow",
    ),
    Problem(
        "thin_layer_thick",
        terms.THIN_LAYER,
        steady_errors(exact.bagnold, **SLOPE, **GLASS, effects__thin_layer={}),
        (8, 16, 32, 64),
        1.8,
        1e-3,
    ),
)
