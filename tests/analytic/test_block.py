"""A rigid block between lateral walls stops at the exact time; no direction is preferred."""

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.geometry import MASS_FLOOR
from fvcollapse.step.lateral_friction import apply_split, face_pressures, sink_coefficients
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

RIGID = {"rheology__mu_1": 0.9, "rheology__mu_2": 0.9}
WALLS = {"geometry__channel_width": 0.10, "effects__lateral_friction": {}}


def block_case(**changes):
    return layer_case(0.005, 0.03, **RIGID, **changes)


@pytest.mark.parametrize("walls", [{}, WALLS])
def test_stops_at_the_exact_time_and_never_reverses(walls):
    case = block_case(**walls)
    stop = -0.2 / exact.block_acceleration(case)
    flow = layer(case, lambda z: 0.2 + 0.0 * z, dt=stop / 50, slip=0.2)
    while flow.state.time < 1.3 * stop:
        flow.advance(10.0)
        expected = exact.block_speed(case, 0.2, flow.state.time)
        assert flow.mean_velocity() == pytest.approx(expected, abs=2e-4)
        assert flow.profile()[1].min() >= 0.0


@pytest.mark.parametrize("scheme", ["implicit", "split"])
def test_plug_between_walls_is_braked_by_the_mean_pressure(scheme):
    """3 cm at 22 deg, w = 10 cm, mu_b = 0.48, u(0) = 1 m/s: 0.527 m/s after 0.4 s."""
    case = block_case(geometry__channel_width=0.10, effects__lateral_friction={"scheme": scheme})
    flow = run_until(layer(case, lambda z: 1.0 + 0.0 * z, dt=2e-3, slip=1.0), 0.4)
    assert flow.mean_velocity() == pytest.approx(exact.block_speed(case, 1.0, 0.4), rel=1e-3)


def test_flow_to_the_left_mirrors_flow_to_the_right():
    flows = []
    for sign in (1.0, -1.0):
        case = block_case(geometry__slope_angle_deg=0.0, **WALLS)
        start = layer(case, lambda z, sign=sign: sign * (0.3 + 10 * z), dt=2e-3, slip=sign * 0.3)
        flows.append(run_until(start, 0.02).profile()[1])
    assert flows[0] == pytest.approx(-flows[1], rel=1e-9)
    assert flows[0].max() > 0.3


def column_sinks(u, w):
    simulation = Simulation(
        Case().replace(**{"grid.cell_size": 0.02, "effects.lateral_friction": {}})
    )
    geometry, state = simulation.geometry, simulation.state
    pressures = np.zeros_like(state.u), np.zeros_like(state.w)
    face_pressures(*pressures, state.pressure_filled, geometry, 1.0, 1.0, simulation.spacing[1])
    u, w = np.full_like(state.u, u), np.full_like(state.w, w)
    sinks = np.zeros_like(u), np.zeros_like(w)
    sink_coefficients(*sinks, u, w, *pressures, geometry, 3.6, 1e-6)
    split = np.zeros_like(u), np.zeros_like(w)
    apply_split(*split, u, w, *pressures, geometry, 1e-6, MASS_FLOOR)
    return geometry, pressures, (u, w), sinks, split


@pytest.mark.parametrize(
    ("u", "w"), [(0.6, 0.8), (-0.6, 0.8), (0.0, 1.0), (1.0, 0.0), (-0.6, -0.8)]
)
def test_sink_acts_along_the_velocity_on_both_components(u, w):
    """The coefficient is (2 mu_w/w) p/|u| on both; the split form shortens both alike."""
    geometry, pressures, _, sinks, split = column_sinks(u, w)
    x, z = (5, 3), (5, 3)
    assert sinks[0][x] == pytest.approx(3.6 * pressures[0][x], rel=1e-9)
    assert sinks[1][z] == pytest.approx(3.6 * pressures[1][z], rel=1e-9)
    loss_x = 1e-6 * pressures[0][x] / geometry.mass_x[x]
    loss_z = 1e-6 * pressures[1][z] / geometry.mass_z[z]
    assert split[0][x] == pytest.approx(u * (1 - loss_x), rel=1e-9, abs=1e-15)
    assert split[1][z] == pytest.approx(w * (1 - loss_z), rel=1e-9, abs=1e-15)


def test_wall_pressures_sum_to_the_volume_integral():
    _, pressures, *_ = column_sinks(1.0, 0.0)
    simulation = Simulation(
        Case().replace(**{"grid.cell_size": 0.02, "effects.lateral_friction": {}})
    )
    filled, total = simulation.state.pressure_filled, simulation.state.pressure_filled.sum()
    geometry, last = simulation.geometry, simulation.gate_column - 1
    held = (filled[last] * geometry.lever_x[last] / geometry.filled[last].clip(1e-8)).sum()
    pressure_x, pressure_z = pressures
    assert pressure_x.sum() + held == pytest.approx(
        total, rel=1e-12
    )  # the closed gate holds its share
    assert pressure_z.sum() == pytest.approx(total, rel=1e-12)
