"""The gate: its law of motion, and the Coulomb friction with which it drags the grains behind it upwards."""

import math

import numpy as np
import pytest
from effect_runs import CELL, centre_of_mass, collapse

from fvcollapse.case.case import Case
from fvcollapse.measure.pile import front_position, thickness
from fvcollapse.simulation import Simulation
from fvcollapse.step.coulomb_walls import bed_reaction
from fvcollapse.step.gate import Lift, gate_height, gate_reaction, gate_velocity
from fvcollapse.step.time_step import time_to_rise


@pytest.mark.parametrize(
    "lift", [Lift(0.7, 0.13, 0.0, 0.0), Lift(2.3, 0.0, 0.05, 0.0), Lift(1.0, 0.02, 0.1, 0.0)]
)
def test_height_is_the_integral_of_the_velocity(lift):
    time = np.linspace(0.0, 0.4, 4001)
    velocity = np.array([gate_velocity(t, lift) for t in time])
    height = np.array([gate_height(t, lift) for t in time])
    path = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
    assert height == pytest.approx(
        path, abs=2e-4 * height[-1]
    )  # a jump of the speed in one interval
    assert height[time < lift.delay - 1e-9].max(initial=0.0) == 0.0


def test_gate_that_vanishes_stays_closed_until_then():
    lift = Lift(math.inf, 0.0, 0.1, 0.0)
    assert gate_height(0.09, lift) == 0.0
    assert gate_height(0.11, lift) == math.inf
    assert gate_velocity(0.11, lift) == 0.0


# -- the time step -----------------------------------------------------------------------------


def gate_run(end, **gate):
    """Times of the steps of a collapse at 16 deg, and its `Lift`."""
    simulation = collapse(0.0, gate__speed=gate.pop("speed"), effects__gate=gate)
    times = [0.0]
    while times[-1] < end - 1e-12:
        simulation.advance(end)
        times.append(simulation.state.time)
    return np.array(times), simulation.lift


LAWS = [
    Lift(2.3, 0.0, 0.0, 0.0),
    Lift(10.0, 0.0, 0.03, 0.0),
    Lift(30.0, 0.1, 0.0, 0.01),
    Lift(500.0, 0.02, 0.05, 0.0),
    Lift(1e6, 1000.0, 0.0, 0.0),
]


@pytest.mark.parametrize("lift", LAWS)
def test_time_to_rise_inverts_the_law_of_motion(lift):
    for time in (0.0, 0.02, 0.0499999, 0.05, 0.2):
        for rise in (1e-5, 1e-3, 0.1):
            later = time + time_to_rise(rise, lift, time)
            risen = gate_height(later, lift) - gate_height(time, lift)
            assert risen == pytest.approx(rise, rel=1e-6)


@pytest.mark.parametrize(
    "gate",
    [
        {"speed": 30.0},
        {"speed": 30.0, "delay": 0.02},
        {"speed": 30.0, "delay": 0.0173},
        {"speed": 30.0, "time_constant": 0.05},
        {"speed": 1e6, "time_constant": 1000.0},
    ],
    ids=str,
)
def test_the_gate_uncovers_a_quarter_of_a_cell_per_step_at_most(gate):
    times, lift = gate_run(0.08, **gate)
    heights = np.array([gate_height(time, lift) for time in times])
    inside = heights[:-1] < 0.3  # the grid is 0.14 m and eight cells high
    assert np.diff(heights)[inside].max() <= 0.25 * CELL * (1.0 + 1e-6)
    assert len(times) < 250  # a quarter of a cell each is 60 steps; then they grow again


@pytest.mark.parametrize("delay", [0.0, 0.02, 0.0173])
def test_a_gate_that_passes_within_a_step_is_as_fast_to_compute_as_none(delay):
    fast, _ = gate_run(0.1, speed=1e6, delay=delay)
    gone, _ = gate_run(0.1, speed=math.inf, delay=delay)
    assert len(fast) == len(gone)


# -- friction ----------------------------------------------------------------------------------


