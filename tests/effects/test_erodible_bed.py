"""An erodible layer: exact at the start, at rest by itself, booked as the domain grows, the zero of all heights."""

import math

import numpy as np
import pytest
from effect_runs import CELL, collapse

from fvcollapse import run
from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError
from fvcollapse.measure.pile import front_position, thickness
from fvcollapse.simulation import Simulation
from fvcollapse.step.initial import initial_grid, initial_level_set

LAYER, LENGTH, HEIGHT = 0.015, 0.20, 0.14


def case_with_layer(**changes):
    return Case().replace(
        **{
            "grid.cell_size": CELL,
            "geometry.slope_angle_deg": 16.0,
            "effects.erodible_bed": {"thickness": LAYER},
            **changes,
        }
    )


def distance_to_segment(x, z, start, end):
    (x_a, z_a), (x_b, z_b) = start, end
    t = ((x - x_a) * (x_b - x_a) + (z - z_a) * (z_b - z_a)) / ((x_b - x_a) ** 2 + (z_b - z_a) ** 2)
    t = np.clip(t, 0.0, 1.0)
    return np.hypot(x - x_a - t * (x_b - x_a), z - z_a - t * (z_b - z_a))


def test_level_set_is_the_distance_to_the_surface_of_column_and_layer():
    case = case_with_layer(**{"grid.cell_size": 0.01})
    grid = initial_grid(case)
    x, z = np.meshgrid(grid.x_nodes, grid.z_nodes, indexing="ij")
    top = HEIGHT + LAYER
    corners = [(-10.0, top), (LENGTH, top), (LENGTH, LAYER), (10.0, LAYER)]
    expected = np.min(
        [distance_to_segment(x, z, *ends) for ends in zip(corners, corners[1:], strict=False)],
        axis=0,
    )
    inside = (z < LAYER) | ((x < LENGTH) & (z < top))
    expected = np.where(inside, -expected, expected)
    assert initial_level_set(case, grid) == pytest.approx(expected, abs=1e-12)


def test_volume_and_heights_at_the_start():
    simulation = Simulation(case_with_layer())
    grid, dz = simulation.grid, simulation.spacing[1]
    length = grid.nx * grid.dx
    expected = HEIGHT * LENGTH + LAYER * length
    # interpolation cuts the foot and the top of the column's front within their cells
    assert simulation.state.volume_0 == pytest.approx(expected, abs=CELL**2)
    h = thickness(simulation.state.level_set, dz) - LAYER
    assert h[:10] == pytest.approx([HEIGHT] * 10, abs=1e-12)
    assert h[12:] == pytest.approx(np.zeros(grid.nx - 11), abs=1e-12)


@pytest.mark.parametrize("slope", [0.0, 16.0, 22.0])
def test_a_layer_rests_but_for_its_creep(slope):
    """Gate closed; away from the column nothing is faster than z gd_min r/sqrt(1 - r^2), r = tan(slope)/mu_1."""
    simulation = collapse(
        0.1,
        gate__speed=0.0,
        geometry__slope_angle_deg=slope,
        effects__erodible_bed={"thickness": LAYER},
    )
    ratio = math.tan(math.radians(slope)) / 0.48
    creep = LAYER * 5e-4 * ratio / math.sqrt(1.0 - ratio**2)
    speed = np.abs(simulation.state.u[simulation.gate_column + 6 :]).max()
    assert speed <= 1.1 * creep + 1e-6  # the foot of the column is felt a little
    assert simulation.state.bed_slip[simulation.gate_column + 6 :].max() == 0.0


@pytest.mark.parametrize("slope", [0.0, 22.0])
def test_volume_and_energy_are_booked_while_the_domain_grows(slope):
    case = case_with_layer(**{"geometry.slope_angle_deg": slope, "effects.lateral_friction": {}})
    simulation = Simulation(case)
    columns, start = simulation.grid.nx, sum(simulation.energies().values())
    dx, dz = simulation.spacing
    while simulation.state.time < 0.5:
        simulation.advance(0.5)
    state = simulation.state
    assert (simulation.grid.nx > columns) == (slope > 0.0)
    volume = simulation.geometry.filled.sum() * dx * dz
    assert volume == pytest.approx(state.volume_0, rel=1e-3)
    spent = (state.work_bulk, state.work_bed, state.work_back_wall, state.work_lateral)
    left = start - sum(simulation.energies().values()) - sum(spent) - state.energy_outflow
    booked = state.loss_time + state.loss_advection + state.loss_surface
    assert left == pytest.approx(booked, abs=1e-4 * sum(spent))


def test_front_and_profiles_are_measured_from_the_surface_of_the_layer():
    result = run(case_with_layer(**{"time.end": 0.2, "time.output_interval": 0.1}))
    assert result.front_position[0] == pytest.approx(LENGTH, abs=CELL)
    assert result.max_thickness[0] == pytest.approx(HEIGHT, abs=1e-9)
    assert result.x_99[0] == pytest.approx(0.99 * LENGTH, abs=CELL)
    assert np.abs(result.relative_volume[result.time > 0.1]).max() < 1e-4
    assert np.abs(result.relative_volume).max() < 0.01  # the foot, while the gate cuts its cell
    h = result.profiles.thickness
    ahead = result.profiles.x > result.runout_1mm[-1] + 3 * CELL
    assert np.abs(h[:, ahead]).max() < 1e-4
    area = np.trapezoid(h, result.profiles.x, axis=1)  # of the pile alone
    assert area == pytest.approx(
        [HEIGHT * LENGTH] * 3, rel=0.08
    )  # the step of the front, in a cell


def runout(layer, slope):
    simulation = collapse(
        0.8, geometry__slope_angle_deg=slope, effects__erodible_bed={"thickness": layer}
    )
    h = thickness(simulation.state.level_set, simulation.spacing[1]) - layer
    return front_position(simulation.grid.x_nodes, h, 0.01)


def test_response():
    """Documented: on a slope any layer shortens the run, at 0 deg by less than a cell.

    The grains slide on the bed of the model with mu_b = mu_1 and must shear on the layer, where the
    friction is mu(I) > mu_1. The thickness itself matters little, and not monotonically.
    """
    level = [runout(layer, 0.0) for layer in (0.0, 0.005, 0.015)]
    assert level == pytest.approx([level[0]] * 3, abs=CELL)
    steep = [runout(layer, 22.0) for layer in (0.0, 0.005, 0.015)]
    assert max(steep[1:]) < steep[0] - 0.5 * CELL


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"effects.erodible_bed": {"thickness": 0.001}}, "effects.erodible_bed.thickness"),
        ({"boundary.right_end": "open"}, "boundary.right_end"),
        ({"boundary.ends": "periodic"}, "boundary.ends"),
        ({"geometry.polygon": [[0, 0], [0.2, 0], [0, 0.14]]}, "geometry.polygon"),
        ({"geometry.slope_angle_deg": 26.0}, "geometry.slope_angle_deg"),
        ({"effects.bed_friction": {"mu_bed": 0.2}}, "geometry.slope_angle_deg"),
    ],
)
def test_refused(changes, key):
    with pytest.raises(CaseError) as caught:
        case_with_layer(**changes)
    assert caught.value.key == key
