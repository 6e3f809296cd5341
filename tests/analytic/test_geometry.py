"""Cut cells: area, lever rule and face masses are exact for planes; gravity is balanced."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.geometry import cell_fractions, polygon_moments
from fvcollapse.verification.problems.surface import bed_pressures


@given(st.floats(-0.9, 0.9), st.floats(0.01, 0.99))
def test_moments_of_a_plane(tilt, height):
    """Below z = height + tilt (x - 1/2), where the plane meets both sides of the cell."""
    left, right = height - tilt / 2, height + tilt / 2
    if not (0 < left < 1 and 0 < right < 1):
        return
    area, moment_x, moment_z = polygon_moments(-left, -right, 1 - right, 1 - left)
    assert area == pytest.approx(height, abs=1e-14)
    assert moment_x == pytest.approx(height / 2 + tilt / 12, abs=1e-14)
    assert moment_z == pytest.approx((height**2 + tilt**2 / 12) / 2, abs=1e-14)


@given(st.floats(0.01, 0.99), st.floats(0.01, 0.99))
def test_moments_of_a_corner(a, b):
    """The triangle with legs a and b in the lower left corner."""
    area, moment_x, moment_z = polygon_moments(-1.0, 1 / a - 1, 1 / a + 1 / b - 1, 1 / b - 1)
    assert area == pytest.approx(a * b / 2, rel=1e-12)
    assert moment_x == pytest.approx(a**2 * b / 6, rel=1e-12)
    assert moment_z == pytest.approx(a * b**2 / 6, rel=1e-12)


@given(st.tuples(*[st.floats(-1, 1)] * 4))
def test_inside_and_outside_fill_the_cell(corners):
    corners = [corner if abs(corner) > 1e-6 else 1e-6 for corner in corners]
    inside = polygon_moments(*corners)
    outside = polygon_moments(*(-corner for corner in corners))
    assert 0.0 <= inside[0] <= 1.0
    assert inside[0] + outside[0] == pytest.approx(1.0, abs=1e-12)
    assert inside[1] + outside[1] == pytest.approx(0.5, abs=1e-12)
    assert inside[2] + outside[2] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize("shift", range(4))
@pytest.mark.parametrize("corners", [(-1.0, 0.2, 0.0, 0.3), (-1.0, -0.2, 0.0, 0.3)])
def test_area_does_not_jump_where_a_corner_gets_wet(corners, shift):
    """A dry corner of value 0 beside two dry ones stays a corner of no area when it becomes wet."""
    dry, wet = ([*corners], [*corners])
    dry[2], wet[2] = 1e-9, -1e-9
    areas = [polygon_moments(*np.roll(values, shift))[0] for values in (dry, wet)]
    assert areas[0] == pytest.approx(areas[1], abs=1e-5)


def test_area_of_a_disc_converges_at_second_order():
    errors = []
    for cells in (16, 32, 64):
        x, z = np.meshgrid(*[np.arange(cells + 1) / cells] * 2, indexing="ij")
        filled = cell_fractions(np.hypot(x - 0.51, z - 0.48) - 0.3)
        errors.append(abs(filled.sum() / cells**2 / (math.pi * 0.09) - 1))
    assert errors[2] < errors[0] / 12
    assert errors[2] < 1e-3


def box(**changes):
    keys = {"grid.cell_size": 0.01, "geometry.channel_width": math.inf, "gate.speed": 0.0}
    keys.update({name.replace("__", "."): value for name, value in changes.items()})
    return Simulation(Case().replace(**keys))


@pytest.mark.parametrize("slope", [0.0, 7.0, 22.0, 30.0])
def test_face_masses_sum_to_the_volume(slope):
    simulation = box(geometry__surface="horizontal", geometry__slope_angle_deg=slope)
    geometry, (dx, dz) = simulation.geometry, simulation.spacing
    held = geometry.lever_x[simulation.gate_column - 1].sum()  # by the closed gate
    assert geometry.mass_x.sum() + held == pytest.approx(geometry.filled.sum(), rel=1e-14)
    assert geometry.mass_z.sum() == pytest.approx(geometry.filled.sum(), rel=1e-14)
    assert geometry.filled.sum() * dx * dz == pytest.approx(0.14 * 0.20, rel=1e-12)
    moment = (np.arange(geometry.filled.shape[1] + 1) * geometry.mass_z).sum() * dx * dz**2
    variance = (0.20 * math.tan(math.radians(slope))) ** 2 / 12
    assert moment == pytest.approx(0.20 * (0.14**2 + variance) / 2, rel=1e-12)


@pytest.mark.parametrize("slope", [0.0, 7.0, 22.0, 30.0])
@pytest.mark.parametrize("cell_size_z", [0.01, 0.007])
def test_level_surface_is_balanced_at_any_angle(slope, cell_size_z):
    simulation = box(
        geometry__surface="horizontal",
        geometry__slope_angle_deg=slope,
        grid__cell_size_z=cell_size_z,
    )
    pressure, expected = bed_pressures(simulation)
    assert pressure == pytest.approx(expected, rel=1e-6)
    for _ in range(3):
        simulation.advance(1.0)
    assert simulation.max_speed() < 1e-12


@pytest.mark.parametrize("height", [0.15, 0.146, 0.1401])
def test_surface_between_grid_lines(height):
    simulation = box(geometry__height_0=height, geometry__slope_angle_deg=0.0)
    pressure, expected = bed_pressures(simulation)
    assert pressure == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("size", [0.02, 0.014, 0.01, 0.007, 0.005, 0.004])
def test_a_column_whose_corner_falls_on_a_node_is_whole(size):
    """h0 = 0.14 m and l0 = 0.20 m are multiples of these: no half cell is missing at the corner."""
    state = Simulation(Case().replace(**{"grid.cell_size": size})).state
    assert state.volume_0 == pytest.approx(0.14 * 0.20, rel=1e-7)


def test_a_wall_that_grains_reach_later_stays_bare():
    """A known limit: a block that spreads against the back wall leaves half a cell there, and feels no friction."""
    block = [[0.06, 0.0], [0.26, 0.0], [0.26, 0.14], [0.06, 0.14]]
    simulation = Simulation(
        Case().replace(
            **{
                "geometry.polygon": block,
                "geometry.slope_angle_deg": 0.0,
                "gate.speed": math.inf,
                "grid.cell_size": 0.01,
            }
        )
    )
    while simulation.state.time < 0.3 - 1e-9:
        simulation.advance(0.3)
    first, second = simulation.geometry.filled[:2].sum(axis=1) * 0.01
    assert second == pytest.approx(0.075, abs=0.003)
    assert first == pytest.approx(0.5 * second, rel=0.02)
    assert not simulation.geometry.wall_cover.any()
    assert simulation.state.work_back_wall == 0.0
