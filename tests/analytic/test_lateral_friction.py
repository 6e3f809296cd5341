"""Friction on the lateral walls: a rigid block between them, the split form against the implicit one, closures."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import GRAVITY, case_from_text
from fvcollapse.simulation import Simulation
from fvcollapse.step.geometry import (
    allocate_geometry,
    fill_cells,
    fill_faces,
    fill_reach,
)
from fvcollapse.step.lateral_friction import apply_split, face_pressures, sink_coefficients
from fvcollapse.step.rheology import material
from fvcollapse.step.unknowns import number_unknowns

SPEED, HEIGHT, WIDTH, MU_WALL = 0.3, 0.1, 0.05, 0.18
# Cohesion and viscosity make the layer rigid; the bed is smooth and the ends are periodic: only the
# walls brake it.
BLOCK = """
[geometry]
slope_angle_deg = {slope}
height_0 = 0.1
length_0 = 0.06
channel_width = 0.05
[grid]
cell_size = 0.01
[rheology]
law = "bingham"
cohesion = 1e5
viscosity = 1e4
[boundary]
mu_bed = 0
ends = "periodic"
[time]
step_max = {step}
[effects.lateral_friction]
mu_wall = 0.18
scheme = "{scheme}"
"""
COLUMN = """
[geometry]
slope_angle_deg = {slope}
channel_width = {width}
[grid]
cell_size = 0.014
[gate]
speed = {gate_speed}
{walls}
"""


def slide(slope, scheme, step=1e-3):
    """Simulation, times, mean speeds and lowest speed of the block over twice its stopping time; its deceleration."""
    simulation = Simulation(case_from_text(BLOCK.format(slope=slope, scheme=scheme, step=step)))
    simulation.state.u[:] = simulation.state.bed_slip[:] = SPEED
    angle = math.radians(slope)
    # depth-averaged: p = rho g cos(slope) (H - z), hence the mean of 2 mu_w p / (rho w)
    deceleration = MU_WALL * GRAVITY * math.cos(angle) * HEIGHT / WIDTH - GRAVITY * math.sin(angle)
    end = 2.0 * SPEED / deceleration
    times, speeds = [], []
    while simulation.state.time < end:
        simulation.advance(end)
        times.append(simulation.state.time)
        speeds.append(simulation.state.u[13, :10])
    return simulation, np.array(times), np.array(speeds), deceleration


@pytest.mark.parametrize("scheme", ["implicit", "split"])
@pytest.mark.parametrize("slope", [0.0, 5.0])
def test_block_stops_at_the_exact_time_and_never_reverses(slope, scheme):
    _, times, speeds, deceleration = slide(slope, scheme)
    exact = np.maximum(SPEED - deceleration * times, 0.0)
    assert speeds.mean(axis=1) == pytest.approx(
        exact, abs=1e-3
    )  # split: first order, 7e-4 m/s at 1 ms
    assert speeds.min() > -1e-14
    assert (
        speeds[-1].max() < 1e-4
    )  # split: the top, where demand exceeds capacity, creeps by 6e-5 m/s at 1 ms


def test_split_block_follows_the_implicit_one():
    """While it moves the two differ by the nonlinear tolerance only: the pressure is constant."""
    _, times, split, _ = slide(0.0, "split")
    simulation, _, implicit, deceleration = slide(0.0, "implicit")
    moving = times < 0.9 * SPEED / deceleration
    assert abs(split - implicit)[moving].max() < simulation.case.numerics.tolerance * SPEED


def test_stuck_block_creeps_as_regularised():
    """Implicit: speed = slip_min s / sqrt(1 - s^2), s = demand / capacity, once arrested on a slope."""
    simulation, _, speeds, _ = slide(5.0, "implicit")
    s = math.tan(math.radians(5.0)) * WIDTH / (MU_WALL * HEIGHT)
    slip_min = 0.1 * simulation.case.numerics.shear_rate_min * HEIGHT
    assert speeds[-1].mean() == pytest.approx(slip_min * s / math.sqrt(1.0 - s * s), rel=0.05)


@pytest.mark.parametrize("scheme", ["implicit", "split"])
def test_column_behind_the_gate_stays_at_rest(scheme):
    walls = f'[effects.lateral_friction]\nscheme = "{scheme}"'
    simulation = Simulation(
        case_from_text(COLUMN.format(slope=0, width=0.1, gate_speed=0, walls=walls))
    )
    pressure = simulation.state.pressure_filled.copy()
    for _ in range(30):
        simulation.advance(1.0)
    assert simulation.max_speed() < 1e-8
    assert simulation.state.pressure_filled == pytest.approx(pressure, abs=1e-5 * pressure.max())


# ---------------------------------------------------------------- the kernels


def uniform_flow(direction, nx=8, nz=6):
    """A full domain moving at SPEED in `direction` (rad) under 1000 Pa."""
    geometry = allocate_geometry(nx, nz)
    fill_cells(
        geometry.filled,
        geometry.lever_x,
        geometry.lever_z,
        np.full((nx + 1, nz + 1), -1.0),
        geometry.aperture,
    )
    fill_faces(
        geometry.mass_x,
        geometry.mass_z,
        geometry.filled,
        geometry.lever_x,
        geometry.lever_z,
        geometry.packing,
    )
    fill_reach(geometry.reach, geometry.filled)
    number_unknowns(geometry, open_end=False)
    u = np.full((nx + 1, nz), SPEED * math.cos(direction))
    w = np.full((nx, nz + 1), SPEED * math.sin(direction))
    p_x, p_z = np.empty_like(u), np.empty_like(w)
    face_pressures(p_x, p_z, np.full((nx, nz), 1000.0), geometry, 1.0, 1.0, 1.0)
    return geometry, u, w, p_x, p_z


@pytest.mark.parametrize("direction", np.radians([0.0, 30.0, 90.0, 200.0, 315.0]))
def test_friction_opposes_the_velocity_and_does_not_depend_on_its_direction(direction):
    """Both components: force = 2 mu_w p / w, opposite to (u, w); the split form takes dt force / rho off |u|."""
    geometry, u, w, p_x, p_z = uniform_flow(direction)
    strength, inner = 2.0 * MU_WALL / WIDTH, (4, 3)
    sink_x, sink_z = np.zeros_like(u), np.zeros_like(w)
    sink_coefficients(sink_x, sink_z, u, w, p_x, p_z, geometry, strength, 0.0)
    force = np.array([sink_x[inner] * u[inner], sink_z[inner] * w[inner]])
    along = np.array([math.cos(direction), math.sin(direction)])
    assert force == pytest.approx(strength * 1000.0 * along, rel=1e-12, abs=1e-9)

    u_new, w_new = np.empty_like(u), np.empty_like(w)
    impulse = 0.1 * SPEED / 1000.0
    apply_split(u_new, w_new, u, w, p_x, p_z, geometry, impulse, 1e-4)
    assert np.array([u_new[inner], w_new[inner]]) == pytest.approx(
        0.9 * SPEED * along, rel=1e-12, abs=1e-15
    )


def test_split_stops_exactly_without_reversal():
    geometry, u, w, p_x, p_z = uniform_flow(0.5)
    impulse = 0.3 * SPEED / 1000.0  # stops within the fourth application
    inner = np.s_[2:-2, 2:-2]  # the faces on the walls are no unknowns and keep their velocity
    for _ in range(4):
        before = np.hypot(u[4, 3], w[4, 3])
        u_new, w_new = np.empty_like(u), np.empty_like(w)
        apply_split(u_new, w_new, u, w, p_x, p_z, geometry, impulse, 1e-4)
        u[inner], w[inner] = (
            u_new[4, 3],
            w_new[4, 3],
        )  # uniform flow, without the influence of the ends
        assert 0.0 <= np.hypot(u[4, 3], w[4, 3]) < before
    assert u[4, 3] == 0.0
    assert w[4, 3] == 0.0


# ---------------------------------------------------------------- switches


def test_friction_increase_changes_mu_1_and_mu_2_only():
    """Equation 21: mu_1, mu_2 += mu_wall flowing_thickness / channel_width, and no sink."""
    walls = '[effects.lateral_friction]\nclosure = "friction_increase"\nmu_wall = 0.2\nflowing_thickness = 0.03'
    without = case_from_text(COLUMN.format(slope=22, width=0.1, gate_speed="inf", walls=""))
    with_walls = case_from_text(COLUMN.format(slope=22, width=0.1, gate_speed="inf", walls=walls))
    a, b = material(without), material(with_walls)
    assert b.mu_1 - a.mu_1 == pytest.approx(0.06)
    assert b.mu_2 - a.mu_2 == pytest.approx(0.06)
    assert b._replace(mu_1=a.mu_1, mu_2=a.mu_2) == a
    simulation = Simulation(with_walls)
    simulation.advance(1.0)
    assert not simulation.work.sink_x.any()
    assert not simulation.work.sink_z.any()


@pytest.mark.parametrize("closure", ["sink", "friction_increase"])
def test_infinite_channel_is_bit_identical_to_no_walls(closure):
    states = []
    for walls in ("", f'[effects.lateral_friction]\nclosure = "{closure}"'):
        simulation = Simulation(
            case_from_text(COLUMN.format(slope=22, width="inf", gate_speed="inf", walls=walls))
        )
        for _ in range(20):
            simulation.advance(1.0)
        states.append(simulation.state)
    for name in ("level_set", "u", "w", "pressure_filled", "bed_slip"):
        assert np.array_equal(getattr(states[0], name), getattr(states[1], name))
