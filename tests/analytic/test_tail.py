"""A mass that slides away from the back wall leaves a film, far thinner than a cell, that slides after it."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.geometry import cell_fractions
from fvcollapse.step.initial import initial_grid, initial_state
from fvcollapse.verification import exact

CELL, FILM, THICK = 0.01, 4e-4, 0.03  # m


def mass_with_a_tail(speed):
    """A film to x = 0.3 m, a wedge, then a thick part; on a bed more slippery than the slope is steep."""
    case = Case().replace(
        **{
            "grid.cell_size": CELL,
            "geometry.height_0": 0.08,
            "geometry.length_0": 0.5,
            "gate.speed": math.inf,
            "effects.bed_friction": {"mu_bed": 0.21},
        }
    )
    grid = initial_grid(case)
    state = initial_state(case, grid)
    ends = [0.3, 0.4, 0.5, 0.5 + THICK, 2.0]
    height = np.interp(grid.x_nodes, ends, [FILM, FILM, THICK, 0.0, -1.0])
    state.level_set[:] = grid.z_nodes - height[:, None]
    state.u[1:], state.bed_slip[1:] = speed, speed
    state.volume_0 = cell_fractions(state.level_set).sum() * CELL**2
    return Simulation(case, state)


@pytest.fixture(scope="module", params=[0.0, 1.0])
def slid(request):
    """A mass after 0.2 s; the speed of a block at the start and then; the largest speed meanwhile."""
    simulation, largest = mass_with_a_tail(request.param), 0.0
    while simulation.state.time < 0.2:
        simulation.advance(0.2)
        largest = max(largest, simulation.max_speed())
    case = simulation.case
    gain = exact.gravity_normal(case) * (exact.slope_ratio(case) - 0.21) * 0.2
    return simulation, request.param, request.param + gain, largest


def test_the_film_slides_as_a_block(slid):
    """At rest it once stayed where it was, seven cells and more from the thicker flow."""
    simulation, first, speed, _ = slid
    wall_felt, wedge = speed * 0.2 + 0.05, first * 0.2 + 0.27  # m: what lies between is undisturbed
    film = simulation.state.u[round(wall_felt / CELL) : round(wedge / CELL), 0]
    assert film.size > 10
    assert film == pytest.approx(speed, rel=0.01)


def test_the_tail_does_not_feed_on_its_own_velocity(slid):
    """It once reached 5 m/s in 0.2 s; only the collapsing front is faster than the block."""
    simulation, _, speed, largest = slid
    assert largest < speed + math.sqrt(exact.gravity_normal(simulation.case) * THICK)
