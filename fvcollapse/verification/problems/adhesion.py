"""Adhesive grains: a layer on a slope, a layer that hangs from a ceiling, and a vertical cut."""

import math
from typing import Any

import numpy as np

from fvcollapse.case.case import GRAVITY, Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.initial import HALO
from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import (
    UniformFlow,
    heed_interrupt,
    layer,
    layer_case,
    run_until,
    run_until_steady,
)
from fvcollapse.verification.problem import Problem

DEPTH, MU = 0.02, 0.38  # m
LAYER = {
    "geometry__slope_angle_deg": 24.0,
    "boundary__mu_bed": math.inf,
    "rheology__law": "drucker_prager",
    "rheology__mu_1": MU,
    "rheology__viscosity": 1.0,
    "numerics__film_thickness": 0.0,
}
PLUG = 0.4  # of the depth
CUT_OFF = 0.37  # of a cell, which the surface cuts
ROOM, HALVINGS = (
    1.5,
    8,
)  # largest thickness that is tried, over the critical one; halvings of the interval
SOON = 2.0  # s
HANGING, HELD, TORN = (
    0.08,
    0.8,
    1.5,
)  # m; weight over adhesion of a layer that holds and of one that falls
CUT, NUMBERS, CUT_TIME = (
    0.12,
    (2.0, 5.0),
    0.3,
)  # m; stability numbers between which the cut fails; s
CUT_HALVINGS = 6
MOVES = 0.05  # m/s, a twentieth of sqrt(g H)


def adhesive_case(cells: int, thickness: float, depth: float, **changes: Any) -> Case:
    """Case of a layer whose critical thickness is `thickness` (m), on cells of depth/cells."""
    case = layer_case(depth / cells, depth, **LAYER, **changes)
    trial = case.replace(**{"effects.cohesion": {"adhesion": 1.0}})
    adhesion = thickness / exact.adhesive_thickness(trial)
    return case.replace(**{"effects.cohesion": {"adhesion": adhesion}})


def layer_errors(cells: int) -> np.ndarray:
    """Velocity of an adhesive layer, relative to that of its plug."""
    case = adhesive_case(cells, PLUG * DEPTH, DEPTH)
    flow = run_until_steady(layer(case, lambda z: exact.adhesive_layer(case, z), dt=10.0))
    z, u = flow.profile()
    return (u - exact.adhesive_layer(case, z)) / exact.adhesive_layer(case, DEPTH)


def stopping_errors(cells: int) -> np.ndarray:
    """Least thickness of a layer that moves, over the critical one, less 1; a cell is 1/cells of it."""
    case = adhesive_case(round(ROOM * cells), DEPTH, ROOM * DEPTH)
    low, high = 0.5, ROOM
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        flow = run_until(layer(case, lambda z: 0.0 * z, dt=0.05, depth=middle * DEPTH), SOON)
        # creep stays below this: r/sqrt(1 - r^2) is 10 at r = 0.995
        if flow.surface_velocity() > 10.0 * middle * DEPTH * case.numerics.shear_rate_min:
            high = middle
        else:
            low = middle
    return np.array([0.5 * (low + high) - 1.0])


class HangingLayer(UniformFlow):
    """A layer below its bed: gravity pulls it off."""

    def __init__(self, case, state, dt):
        super().__init__(case, state, dt)
        balance = self.constants.balance._replace(gz=GRAVITY)
        self.constants = self.constants._replace(balance=balance)


def hanging(cells: int, weight: float) -> Any:
    """A layer of rho g H = `weight` times p_c that has hung for a step of 1 ms, and its depth, m. It cuts a cell."""
    depth = HANGING * (1.0 - CUT_OFF / cells)
    changes = {"geometry__slope_angle_deg": 0.0, "boundary__mu_bed": math.inf}
    adhesion = Case().rheology.density_bulk * GRAVITY * depth / weight
    case = layer_case(HANGING / cells, HANGING, effects__cohesion={"adhesion": adhesion}, **changes)
    flow = layer(case, lambda z: 0.0 * z, dt=1e-3, depth=depth)
    flow = HangingLayer(case, flow.state, 1e-3)
    flow.advance(1.0)
    return flow, depth


def tension_errors(cells: int) -> np.ndarray:
    """Pressure -rho g (H - z) of a layer that holds, at the centres of mass, relative to that at the ceiling."""
    flow, depth = hanging(cells, HELD)
    filled = flow.geometry.filled[HALO]
    wet = filled > 0.0
    middle = flow.grid.z_nodes[:-1] + 0.5 * filled * flow.grid.dz
    weight = flow.case.rheology.density_bulk * GRAVITY
    p = flow.cell_quantities()["pressure"][HALO]
    return (p[wet] + weight * (depth - middle[wet])) / (weight * depth)


def falling_errors(cells: int) -> np.ndarray:
    """Acceleration of a layer that tears off, less that of the whole mass, relative to g; half a cell stays behind."""
    flow, depth = hanging(cells, TORN)
    w = flow.state.w[HALO, 1 : cells + 1]
    return (w / 1e-3 - exact.hanging_acceleration(flow.case, depth)) / GRAVITY


def cut_errors(cells: int) -> np.ndarray:
    """Stability number rho g H/c tan(45 deg - phi/2) at which a vertical cut fails, over 3.78, less 1."""
    low, high = NUMBERS
    for _ in range(CUT_HALVINGS):
        middle = 0.5 * (low + high)
        if stands(cells, middle):
            low = middle
        else:
            high = middle
    return np.array([0.5 * (low + high) / 3.78 - 1.0])


def stands(cells: int, number: float) -> bool:
    """Whether a column twice as long as high, of this stability number, stands when its gate is gone."""
    case = Case().replace(
        **{
            "geometry.slope_angle_deg": 0.0,
            "geometry.height_0": CUT,
            "geometry.length_0": 2.0 * CUT,
            "grid.cell_size": CUT / cells,
            "gate.speed": math.inf,
            "boundary.mu_bed": math.inf,
            "rheology.mu_1": MU,
            "effects.cohesion": {"adhesion": 1.0},
        }
    )
    adhesion = CUT / exact.cut_height(case, number)
    simulation = Simulation(case.replace(**{"effects.cohesion": {"adhesion": adhesion}}))
    fastest = 0.0
    while simulation.state.time < CUT_TIME - 1e-12:
        simulation.advance(CUT_TIME)
        fastest = max(fastest, simulation.max_speed())
        if fastest > MOVES:
            return False
        heed_interrupt()
    return True


PROBLEMS = (
    Problem("adhesive_layer", terms.ADHESION, layer_errors, (8, 16, 32), 2.0, 2e-3),
    Problem(
        "adhesive_layer_stop",
        terms.ADHESION,
        stopping_errors,
        (4, 8, 16),
        None,
        0.01,
        "halvings of the interval; creep",
    ),
    Problem("hanging_layer", terms.ADHESION, tension_errors, (8, 16, 32), None, 1e-12, "round-off"),
    Problem("hanging_layer_fall", terms.ADHESION, falling_errors, (8, 16, 32), 1.0, 0.02),
    Problem(
        "vertical_cut",
        terms.ADHESION,
        cut_errors,
        (8, 16),
        None,
        0.1,
        "grid: 0.13 on 8 cells; 3.78 is that of phi = 0 and of grains that dilate",
    ),
)