def pulled(mu_gate, speed):
    """Forces (N/m) on a column at rest whose gate is pulled so slowly that it stays closed."""
    simulation = collapse(
        0.01,
        geometry__slope_angle_deg=22.0,
        effects__gate={"speed": speed, "mu_gate": mu_gate},
        numerics__tolerance=1e-6,  # the reaction is that of the sweep before the last one
    )
    geometry, state, work = simulation.geometry, simulation.state, simulation.work
    (dx, dz), (gx, gz) = simulation.spacing, simulation.gravity
    column = simulation.gate_column
    stress = state.pressure_filled, work.weight_centre, work.e_centre, geometry
    wet = geometry.index_w[column - 1] >= 0
    rising = np.where(wet, speed - state.w[column - 1], 0.0)
    pushed = [gate_reaction(*stress, column, k, gx, 1550.0, dx) for k in range(7)]
    return {
        "drag": dz * (work.k_gate @ rising),
        # the half cell at the bed hands its share of the friction to the bed itself
        "push": dz * (sum(pushed) - 0.5 * pushed[0]),
        "bed": dx * sum(bed_reaction(*stress, i, gz, 1550.0, dz) for i in range(column)),
        "back_wall": -dz * (work.k_wall @ state.w[0]),
        # what `side_shear` adds at the back wall and the gate, which carry it beside their friction
        "side": dx * dz * work.side.sum(),
        "weight": -1550.0 * gz * geometry.filled.sum() * dx * dz,
    }


@pytest.mark.parametrize("speed", [1e-3, 1e-2])
@pytest.mark.parametrize("mu_gate", [0.0, 0.1, 0.3])
def test_a_gate_pulled_past_the_grains_carries_its_friction_of_their_weight(mu_gate, speed):
    """It slips, so its drag is mu_gate times the push of the grains; the bed carries the rest."""
    force = pulled(mu_gate, speed)
    assert force["push"] > 0.3 * force["weight"]
    assert force["drag"] == pytest.approx(mu_gate * force["push"], rel=1e-3)  # of the sweeps
    carried = force["bed"] + force["drag"] + force["back_wall"] + force["side"]
    assert carried == pytest.approx(force["weight"], rel=1e-4)
    assert abs(force["side"]) < 6e-4 * force["weight"]  # a limit of `side_shear` at walls


def test_the_energy_budget_is_closed_with_a_rubbing_gate():
    case = Case().replace(
        **{
            "grid.cell_size": 0.02,
            "effects.gate": {"mu_gate": 0.3, "speed": 0.7, "time_constant": 0.1},
            "effects.lateral_friction": {},
        }
    )
    simulation = Simulation(case)
    start = sum(simulation.energies().values())
    while simulation.state.time < 0.5:
        simulation.advance(0.5)
    state = simulation.state
    spent = (state.work_bulk, state.work_bed, state.work_back_wall, state.work_lateral)
    left = start - sum(simulation.energies().values()) - sum(spent) - state.work_gate
    booked = state.loss_time + state.loss_advection + state.loss_surface
    assert left == pytest.approx(booked, abs=2e-5 * sum(spent))
    assert abs(state.work_gate) > 1e-3 * sum(spent)


# -- what it does to a collapse ----------------------------------------------------------------


def reached(**effect):
    return centre_of_mass(collapse(0.2, effects__gate=effect))


def test_the_slower_the_gate_the_later_the_grains():
    slower = [reached(speed=speed) for speed in (math.inf, 2.3, 0.7, 0.3)]
    assert all(far > near + 1e-4 for far, near in zip(slower, slower[1:], strict=False))
    later = [reached(speed=0.7, time_constant=tau) for tau in (0.0, 0.06, 0.13)]
    assert all(far > near + 1e-4 for far, near in zip(later, later[1:], strict=False))


def test_a_rubbing_gate_draws_the_surface_up_and_holds_the_front_back():
    """Documented: at mu_gate up to 0.3 the centre of mass moves by less than 1 %, either way."""
    slow = {"speed": 0.7, "time_constant": 0.13}
    runs = [collapse(0.2, effects__gate={**slow, "mu_gate": mu}) for mu in (0.0, 0.15, 0.3, 1.0)]
    beside = [run.geometry.filled[run.gate_column - 1].sum() for run in runs]
    assert all(low < high - 1e-3 for low, high in zip(beside, beside[1:], strict=False))
    fronts = [
        front_position(run.grid.x_nodes, thickness(run.state.level_set, CELL), 0.005)
        for run in runs
    ]
    assert all(far > near + 1e-4 for far, near in zip(fronts, fronts[1:], strict=False))
    centres = [centre_of_mass(run) for run in runs]
    assert centres[:3] == pytest.approx([centres[0]] * 3, rel=0.01)


def test_a_delay_shifts_the_collapse_in_time():
    """Up to the sequence of the time steps; the column meanwhile stands."""
    late = collapse(0.30, effects__gate={"delay": 0.1})
    assert centre_of_mass(late) == pytest.approx(centre_of_mass(collapse(0.2)), abs=2e-4)
    assert reached(delay=0.2) == pytest.approx(0.1, abs=1e-4)
