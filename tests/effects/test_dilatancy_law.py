"""The law of dilatancy: the solid fraction relaxes in strain, and a layer steadies to the local law."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from effect_runs import volume_change

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step import level_set
from fvcollapse.step.compiled import from_python
from fvcollapse.step.dilatancy import Dilatancy, carry, expansion, limit
from fvcollapse.step.domain import allocate
from fvcollapse.step.geometry import cell_fractions
from fvcollapse.step.state import State
from fvcollapse.verification import exact
from fvcollapse.verification.exact.layer import inertial_number_at
from fvcollapse.verification.flows import layer, layer_case, run_until

K, NU_C, SLOPE = 4.0, 0.60, 0.15
LAW = Dilatancy(
    factor=K, fraction_critical=NU_C, slope=SLOPE, fraction_bulk=0.62, friction_factor=1.0
)
GRAIN_SCALE = 0.035
CARRY = from_python(carry)


# -- nu alone ------------------------------------------------------------------------------------


def relaxed(nu_0, nu_eq, strain):
    """Solution of d nu/d strain = -K nu (nu - nu_eq)."""
    return nu_eq / (1.0 - (1.0 - nu_eq / nu_0) * math.exp(-K * nu_eq * strain))


@pytest.mark.parametrize("steps", [1, 7, 100])
@pytest.mark.parametrize("nu_0", [0.52, 0.64])
def test_nu_relaxes_in_strain_exactly_for_any_time_step(steps, nu_0):
    rate, pressure, strain = 20.0, 500.0, 0.7
    nu_eq = NU_C - SLOPE * rate * GRAIN_SCALE / math.sqrt(pressure)
    nu, dt = nu_0, strain / rate / steps
    for _ in range(steps):
        nu *= 1.0 - dt * expansion(rate, pressure, nu, dt, LAW, GRAIN_SCALE)
    assert nu == pytest.approx(relaxed(nu_0, nu_eq, strain), rel=1e-13)


def test_equilibrium_is_reached_and_not_passed_in_one_long_step():
    dt = 10.0
    s = expansion(100.0, 500.0, 0.64, dt, LAW, GRAIN_SCALE)
    assert 0.64 * (1.0 - s * dt) == pytest.approx(
        NU_C - SLOPE * 100.0 * GRAIN_SCALE / math.sqrt(500.0), rel=1e-12
    )


def test_without_pressure_nu_falls_to_its_value_at_inertial_number_one():
    s = expansion(5.0, 0.0, 0.6, 1e3, LAW, GRAIN_SCALE)
    assert 0.6 * (1.0 - 1e3 * s) == pytest.approx(NU_C - SLOPE)
    assert expansion(0.0, 0.0, 0.6, 1e-3, LAW, GRAIN_SCALE) == 0.0


def test_limit_of_the_time_step_is_a_tenth_of_the_volume():
    rates = np.array([[0.5, -20.0]]), np.zeros((2, 2))
    fast, resting = (limit.py_func(SimpleNamespace(dilation_rate=rate)) for rate in rates)
    assert fast == pytest.approx(0.005)
    assert resting == math.inf


@pytest.mark.parametrize("rate", [0.5, -0.5])
def test_a_disc_that_expands_everywhere_alike_keeps_its_mass(rate):
    """U = rate x/2, w = rate z/2 about the centre: the area grows as exp(rate t), nu falls with it."""
    cells, steps, dt = 40, 40, 0.01
    nodes = np.arange(cells + 1) / cells - 0.5
    u = np.repeat(0.5 * rate * nodes[:, None], cells, axis=1)
    w = np.repeat(0.5 * rate * nodes[None, :], cells, axis=0)
    x, z = np.meshgrid(nodes, nodes, indexing="ij")
    simulation = Simulation(Case().replace(**{"effects.dilatancy": {}}))
    state = State(np.hypot(x, z) - 0.25, u, w, np.zeros((cells, cells)), np.zeros(cells + 1))
    state.solid_fraction = np.full((cells, cells), 0.6)
    state.dilation_rate = np.full((cells, cells), rate)
    simulation.state = state = state.copy()
    allocate(simulation)
    simulation.constants = simulation.constants._replace(dx=1.0 / cells, dz=1.0 / cells)
    simulation.carrier.u[:], simulation.carrier.w[:] = u, w
    area = cell_fractions(state.level_set).sum()
    for _ in range(steps):
        flow = simulation.flow()
        level_set.advect(
            state.level_set, 0.5 * rate * x, 0.5 * rate * z, dt, 1.0 / cells, 1.0 / cells
        )
        CARRY(flow, dt)
    filled = cell_fractions(state.level_set)
    growth = math.exp(rate * steps * dt)
    assert filled.sum() / area == pytest.approx(growth, rel=1e-3)
    assert state.solid_fraction[filled > 0.5] == pytest.approx(0.6 / growth, rel=1e-3)
    mass_after = (filled * state.solid_fraction).sum()
    assert mass_after == pytest.approx(0.6 * area, rel=1e-3)  # of the time step, first order


# -- uniform flow --------------------------------------------------------------------------------


def sheared_layer(dt, initial, **effect):
    """A layer on a rough bed at 24 deg, the density of which is that of nu = 0.62 or of `effect`."""
    case = layer_case(
        0.0025,
        0.02,
        geometry__slope_angle_deg=24.0,
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
        boundary__mu_bed=math.inf,
        effects__dilatancy={"dilatancy_factor": K} | effect,
        numerics__tolerance=1e-7,
        numerics__max_sweeps=100,
    )
    return layer(case, lambda z: exact.bagnold(initial or case, z), dt)


def at_solid_fraction(case, nu, depth):
    """The same layer, incompressible, with the density of nu."""
    density = nu * case.rheology.density_grain
    return case.replace(
        **{
            "effects.dilatancy": None,
            "rheology.density_bulk": density,
            "geometry.height_0": depth,
        }
    )


def test_a_layer_relaxes_in_its_own_strain():
    """nu_eq independent of I: each part of the layer follows the solution in strain, here the lowest cell."""
    flow = sheared_layer(1e-3, None, solid_fraction_critical=0.58, solid_fraction_slope=0.0)
    strain = 0.0
    for _ in range(30):
        flow.advance(1.0)
        nu = flow.state.solid_fraction[10, 0]
        assert nu == pytest.approx(relaxed(0.62, 0.58, strain), abs=5e-5)
        strain += 1e-3 * flow.cell_quantities()["shear_rate"][10, 0]
    assert strain > 0.5


def test_bagnold_flow_steadies_at_the_solid_fraction_of_its_inertial_number():
    """From nu = 0.62 to nu_eq(I): the layer swells, then flows as an incompressible one of that density."""
    dense = sheared_layer(5e-3, None)
    inertial = inertial_number_at(exact.slope_ratio(dense.case), dense.case.rheology)
    nu = NU_C - SLOPE * inertial
    swollen = at_solid_fraction(dense.case, nu, 0.02 * 0.62 / nu)
    flow = run_until(sheared_layer(5e-3, swollen), 2.0)
    inner = slice(0, 7)  # the uppermost cells hold grains that have hardly been sheared
    assert flow.state.solid_fraction[10, inner] == pytest.approx(nu, abs=1e-3)
    assert volume_change(flow) == pytest.approx(0.62 / nu - 1.0, rel=0.1)
    z, u = flow.profile()
    assert u[inner] == pytest.approx(exact.bagnold(swollen, z)[inner], rel=0.02)


def dense_layer(slope, mu_bed=math.inf):
    """A layer at rest whose grains are denser than sheared ones: tan(psi) = 0.04."""
    case = layer_case(
        0.0025,
        0.02,
        geometry__slope_angle_deg=slope,
        boundary__mu_bed=mu_bed,
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
        effects__dilatancy={
            "dilatancy_factor": 4.0,
            "solid_fraction_0": 0.61,
            "solid_fraction_critical": 0.60,
        },
        numerics__tolerance=1e-6,
        numerics__max_sweeps=60,
    )
    return layer(case, lambda z: 0.0 * z, 0.01)


def test_friction_is_raised_by_the_angle_of_dilatancy():
    """A layer stays up to arctan(mu_1 + tan(psi)) = 22.8 deg; without dilatancy it starts at 20.8 deg."""
    resting, starting = (run_until(dense_layer(slope), 0.5) for slope in (22.3, 23.6))
    assert resting.surface_velocity() < 5.0 * 0.02 * resting.case.numerics.shear_rate_min
    grains = resting.geometry.filled > 0.5
    assert resting.state.solid_fraction[grains] == pytest.approx(0.61, abs=5e-4)  # it creeps
    assert starting.surface_velocity() > 0.01


def test_the_halo_of_a_periodic_layer_is_the_layer():
    """Its pressures once ran away, since the sources at its ends lack a neighbour."""
    flow = run_until(dense_layer(24.0, mu_bed=0.38), 0.3)
    first, period = flow.geometry.first, flow.geometry.last - flow.geometry.first
    for column in range(first):
        same = first + (column - first) % period
        assert np.array_equal(flow.state.pressure_filled[column], flow.state.pressure_filled[same])
