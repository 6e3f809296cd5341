"""What must not move does not, and its forces balance."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.coulomb_walls import back_wall_reaction, bed_reaction
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until
from fvcollapse.verification.problems.surface import bed_pressures

WIDTHS = pytest.mark.parametrize("width", [0.10, math.inf])


def column_behind_gate(width, **changes):
    keys = {
        "grid.cell_size": 0.01,
        "geometry.channel_width": width,
        "gate.speed": 0.0,
        "effects.lateral_friction": {},
    }
    keys.update({name.replace("__", "."): value for name, value in changes.items()})
    simulation = Simulation(Case().replace(**keys))
    fastest = 0.0
    while simulation.state.time < 0.5:
        simulation.advance(0.5)
        fastest = max(fastest, simulation.max_speed())
    return simulation, fastest


@WIDTHS
@pytest.mark.parametrize(("slope", "surface"), [(0.0, "parallel"), (22.0, "horizontal")])
def test_level_surface_stays_at_rest(width, slope, surface):
    simulation, fastest = column_behind_gate(
        width, geometry__slope_angle_deg=slope, geometry__surface=surface
    )
    pressure, expected = bed_pressures(simulation)
    assert fastest < 1e-8
    assert pressure == pytest.approx(expected, rel=1e-3)


@WIDTHS
def test_inclined_column_creeps_below_the_bound_and_its_forces_balance(width):
    simulation, fastest = column_behind_gate(width)
    assert fastest <= exact.creep(simulation.case, 0.14)
    weight, forces_x, forces_z = forces(simulation)
    assert abs(sum(forces_x.values())) < 1e-3 * weight, forces_x
    assert abs(sum(forces_z.values())) < 1e-3 * weight, forces_z


def forces(simulation):
    """(weight, forces on the grains along x, along z), N/m, from the discrete reactions."""
    state, geometry, work = simulation.state, simulation.geometry, simulation.work
    (dx, dz), (gx, gz), gate = simulation.spacing, simulation.gravity, simulation.gate_column
    density = simulation.case.rheology.density_bulk
    arguments = state.pressure_filled, work.weight_centre, work.e_centre, geometry
    nx, nz = geometry.filled.shape
    bed = sum(bed_reaction(*arguments, i, gz, density, dz) for i in range(nx))
    back = sum(back_wall_reaction(*arguments, k, gx, density, dx) for k in range(nz))
    stress = state.pressure_filled - 2 * work.weight_centre * work.e_centre
    carried = density * gx * dx * geometry.lever_x
    closed = 1 - geometry.aperture[gate]
    gate_force = (closed * (stress + carried)[gate - 1]).sum()
    known_u, known_w = geometry.index_u >= 0, geometry.index_w >= 0
    mass = density * dx * dz * geometry.filled.sum()
    forces_x = {
        "weight": gx * mass,
        "back wall": back * dz,
        "gate": -gate_force * dz,
        "bed": -(work.k_bed * state.u[:, 0] * known_u[:, 0]).sum() * dx,
        "lateral walls": -(work.sink_x * state.u * known_u).sum() * dx * dz,
    }
    forces_z = {
        "weight": gz * mass,
        "bed": bed * dx,
        "back wall": -(work.k_wall * state.w[0] * known_w[0]).sum() * dz,
        "lateral walls": -(work.sink_z * state.w * known_w).sum() * dx * dz,
    }
    return mass * 9.81, forces_x, forces_z


@pytest.mark.parametrize("law", ["mu_I", "drucker_prager"])
def test_layer_below_yield_creeps_below_the_bound(law):
    """0.14 m at 0.9 arctan(mu_1), every setting the default: at most 0.2 mm/s."""
    slope = 0.9 * math.degrees(math.atan(0.48))
    case = layer_case(
        0.0175,
        0.14,
        geometry__slope_angle_deg=slope,
        rheology__law=law,
        numerics__tolerance=1e-3,
        numerics__max_sweeps=30,
    )
    flow = run_until(layer(case, np.zeros_like, dt=1e-3), 0.5)
    assert 0.0 < flow.surface_velocity() <= min(exact.creep(case, 0.14), 2e-4)


def test_creep_is_the_formula_to_2_percent():
    slope = 0.9 * math.degrees(math.atan(0.48))
    case = layer_case(
        0.0175,
        0.14,
        geometry__slope_angle_deg=slope,
        rheology__law="drucker_prager",
        rheology__viscosity=0.0,
    )
    flow = run_until(layer(case, np.zeros_like, dt=0.05), 1.0)
    z, u = flow.profile()
    assert u == pytest.approx(exact.creep(case, z), rel=0.02)
