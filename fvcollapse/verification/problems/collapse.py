"""Collapses of a Newtonian column, against the limits of a long, shallow flow."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from fvcollapse.case.case import GRAVITY, Case
from fvcollapse.measure.pile import front_position, thickness
from fvcollapse.simulation import Simulation
from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import run_until
from fvcollapse.verification.problem import Problem

DENSITY = 1000.0  # kg/m3
SLUMP_LENGTH = 3.0  # column heights: the slump is compared when its front should be there
FAN_TIME = {0.0: 4.0, 20.0: 3.0}  # s sqrt(g/H); slope in degrees: when a dam break is compared


def column_case(cells: int, length: float, **changes: Any) -> Case:
    """Case of a Newtonian column, 1 m high, released at once; the back wall lets it slip."""
    keys = {
        "grid.cell_size": 1.0 / cells,
        "geometry.height_0": 1.0,
        "geometry.length_0": length,
        "geometry.slope_angle_deg": 0.0,
        "geometry.channel_width": math.inf,
        "rheology.law": "newtonian",
        "rheology.density_bulk": DENSITY,
        "boundary.mu_back_wall": 0.0,
        "gate.speed": math.inf,
        "time.step_max": 0.1,
        "numerics.film_thickness": 0.0,
    }
    keys.update({name.replace("__", "."): value for name, value in changes.items()})
    return Case().replace(**keys)


def depths(simulation: Simulation) -> Any:
    """Abscissae and depths at the nodes, m."""
    return simulation.grid.x_nodes, thickness(simulation.state.level_set, simulation.spacing[1])


def slump_errors(cells: int) -> np.ndarray:
    """Front (where 0.05 m thick), depth at the back wall and L1 of the profile of a viscous slump."""
    nu = 0.5
    case = column_case(cells, 1.0, boundary__mu_bed=math.inf, rheology__viscosity=nu * DENSITY)
    simulation = Simulation(case)
    area = simulation.state.volume_0
    duration = (SLUMP_LENGTH / exact.huppert_front(area, nu, 1.0)) ** 5
    run_until(simulation, duration)
    x, h = depths(simulation)
    fine = np.linspace(0.0, 1.2 * SLUMP_LENGTH, 10001)
    front = front_position(fine, exact.huppert_depth(area, SLUMP_LENGTH, fine), 0.05)
    expected = exact.huppert_depth(area, SLUMP_LENGTH, x)
    return np.array(
        [
            front_position(x, h, 0.05) / front - 1.0,
            h[0] / expected[0] - 1.0,
            np.abs(h - expected).sum() * simulation.spacing[0] / area,
        ]
    )


def dam_break_errors(slope: float) -> Callable:
    """L1 of the profile, depth at the dam and two fronts of an inviscid column on a free-slip bed.

    Relative to what has the size of the fan itself: its depth, its length 3 c t. Behind the fan on
    a slope the fluid leaves the back wall; that part is not compared.
    """
    length = 4.0 if slope == 0.0 else 6.0

    def errors(cells):
        case = column_case(
            cells,
            length,
            geometry__slope_angle_deg=slope,
            boundary__mu_bed=0.0,
            rheology__viscosity=0.0,
        )
        time = FAN_TIME[slope] / math.sqrt(GRAVITY)
        c = math.sqrt(exact.gravity_normal(case))
        x, h = depths(run_until(Simulation(case), time))
        dam = length + 0.5 * GRAVITY * math.sin(math.radians(slope)) * time**2
        fan = x > dam - c * time
        expected = exact.dam_break_depth(case, x, time)
        area = 1.0 * c * time  # all that has been set in motion behind the dam
        found = [
            np.abs(h - expected)[fan].sum() * (x[1] - x[0]) / area,
            np.interp(dam, x, h) / (4 / 9) - 1.0,
        ]
        for depth in (0.05, 0.3):
            front = dam + (2.0 - 3.0 * math.sqrt(depth)) * c * time
            found.append((front_position(x[fan], h[fan], depth) - front) / (3.0 * c * time))
        return np.array(found)

    return errors


PROBLEMS = (
    Problem(
        "viscous_slump",
        terms.COLLAPSE,
        slump_errors,
        (8, 12, 16, 24),
        None,
        0.03,
        "lubrication: (depth/length)^2 = 0.017; and the front within one cell, 0.014",
    ),
    Problem(
        "dam_break",
        terms.COLLAPSE,
        dam_break_errors(0.0),
        (6, 8, 12, 24),
        None,
        1 / 12,
        "shallow water: depth/length of the fan, H/(3 c t) = 1/12",
    ),
    Problem(
        "dam_break_slope",
        terms.COLLAPSE,
        dam_break_errors(20.0),
        (6, 8, 12, 24),
        None,
        0.115,
        "shallow water: depth/length of the fan, H/(3 c t) = 0.115",
    ),
)
