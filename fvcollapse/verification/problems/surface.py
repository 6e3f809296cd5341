"""The free surface: carried by a given velocity, and at rest at an angle to the grid."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.coulomb_walls import bed_reaction
from fvcollapse.verification import exact, terms
from fvcollapse.verification.flows import run_until, surface_errors, transport
from fvcollapse.verification.problem import Problem

# -- at rest, surface at an angle to the grid --------------------------------------------------


def tilted_box_errors(cells: int) -> np.ndarray:
    """Bed pressure of a box tilted by 22 degrees, relative to rho g depth; and the speed in m/s."""
    case = Case().replace(
        **{
            "grid.cell_size": 0.14 / cells,
            "geometry.surface": "horizontal",
            "geometry.channel_width": math.inf,
            "gate.speed": 0.0,
        }
    )
    simulation = run_until(Simulation(case), 0.02)
    pressure, expected = bed_pressures(simulation)
    return np.append(pressure / expected - 1.0, simulation.max_speed())


def bed_pressures(simulation: Simulation) -> Any:
    """Reaction of the bed in the column's cells, and rho g depth below the level surface, Pa."""
    state, work = simulation.state, simulation.work
    columns = simulation.gate_column
    density, normal = simulation.case.rheology.density_bulk, simulation.gravity[1]
    found = [
        bed_reaction(
            state.pressure_filled,
            work.weight_centre,
            work.e_centre,
            simulation.geometry,
            column,
            normal,
            density,
            simulation.spacing[1],
        )
        for column in range(columns)
    ]
    return np.array(found), exact.pressure_tilted_box(
        simulation.case, simulation.grid.x_centres[:columns]
    )


# -- surfaces ----------------------------------------------------------------------------------


def surface_problems(
    name: str,
    surface: Callable,
    velocity: Callable,
    duration: float,
    grids: tuple,
    expected: Any = None,
    **judged: Any,
) -> Any:
    """Two problems: symmetric difference and area error once the surface is back (or at `expected`).

    `judged` holds for each, `difference` and `area`: expected order, tolerance and its source.
    """

    @cache
    def both(cells):
        phi = transport(surface, velocity, duration, cells)
        nodes = np.arange(cells + 1) / cells
        x, z = np.meshgrid(nodes, nodes, indexing="ij")
        return surface_errors(phi, (expected or surface)(x, z))

    def area(cells):
        return both(cells)[0]

    def difference(cells):
        return both(cells)[1]

    return (
        Problem(name, terms.SURFACE, difference, grids, *judged["difference"]),
        Problem(f"{name}_area", terms.SURFACE, area, grids, *judged["area"]),
    )


def disc_at(x_centre: float, z_centre: float) -> Callable:
    """Disc of radius 0.15 in the unit square."""
    return lambda x, z: exact.disc(x, z, x_centre, z_centre, 0.15)


def uniform(x: Any, z: Any, time: float) -> Any:
    """Velocity (0.4, 0.3) m/s."""
    return 0.4 + 0.0 * x, 0.3 + 0.0 * x


CORNERS, FILAMENTS = "corners of the slot are rounded", "filaments thinner than a cell are lost"
UPPER_DISC = disc_at(0.5, 0.75)
PROBLEMS = (
    Problem(
        "tilted_box",
        terms.CUT_CELLS,
        tilted_box_errors,
        (10, 16, 24),
        None,
        1e-6,
        "round-off",
    ),
    *surface_problems(
        "disc",
        disc_at(0.3, 0.3),
        uniform,
        1.0,
        (32, 64, 128),
        expected=disc_at(0.7, 0.6),
        difference=(1.8, 1e-3),
        area=(1.8, 1e-3),
    ),
    *surface_problems(
        "zalesak",
        exact.slotted_disc,
        exact.rotation,
        1.0,
        (50, 100, 200),
        difference=(None, 0.05, CORNERS),
        area=(None, 0.05, CORNERS),
    ),
    *surface_problems(
        "vortex_2s",
        UPPER_DISC,
        exact.single_vortex(2.0),
        2.0,
        (32, 64, 128),
        difference=(1.8, 1e-2),
        area=(1.8, 1e-2),
    ),
    *surface_problems(
        "vortex_8s",
        UPPER_DISC,
        exact.single_vortex(8.0),
        8.0,
        (64, 128, 192),
        difference=(None, 0.2, FILAMENTS),
        area=(None, 0.2, FILAMENTS),
    ),
)
