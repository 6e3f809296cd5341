"""The static and the analytic flows with each effect on: unchanged, or changed as its closed form says.

The numbers in the comments are those measured.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.verification import exact
from fvcollapse.verification.exact.layer import inertial_number_at
from fvcollapse.verification.flows import layer, layer_case, run_until, run_until_steady
from fvcollapse.verification.problems.surface import bed_pressures

WIDE = {"geometry__channel_width": 1e4, "effects__lateral_friction": {}}  # m: walls far away
CRITICAL = {"dilatancy_factor": 4.0, "solid_fraction_0": 0.60, "solid_fraction_critical": 0.60}
EFFECTS = {
    "lateral_friction": WIDE,
    "gate": {"effects__gate": {"speed": 1.0, "mu_gate": 0.2}},
    "viscosity": {"effects__viscosity": {"factor": 3.0}},
    "cohesion": {"effects__cohesion": {"kappa_0": 30.0}},
    "friction_hysteresis": {"effects__friction_hysteresis": {"delta_mu": 0.04}},
    "dilatancy": {"effects__dilatancy": CRITICAL},
    "dilatancy of dense grains": {"effects__dilatancy": {**CRITICAL, "solid_fraction_0": 0.62}},
    "nonlocal": {"effects__nonlocal": {"A": 0.5}},
    "transverse_profile": {"effects__transverse_profile": {"velocity_ratio": 1.4}},
}
EFFECTS["together"] = {key: value for keys in EFFECTS.values() for key, value in keys.items()}


# -- sliding block -------------------------------------------------------------------------------


@pytest.mark.parametrize("mu_bed", [0.25, 0.55])
@pytest.mark.parametrize("name", EFFECTS)
def test_block_on_an_inclined_plane(name, mu_bed):
    """du/dt = g cos a (tan a - mu_b): what acts inside the grains, or far away, does not act on a rigid block.

    Cohesion and hysteresis neither: a bed on which the grains slide has its own friction. Dense grains
    once took the slip for shear that dilates them, and the block gained 20 % too much speed.
    """
    case = layer_case(
        0.005,
        0.03,
        geometry__slope_angle_deg=22.0,
        rheology__mu_1=0.9,
        rheology__mu_2=0.9,
        effects__bed_friction={"mu_bed": mu_bed},
        **EFFECTS[name],
    )
    flow = run_until(layer(case, lambda z: 0.5 + 0.0 * z, dt=2e-3, slip=0.5), 0.1)
    gain = 0.1 * exact.gravity_normal(case) * (exact.slope_ratio(case) - mu_bed)
    assert flow.mean_velocity() - 0.5 == pytest.approx(gain, rel=1e-4)  # 4e-6; dense 2e-5
    assert np.ptp(flow.profile()[1]) < 1e-4


# -- at rest -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", EFFECTS)
def test_box_tilted_by_22_degrees_rests_under_hydrostatic_pressure(name):
    """Its level surface cuts the cells at 22 degrees; p = rho g depth with the density of the start."""
    changes = {key.replace("__", "."): value for key, value in EFFECTS[name].items()}
    if "effects.gate" in changes:
        changes["effects.gate"] = {"mu_gate": 0.2}  # it stays closed
    changes |= {"grid.cell_size": 0.014, "geometry.surface": "horizontal", "gate.speed": 0.0}
    simulation = Simulation(Case().replace(**changes | {"geometry.channel_width": 0.1}))
    while simulation.state.time < 0.05:
        simulation.advance(0.05)
        assert simulation.max_speed() < 1e-12  # 1e-20 m/s
    pressure, expected = bed_pressures(simulation)
    assert pressure == pytest.approx(simulation.packing_0 * expected, rel=1e-9)  # 4e-16


# -- chutes --------------------------------------------------------------------------------------

DEPTH, CELLS = 0.02, 16
CHUTE = {"geometry__slope_angle_deg": 24.0, "rheology__mu_1": 0.38}
ROUGH = {"boundary__mu_bed": math.inf}
BAGNOLD = {**CHUTE, **ROUGH, "rheology__mu_2": 0.64}
EQUATION_8 = {
    **CHUTE,
    **ROUGH,
    "rheology__law": "drucker_prager",
    "rheology__viscosity": 1.0,
}
UNCHANGED = {name: EFFECTS[name] for name in ("lateral_friction", "gate", "transverse_profile")}
UNCHANGED["bed_friction"] = {"boundary__mu_bed": 0.3, "effects__bed_friction": {"mu_bed": 2.0}}
BROKEN = {"friction_hysteresis": EFFECTS["friction_hysteresis"]}


def steady_error(velocity, cells=CELLS, dt=1.0, **changes):
    """A layer that starts with velocity(case, z), when it is steady; and how far it is from that then.

    The error is the largest of the velocity, relative to that of the surface.
    """
    case = layer_case(DEPTH / cells, DEPTH, **changes)
    flow = run_until_steady(layer(case, lambda z: velocity(case, z), dt))
    return flow, error_of(flow, lambda z: velocity(case, z))


def error_of(flow, velocity):
    """Largest error of the velocity, relative to that of the surface."""
    z, u = flow.profile()
    return np.abs(u - velocity(z)).max() / velocity(np.array([DEPTH]))[0]


@pytest.mark.parametrize("name", [*UNCHANGED, *BROKEN])
def test_bagnold_flow_is_not_changed(name):
    """Walls and gate far away, a bed rougher than the grains, contacts that the flow has broken (I = 0.09)."""
    flow, error = steady_error(exact.bagnold, **{**BAGNOLD, **(UNCHANGED | BROKEN)[name]})
    assert error < 1.5e-3  # 0.9e-3, as without effects
    if name in BROKEN:
        assert flow.state.settled_share[flow.geometry.filled > 0.0].max() == 0.0


def cohesive_bagnold(case, z):
    """mu(I) = tan a - kappa_0/p where that exceeds mu_1, above it a plug; u the integral of I sqrt(p/rho_s)/d."""
    law, kappa = case.rheology, case.effects.cohesion.kappa_0
    weight, slope = law.density_bulk * exact.gravity_normal(case), exact.slope_ratio(case)
    plug = kappa / (weight * (slope - law.mu_1))

    def shear(depth):
        inertial = inertial_number_at(slope - kappa / (weight * depth), law)
        return inertial * math.sqrt(weight * depth / law.density_grain) / law.grain_diameter

    return np.array([quad(shear, max(DEPTH - height, plug), DEPTH)[0] for height in z])


def test_bagnold_flow_with_cohesion_has_a_plug():
    changes = {**BAGNOLD, "effects__cohesion": {"kappa_0": 10.0}}
    _, error = steady_error(cohesive_bagnold, cells=32, **changes)
    assert error < 2e-3  # 1.2e-3 on 32 cells, 4.4e-3 on 16


def test_bagnold_flow_with_dilatancy_is_that_of_the_equilibrium_density():
    """At nu = nu_eq(I) nothing expands: the incompressible flow of density rho_grain nu, and nu stays."""
    law = layer_case(DEPTH / CELLS, DEPTH, **BAGNOLD).rheology
    slope = math.tan(math.radians(24.0))
    nu = 0.60 - 0.15 * inertial_number_at(slope, law)
    effect = {**CRITICAL, "solid_fraction_0": nu, "solid_fraction_slope": 0.15}
    settings = {"numerics__tolerance": 1e-7, "numerics__max_sweeps": 100}

    case = layer_case(DEPTH / CELLS, DEPTH, **BAGNOLD, effects__dilatancy=effect, **settings)
    same = case.replace(
        **{"effects.dilatancy": None, "rheology.density_bulk": nu * law.density_grain}
    )
    flow = layer(case, lambda z: exact.bagnold(same, z), 5e-3)
    flow.state.pressure_filled *= flow.packing_0
    run_until(flow, 0.5)
    assert error_of(flow, lambda z: exact.bagnold(same, z)) < 1.5e-3  # 0.6e-3
    grains = flow.geometry.filled > 0.5
    assert flow.state.solid_fraction[grains] == pytest.approx(nu, abs=5e-4)  # 2e-4, at the surface


@pytest.mark.parametrize("name", UNCHANGED)
def test_drucker_prager_chute_is_not_changed(name):
    changes = {**EQUATION_8, **UNCHANGED[name]}
    _, error = steady_error(exact.incline_drucker_prager, dt=10.0, **changes)
    assert error < 2e-3  # 1.0e-3


@pytest.mark.parametrize(
    ("law", "effect"), [("drucker_prager", {"factor": 2.0}), ("mu_I", {"eta_constant": 2.0})]
)
def test_drucker_prager_chute_slows_with_its_viscosity(law, effect):
    """2 Pa s in the place of 1, by scaling it and as a constant in the place of eta_I."""
    changes = {**EQUATION_8, "rheology__law": law, "effects__viscosity": effect}
    _, error = steady_error(
        lambda case, z: exact.incline_drucker_prager(case, z) / 2.0, dt=10.0, **changes
    )
    assert error < 2e-3  # 1.0e-3
