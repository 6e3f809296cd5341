"""A wall that closes the far end: grains rest against it, keep their volume, and fill the box level."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import GRAVITY, Case
from fvcollapse.errors import InputError
from fvcollapse.measure.pile import thickness
from fvcollapse.simulation import Simulation
from fvcollapse.step.geometry import cell_fractions
from fvcollapse.step.initial import initial_grid, initial_state

LENGTH, SLOPE = 0.40, 5.0  # of the box, m; degrees
FLUID = {
    "geometry.slope_angle_deg": SLOPE,
    "geometry.channel_width": math.inf,
    "grid.cell_size": 0.02,
    "rheology.law": "newtonian",
    "rheology.viscosity": 20.0,
    "boundary.mu_bed": 0.0,
    "boundary.mu_back_wall": 0.0,
    "boundary.right_end": "wall",
    "boundary.domain_length": LENGTH,
    "gate.speed": math.inf,
}


def level_depth(x, mean):
    """Depth, m, of a fluid at rest in the tilted box, whose mean is given, m."""
    return mean + (x - 0.5 * LENGTH) * math.tan(math.radians(SLOPE))


def box_at_rest(mean):
    """A box filled with a fluid whose surface is level, with the pressure that goes with it."""
    case = Case().replace(**FLUID)
    grid = initial_grid(case)
    state = initial_state(case, grid)
    down = math.cos(math.radians(SLOPE))
    x, z = np.meshgrid(grid.x_nodes, grid.z_nodes, indexing="ij")
    state.level_set[:] = (z - level_depth(x, mean)) * down
    state.volume_0 = cell_fractions(state.level_set).sum() * grid.dx * grid.dz
    return Simulation(case, state)


def test_a_level_fluid_rests_against_the_wall():
    box = box_at_rest(0.093)
    for _ in range(5):
        box.advance(1.0)
    assert box.max_speed() < 1e-9
    at_wall = 0.5 * (box.grid.z_centres[0] + box.grid.z_centres[1])
    pressure = 0.5 * (box.state.pressure_filled[-1, 0] + box.state.pressure_filled[-1, 1])
    middle = LENGTH - 0.5 * box.grid.dx
    down = GRAVITY * math.cos(math.radians(SLOPE))
    expected = box.case.rheology.density_bulk * down * (level_depth(middle, 0.093) - at_wall)
    assert pressure == pytest.approx(expected, rel=1e-6)


def test_a_dam_break_fills_the_box_level():
    case = Case().replace(**FLUID, **{"geometry.height_0": 0.2, "geometry.length_0": 0.2})
    simulation = Simulation(case)
    volume, start = simulation.state.volume_0, sum(simulation.energies().values())
    highest = 0.0
    while simulation.state.time < 6.0:
        marched = simulation.march(6.0, 50)
        assert marched.problem is None
        depth = thickness(simulation.state.level_set, simulation.grid.dz)
        highest = max(highest, depth[-1])
    state, grid = simulation.state, simulation.grid
    assert grid.nx * grid.dx == pytest.approx(LENGTH)
    assert simulation.geometry.filled.sum() * grid.dx * grid.dz == pytest.approx(volume, rel=1e-10)
    assert state.volume_outflow == 0.0
    expected = level_depth(grid.x_nodes, volume / LENGTH)
    assert depth == pytest.approx(expected, abs=0.01 * grid.dz)
    assert highest >= expected[-1]
    assert simulation.max_speed() < 1e-3
    spent = state.work_bulk + state.loss_time + state.loss_advection + state.loss_surface
    assert start - sum(simulation.energies().values()) == pytest.approx(spent, rel=2e-5)


def test_a_column_leaves_the_wall_as_it_leaves_the_back_wall():
    level = FLUID | {"geometry.slope_angle_deg": 0.0, "numerics.film_thickness": 0.0}
    column = {"geometry.height_0": 0.2, "geometry.length_0": 0.2}
    there = Simulation(Case().replace(**level, **column))
    state = there.state.copy()
    state.level_set[:] = there.state.level_set[::-1]
    state.pressure_filled[:] = there.state.pressure_filled[::-1]
    back = Simulation(there.case, state)
    for _ in range(60):
        there.advance(1.0)
        back.advance(1.0)
    filled, mirrored = there.geometry.filled, back.geometry.filled[::-1]
    assert np.abs(filled - mirrored).sum() < 2e-3 * filled.sum()
    assert back.energy["kinetic"] == pytest.approx(there.energy["kinetic"], rel=2e-3)


def test_a_wall_needs_its_place():
    with pytest.raises(InputError, match=r"boundary\.domain_length: found absent.*right_end"):
        Case().replace(**{"boundary.right_end": "wall"})
