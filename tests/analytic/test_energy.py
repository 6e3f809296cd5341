"""The energy budget: exact for a block and a steady flow, closed by its own terms in a collapse."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.dilatancy import dilation_power
from fvcollapse.step.initial import HALO
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

DEPTH = 0.02
CHUTE = {
    "geometry__slope_angle_deg": 24.0,
    "boundary__mu_bed": math.inf,
    "rheology__mu_1": 0.38,
    "rheology__mu_2": 0.64,
}


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
        **CHUTE,
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
WALL = OPEN_END | {"boundary.right_end": "wall"}
DENSE, CRITICAL, LOOSE = (
    {"effects.dilatancy": {"dilatancy_factor": 4.0, "solid_fraction_0": nu}}
    for nu in (0.64, 0.60, 0.56)
)


@pytest.mark.parametrize(
    ("scheme", "changes"),
    [
        ("implicit", {}),
        ("split", {}),
        ("implicit", OPEN_END),
        ("implicit", WALL),
        ("implicit", DENSE),
        ("implicit", CRITICAL),
        ("implicit", LOOSE),
        ("implicit", DENSE | OPEN_END),
        ("implicit", {"effects.thin_layer": {"length": 10.0}}),
        ("implicit", {"effects.thin_layer": {"length": 10.0, "closure": "nonlocal"}}),
    ],
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
    assert (state.volume_outflow > 0.0) == (case.boundary.right_end == "open")
    booked = state.loss_time + state.loss_advection + state.loss_surface
    assert missing == pytest.approx(booked, abs=2e-5 * sum(spent))
    assert min(spent) > 0.0
    if scheme == "implicit":  # the split friction of one step may come to work in the next
        # below the regularised shear rate, in the first ten steps, friction pays less than dilatancy takes
        least = -1e-7 if "effects.dilatancy" in changes else -1e-12
        assert (np.diff(works, axis=0) >= least).all()


def swollen(excess):
    """A sheared layer after 0.3 s, from grains denser by `excess` than the solid fraction they tend to.

    Returns
    -------
    pressure_work, lifted : float
        Work of the pressure in dilating, gain of potential energy of the whole stretch, J/m.
    flow : UniformFlow
    """
    case = layer_case(
        DEPTH / 8,
        DEPTH,
        **CHUTE,
        effects__dilatancy={
            "dilatancy_factor": 4.0,
            "solid_fraction_0": 0.62,
            "solid_fraction_critical": 0.62 - excess,
            "solid_fraction_slope": 0.0,
        },
        numerics__tolerance=1e-7,
        numerics__max_sweeps=100,
    )
    flow = layer(case, lambda z: exact.bagnold(case, z), dt=2e-3)
    before, work = flow.energies()["potential"], 0.0
    while flow.state.time < 0.3 - 1e-12:
        flow.advance(0.3)
        power = dilation_power(flow.work.response.source, flow.state.pressure_filled, flow.geometry)
        work += flow.state.dt * power * math.prod(flow.spacing)
    columns = flow.geometry.filled.shape[0]  # of one and the same column, the halo included
    return work, (flow.energies()["potential"] - before) / columns, flow


def test_the_pressure_lifts_the_grains_that_dilate():
    """Both are m g cos a dH/2; the suddenness of the start adds to the work in proportion to the excess."""
    ratios = []
    for excess in (0.002, -0.002):
        work, lifted, flow = swollen(excess)
        weight = mass_per_length(flow.case) * exact.gravity_normal(flow.case)
        growth = DEPTH * (0.62 / (0.62 - excess) - 1.0)
        exactly = 0.5 * weight * growth * flow.case.grid.cell_size
        assert lifted == pytest.approx(exactly, rel=1e-3)  # 1e-4
        ratios.append(work / lifted)
    assert ratios == pytest.approx([1.0, 1.0], abs=0.03)  # 1.8e-2, 6.9e-2 at four times the excess
    assert np.mean(ratios) == pytest.approx(1.0, abs=1e-3)  # 1e-4
