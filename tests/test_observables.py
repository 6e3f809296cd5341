"""Measured quantities on level sets and profiles whose answer is known on paper."""

import numpy as np
import pytest
from fake_simulation import FakeSimulation

from fvcollapse.case.case import Case
from fvcollapse.measure import observables, pile
from fvcollapse.measure.series_row import ROW, fill_row, reading_of
from fvcollapse.simulation import Simulation
from fvcollapse.step.compiled import from_python
from fvcollapse.step.grid import Grid
from fvcollapse.step.state import State


def plane_level_set(grid, height, slope=0.0):
    """Signed height above the plane z = height - slope x, linear in space."""
    return grid.z_nodes[None, :] - (height - slope * grid.x_nodes)[:, None]


def state_of(level_set, u, w=None, bed_slip=None):
    """A state at rest but for what is given."""
    nx, nz = level_set.shape[0] - 1, level_set.shape[1] - 1
    return State(
        level_set,
        u,
        np.zeros((nx, nz + 1)) if w is None else w,
        np.zeros((nx, nz)),
        np.zeros(nx + 1) if bed_slip is None else bed_slip,
    )


# -- thickness ---------------------------------------------------------------------------------


def test_thickness_of_a_plane_surface_is_exact():
    grid = Grid(12, 9, 0.01, 0.007)
    h = pile.thickness(plane_level_set(grid, 0.05, 0.3), grid.dz)
    np.testing.assert_allclose(h, np.maximum(0.05 - 0.3 * grid.x_nodes, 0.0), atol=1e-15)


def test_thickness_adds_separate_pieces():
    """A layer of 0.5 cells at the bed and a sheet of 1 cell above an empty one."""
    level_set = np.array([[-0.5, 0.5, 0.5, -0.5, -0.5, 0.5]] * 3)
    np.testing.assert_allclose(pile.thickness(level_set, 2.0), 2.0 * (0.5 + 0.5 + 1.0 + 0.5))


def test_thickness_is_zero_without_grains_and_full_without_surface():
    assert pile.thickness(np.ones((3, 5)), 0.1).max() == 0.0
    np.testing.assert_allclose(pile.thickness(-np.ones((3, 5)), 0.1), 0.4)


def test_thickness_of_a_touching_surface_is_zero():
    assert pile.thickness(np.zeros((2, 4)), 0.1).max() == 0.0


# -- static–flowing interface ------------------------------------------------------------------


def sheared(slope, height=0.08, offset=0.0):
    """Layer with speed u = slope (z - offset), never negative."""
    grid = Grid(6, 12, 0.01, 0.01)
    z = grid.dz * (np.arange(grid.nz) + 0.5)
    u = np.tile(np.maximum(slope * (z - offset), 0.0), (grid.nx + 1, 1))
    return state_of(plane_level_set(grid, height), u), grid


def test_static_height_of_a_linear_profile_is_exact():
    """u = z/2 reaches 0.01 m/s at z = 0.02 m, between two rows of faces."""
    state, grid = sheared(0.45)
    np.testing.assert_allclose(pile.static_height(state, grid), 0.01 / 0.45, rtol=1e-12)


def test_static_height_at_rest_is_the_thickness():
    state, grid = sheared(0.0)
    np.testing.assert_allclose(pile.static_height(state, grid), 0.08)


def test_static_height_of_a_sliding_plug_is_the_bed():
    grid = Grid(6, 12, 0.01, 0.01)
    u, slip = np.full((7, 12), 0.5), np.full(7, 0.5)
    state = state_of(plane_level_set(grid, 0.08), u, bed_slip=slip)
    assert pile.static_height(state, grid).max() == 0.0


def test_static_height_is_below_the_first_face_when_the_bed_sticks():
    grid = Grid(6, 12, 0.01, 0.01)
    state = state_of(plane_level_set(grid, 0.08), np.full((7, 12), 0.5))
    np.testing.assert_allclose(pile.static_height(state, grid), 0.005 * 0.01 / 0.5)


