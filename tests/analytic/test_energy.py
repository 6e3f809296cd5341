"""The energy budget: exact for a block and a steady flow, closed by its own terms in a collapse."""

import math

import numpy as np
import pytest

from fvcollapse.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.initial import HALO
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

DEPTH = 0.02


def mass_per_length(case):
    return case.rheology.density_bulk * DEPTH


def test_a_block_spends_its_work_on_the_bed():
    case = layer_case(
        DEPTH / 8, DEPTH, geometry__slope_angle_deg=22.0, rheology__mu_1=0.9, rheology__mu_2=0.9
    )
    flow = layer(case, lambda z: 0.2 + 0.0 * z, dt=1e-3, slip=0.2)
    run_until(flow, 0.05)
    length = case.grid.cell_size
    travelled = 1e-3 * sum(exact.block_speed(case, 0.2, 1e-3 * step) for step in range(1, 51))
    pressure = mass_per_length(case) * exact.gravity_normal(case)
    expected = 0.48 * pressure * travelled * length
    assert flow.state.work_bed == pytest.approx(expected, rel=1e-4)
    assert flow.state.work_bulk < 1e-4 * expected
    assert flow.state.work_lateral == flow.state.work_back_wall == 0.0


def test_a_block_between_walls_spends_the_rest_on_them():
    case = layer_case(
        DEPTH / 8,
        DEPTH,
        geometry__slope_angle_deg=22.0,
        geometry__channel_width=0.1,
        effects__lateral_friction={},
        rheology__mu_1=0.9,
        rheology__mu_2=0.9,
    )
    flow = layer(case, lambda z: 0.2 + 0.0 * z, dt=1e-3, slip=0.2)
    run_until(flow, 0.03)
    ratio = 2.0 * 0.18 / 0.1 * 0.5 * DEPTH / 0.48  # of the two tractions, mean pressure p/2
    assert flow.state.work_lateral / flow.state.work_bed == pytest.approx(ratio, rel=1e-3)


def test_a_steady_flow_spends_the_work_of_gravity_inside():
    case = layer_case(
        DEPTH / 16,
        DEPTH,
        geometry__slope_angle_deg=24.0,
        boundary__mu_bed=math.inf,
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
    )
    flow = layer(case, lambda z: exact.bagnold(case, z), dt=1.0)
    run_until(flow, 20.0)
    before = flow.state.work_bulk
    run_until(flow, 30.0)
    u = flow.state.u[HALO, :16]
    length = case.grid.cell_size
    gravity = mass_per_length(case) * flow.gravity[0] * u.mean() * length
    assert (flow.state.work_bulk - before) / 10.0 == pytest.approx(gravity, rel=1e-5)
    assert flow.state.work_bed == 0.0


OPEN_END = {"boundary.right_end": "open", "boundary.domain_length": 0.32}


@pytest.mark.parametrize(
    ("scheme", "changes"), [("implicit", {}), ("split", {}), ("implicit", OPEN_END)]
)
def test_the_budget_of_a_collapse_is_closed_by_its_own_terms(scheme, changes):
    case = Case().replace(
        **{
            "grid.cell_size": 0.02,
            "geometry.channel_width": 0.1,
            "effects.lateral_friction": {"scheme": scheme},
            **changes,
        }
    )
    simulation = Simulation(case)
    start = sum(simulation.energies().values())
    works = []
    while simulation.state.time < 0.5:
        simulation.advance(0.5)
        state = simulation.state
        works.append([state.work_bulk, state.work_bed, state.work_back_wall, state.work_lateral])
    spent = works[-1]
    missing = start - sum(simulation.energies().values()) - sum(spent) - state.energy_outflow
    assert (state.volume_outflow > 0.0) == bool(changes)
    booked = state.loss_time + state.loss_advection + state.loss_surface
    assert missing == pytest.approx(booked, abs=2e-5 * sum(spent))
    assert min(spent) > 0.0
    if scheme == "implicit":  # the split friction of one step may come to work in the next
        assert (np.diff(works, axis=0) >= -1e-12).all()