def test_static_height_counts_the_normal_velocity():
    grid = Grid(6, 12, 0.01, 0.01)
    state = state_of(plane_level_set(grid, 0.08), np.zeros((7, 12)), np.full((6, 13), -0.3))
    assert pile.static_height(state, grid).max() < 0.005


def test_static_height_takes_the_highest_slow_place():
    """Fast, slow, fast from the bed up: only the grains above the slow place count as flowing."""
    grid = Grid(2, 8, 0.01, 0.01)
    u = np.tile([0.5, 0.5, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5], (3, 1))
    state = state_of(plane_level_set(grid, 0.07), u, bed_slip=np.full(3, 0.5))
    np.testing.assert_allclose(pile.static_height(state, grid), 0.035 + 0.01 * 0.01 / 0.5)


def test_static_height_ignores_what_is_above_the_surface():
    grid = Grid(2, 8, 0.01, 0.01)
    u = np.tile([0.5, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], (3, 1))
    state = state_of(plane_level_set(grid, 0.03), u, bed_slip=np.full(3, 0.5))
    assert pile.static_height(state, grid).max() == 0.0


def test_static_height_is_zero_where_there_are_no_grains():
    grid = Grid(10, 8, 0.01, 0.01)
    state = state_of(plane_level_set(grid, 0.04, slope=1.0), np.zeros((11, 8)))
    height, h = pile.static_height(state, grid), pile.thickness(state.level_set, 0.01)
    np.testing.assert_allclose(height, h, atol=1e-15)


# -- front and volume --------------------------------------------------------------------------


@pytest.mark.parametrize("threshold", [0.001, 0.005, 0.01])
def test_front_of_a_wedge_is_exact(threshold):
    x = np.linspace(0.0, 1.0, 51)
    assert pile.front_position(x, 0.1 - 0.1 * x, threshold) == pytest.approx(1 - 10 * threshold)


def test_front_ignores_grains_that_have_come_off():
    x, h = np.arange(7.0), np.array([3.0, 2.0, 1.0, 0.0, 0.0, 2.0, 0.0])
    assert pile.front_position(x, h, 0.5) == pytest.approx(2.5)


def test_front_of_a_pile_that_left_the_back_wall():
    x, h = np.arange(7.0), np.array([0.0, 0.6, 0.0, 1.0, 3.0, 2.0, 0.0])
    assert pile.front_position(x, h, 0.5) == pytest.approx(5.75)


def test_front_without_grains_and_without_end():
    x = np.arange(4.0)
    assert pile.front_position(x, np.zeros(4), 0.5) == 0.0
    assert pile.front_position(x, np.ones(4), 0.5) == 3.0


def test_x_99_of_a_uniform_layer():
    x = np.linspace(0.0, 2.0, 21)
    column_volume = np.where(x[:-1] < 0.999, 0.3, 0.0)
    assert pile.x_at_volume(x, column_volume, 0.99) == pytest.approx(0.99)
    assert pile.x_at_volume(x, 0.0 * column_volume, 0.99) == 0.0


def test_detached_volume_of_two_triangles():
    """A triangle of area 1 and, beyond bare ground, one of area 0.25."""
    x = np.linspace(0.0, 4.0, 401)
    h = np.maximum(1.0 - 0.5 * x, 0.0) + np.maximum(0.5 - np.abs(x - 3.0), 0.0)
    assert pile.detached_volume(x, h) == pytest.approx(0.25 / 1.25, rel=1e-3)


def test_detached_volume_of_a_whole_pile_is_the_sliver_beyond_one_millimetre():
    x = np.linspace(0.0, 1.0, 101)
    h = 0.1 * (1.0 - x)
    assert pile.detached_volume(x, h) == pytest.approx((0.001 / 0.1) ** 2, rel=1e-6)
    assert pile.detached_volume(x, 0.0 * h) == 0.0


# -- front velocity and arrest -----------------------------------------------------------------


def test_front_velocity_of_uniform_motion_is_exact_on_uneven_times():
    time = np.cumsum(np.random.default_rng(1).uniform(1e-4, 9e-3, 200))
    velocity = observables.front_velocity(time, 0.3 + 1.7 * time)
    np.testing.assert_allclose(velocity, 1.7, rtol=1e-9)


def test_front_velocity_is_centred():
    """The slope of a parabola over a symmetric window is its derivative in the middle."""
    time = np.linspace(0.0, 0.5, 501)
    velocity = observables.front_velocity(time, time**2)
    middle = (time > 0.025) & (time < 0.475)
    np.testing.assert_allclose(velocity[middle], 2.0 * time[middle], rtol=1e-6)


def test_front_velocity_takes_three_points_when_the_window_holds_fewer():
    time = np.array([0.0, 0.1, 0.3, 0.4])
    np.testing.assert_allclose(observables.front_velocity(time, 2.0 * time), 2.0)


@pytest.mark.parametrize("n", [0, 1])
def test_front_velocity_of_too_few_points_is_zero(n):
    assert observables.front_velocity(np.zeros(n), np.zeros(n)).tolist() == [0.0] * n


def test_arrest_time():
    time, speed = np.arange(6.0), np.array([0.0, 1.0, 1e-4, 0.5, 9e-4, 1e-5])
    assert observables.arrest_time(time, speed) == 4.0
    assert observables.arrest_time(time, speed + 1.0) is None
    assert observables.arrest_time(time, 0.0 * speed) == 0.0


# -- all together ------------------------------------------------------------------------------


def test_row_of_a_column_at_rest():
    """The series of the column behind its gate."""
    case = Case().replace(**{"grid.cell_size": 0.01, "geometry.slope_angle_deg": 0.0})
    row = dict(zip(ROW, Simulation(case).row, strict=True))
    long, top = case.geometry.length_0, case.geometry.height_0
    assert row["max_thickness"] == pytest.approx(top)
    assert row["front_position"] == pytest.approx(long, abs=0.01)
    assert row["x_99"] == pytest.approx(0.99 * long)
    assert row["detached_volume"] == row["relative_volume"] == row["max_speed"] == 0.0
    weight = case.rheology.density_bulk * 9.81 * long * top
    assert row["potential_energy"] == pytest.approx(0.5 * weight * top)
    assert row["negative_pressure_cells"] == 0


def test_row_counts_suction_and_what_has_left():
    simulation = Simulation(Case().replace(**{"grid.cell_size": 0.01}))
    state = simulation.state
    state.u[:] = 1.0
    state.pressure_filled[2, :2] = -5.0
    state.pressure_filled[3, 0] = -1e-9  # round-off is no suction
    state.volume_outflow = 0.1 * state.volume_0
    row = np.empty(len(ROW))
    from_python(fill_row)(row, simulation.flow(), reading_of(simulation.case))
    row = dict(zip(ROW, row, strict=True))
    assert row["negative_pressure_cells"] == 2
    assert row["max_speed"] == 1.0
    assert row["relative_volume"] == pytest.approx(0.1)


def test_ill_posed_share_is_that_of_the_flowing_volume():
    simulation = FakeSimulation(Case().replace(**{"grid.cell_size": 0.01}))
    simulation.state.u[:] = 1.0
    quantities = simulation.cell_quantities()
    quantities["ill_posed"] = np.zeros_like(quantities["ill_posed"])
    quantities["ill_posed"][:, 0] = True
    filled = quantities["filled_fraction"]
    share = pile.ill_posed_share(simulation.state, quantities)
    assert share == pytest.approx(filled[:, 0].sum() / filled.sum())
    simulation.state.u[:] = 0.0
    assert pile.ill_posed_share(simulation.state, quantities) == 0.0
