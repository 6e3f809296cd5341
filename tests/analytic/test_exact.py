"""The exact solutions themselves: each satisfies the equation it is said to solve."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from fvcollapse.case.case import GRAVITY
from fvcollapse.step.ill_posedness import criterion, is_ill_posed
from fvcollapse.verification import exact
from fvcollapse.verification.boxes import box_case, channel_case
from fvcollapse.verification.exact import regularised
from fvcollapse.verification.flows import layer_case
from fvcollapse.verification.problems.collapse import column_case

STEP = 1e-30  # of the complex derivatives, exact to round-off
FLOWS = [exact.manufactured_box, exact.manufactured_below_surface, exact.manufactured_gyres]


@pytest.mark.parametrize("flow", FLOWS)
def test_manufactured_gradients_are_those_of_the_velocity(flow):
    x, z = np.meshgrid(np.linspace(0.1, 0.9, 7), np.linspace(0.05, 0.45, 7))
    _, _, _, u_x, u_z, w_x = flow(x, z)
    along, across = flow(x + 1j * STEP, z), flow(x, z + 1j * STEP)
    np.testing.assert_allclose(along[0].imag / STEP, u_x, atol=1e-12)
    np.testing.assert_allclose(across[0].imag / STEP, u_z, atol=1e-12)
    np.testing.assert_allclose(along[1].imag / STEP, w_x, atol=1e-12)
    np.testing.assert_allclose(across[1].imag / STEP, -u_x, atol=1e-12)


@pytest.mark.parametrize("flow", FLOWS)
def test_manufactured_flow_keeps_to_walls_that_let_it_slip(flow):
    s = np.linspace(0.05, 0.45, 9)
    for wall in (0.0, 1.0):
        u, _, _, _, u_z, w_x = flow(wall + 0.0 * s, s)
        np.testing.assert_allclose([u, u_z + w_x], 0.0, atol=1e-12)
    _, w, _, _, u_z, w_x = flow(s, 0.0 * s)
    np.testing.assert_allclose([w, u_z + w_x], 0.0, atol=1e-12)


def test_manufactured_surface_bears_no_stress_and_rests():
    x = np.linspace(0.0, 1.0, 9)
    found = exact.manufactured_below_surface(x, exact.manufactured_surface(x))
    np.testing.assert_allclose(found, 0.0, atol=1e-12)


def test_force_of_a_fluid_at_rest_is_its_buoyancy():
    """Pressure rho g (1 - z) balances gravity: no force is left to add."""

    def at_rest(x, z, time):
        zero = 0.0 * x
        return zero, zero, 1000.0 * GRAVITY * (1.0 - z), zero, zero, zero

    force = exact.manufactured_force(box_case(8), at_rest, np.array([0.3]), np.array([0.4]), 0.0)
    np.testing.assert_allclose(force, 0.0, atol=1e-12)


def test_pressure_balances_the_advection_of_taylor_green():
    """Without viscosity the flow is steady: its force is the gradient of the pressure and gravity."""
    case = box_case(8, rheology__viscosity=0.0)

    def flow(x, z, time):
        k = np.pi
        u, w = exact.taylor_green(x, z, time, 0.0, k, 1.3)
        p = 1000.0 * (GRAVITY * (1.0 - z) + exact.taylor_green_pressure(x, z, time, 0.0, k, 1.3))
        u_x = 1.3 * k * np.cos(k * x) * np.cos(k * z)
        u_z = -1.3 * k * np.sin(k * x) * np.sin(k * z)
        return u, w, p, u_x, u_z, -u_z

    force = exact.manufactured_force(case, flow, np.array([0.3, 0.7]), np.array([0.4, 0.2]), 0.0)
    np.testing.assert_allclose(force, 0.0, atol=1e-12)


def test_force_of_swinging_gyres_holds_their_acceleration():
    """Against the momentum balance in advective form, differentiated in time by differences."""
    case = box_case(8, rheology__viscosity=20.0)
    x, z, time, gap = np.array([0.3, 0.8]), np.array([0.4, 0.7]), 0.2, 1e-6

    def flow(x, z):
        return np.array(exact.manufactured_gyres(x, z, time))

    u, w, _, u_x, u_z, _ = flow(x, z)
    before, after = (exact.manufactured_gyres(x, z, time + step) for step in (-gap, gap))
    p_x = flow(x + 1j * STEP, z)[2].imag / STEP
    gap_wide = 1e-4
    laplace = sum(
        (flow(x + a, z + b)[0] - 2 * u + flow(x - a, z - b)[0]) / gap_wide**2
        for a, b in ((gap_wide, 0.0), (0.0, gap_wide))
    )
    expected = (
        (after[0] - before[0]) / (2 * gap) + u * u_x + w * u_z + p_x / 1000.0 - 0.02 * laplace
    )
    found = exact.manufactured_force(case, exact.manufactured_gyres, x, z, time)[0]
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_couette_start_up_ends_in_the_straight_profile():
    case = channel_case(8, 0.1, rheology__viscosity=10.0)
    z = np.linspace(0.0, 0.1, 5)
    np.testing.assert_allclose(
        exact.couette_start_up(case, z, 100.0, 2.0), 2.0 * (1.0 - z / 0.1), atol=1e-12
    )


CHUTES = [
    (exact.chute_drucker_prager, {"rheology__law": "drucker_prager", "rheology__viscosity": 20.0}),
    (exact.chute_mu_I, {}),
]


def chute_case(rate_min, **changes):
    return layer_case(
        0.015,
        0.08,
        geometry__slope_angle_deg=26.0,
        geometry__channel_width=0.1,
        effects__lateral_friction={},
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
        numerics__shear_rate_min=rate_min,
        **changes,
    )


@pytest.mark.parametrize(("rigid", "changes"), CHUTES)
def test_regularised_chute_tends_to_the_rigid_plastic_one(rigid, changes):
    z = np.linspace(0.0, 0.08, 9)
    gaps = []
    for rate_min in (1e-2, 1e-4):
        case = chute_case(rate_min, **changes)
        expected = rigid(case, z)
        gaps.append(np.abs(exact.chute_regularised(case)(z) - expected).max() / expected[-1])
    assert gaps[1] < 0.1 * gaps[0] < 0.01


@pytest.mark.parametrize(("rigid", "changes"), CHUTES)
def test_regularised_chute_satisfies_its_balance(rigid, changes):
    """Stress from the shear rate by differences, against weight less wall friction above each depth."""
    case = chute_case(1e-2, **changes)
    z = np.linspace(0.0, 0.08, 16001)
    u = exact.chute_regularised(case)(z)
    weight = case.rheology.density_bulk * exact.gravity_normal(case)
    middle, pressure = 0.5 * (u[1:] + u[:-1]), weight * (0.08 - 0.5 * (z[1:] + z[:-1]))
    slip_min = 0.1 * 1e-2 * 0.08
    force = weight * exact.slope_ratio(case) - 2.0 * exact.wall_ratio(
        case
    ) * pressure * middle / np.hypot(middle, slip_min)
    carried = z[1] * (np.cumsum(force[::-1])[::-1] - 0.5 * force)
    chosen = slice(200, -200, 400)
    rates = (np.diff(u) / z[1])[chosen]
    tau = [
        regularised.shear_stress(case, rate, p)
        for rate, p in zip(rates, pressure[chosen], strict=True)
    ]
    np.testing.assert_allclose(tau, carried[chosen], rtol=1e-4)
    assert u[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("walls", [{}, {"effects__lateral_friction": {}}])
def test_viscous_stop_tends_to_the_inviscid_one(walls):
    case = layer_case(
        0.005,
        0.02,
        geometry__channel_width=0.1,
        rheology__law="drucker_prager",
        rheology__viscosity=1e-6,
        **walls,
    )
    z = np.linspace(0.0, 0.02, 9)

    def start(z):
        return 10.0 * z

    np.testing.assert_allclose(
        exact.stopping_viscous(case, start, z, 0.1),
        exact.stopping_inviscid(case, start(z), z, 0.1),
        atol=1e-3,
    )


def test_walls_add_their_friction_to_the_manufactured_force():
    """The difference between the forces with and without walls is 2 mu_w p/(rho w), against the velocity."""
    x, z = np.array([0.3, 0.8]), np.array([0.4, 0.7])
    law = {"rheology__law": "drucker_prager", "numerics__shear_rate_min": 1e-12}
    walls = {"geometry__channel_width": 0.5, "effects__lateral_friction": {"mu_wall": 0.2}}
    flow = exact.manufactured_box
    free, braked = (
        np.array(exact.manufactured_force(box_case(8, **law, **more), flow, x, z, 0.0))
        for more in ({}, walls)
    )
    u, w, p = flow(x, z)[:3]
    expected = 2.0 * 0.2 / 0.5 * p / 1000.0 * np.array([u, w]) / np.hypot(u, w)
    np.testing.assert_allclose(braked - free, expected, rtol=1e-6)


def test_huppert_profile_holds_the_area_and_feeds_the_front():
    """The depth solves h_t = g/(3 nu) (h^3 h_x)_x in integral form: the flux past x is the loss behind."""
    x = np.linspace(0.0, 3.0, 200001)
    h = exact.huppert_depth(1.2, 3.0, x)
    assert trapezoid(h, x) == pytest.approx(1.2, rel=1e-5)
    nu = 0.5
    time = (3.0 / exact.huppert_front(1.2, nu, 1.0)) ** 5
    later = exact.huppert_depth(1.2, exact.huppert_front(1.2, nu, time * (1 + 1e-6)), x)
    part = x <= 1.5
    loss = trapezoid((h - later)[part], x[part]) / (1e-6 * time)
    slope = np.gradient(h, x)[part][-1]
    assert loss == pytest.approx(-GRAVITY / (3 * nu) * h[part][-1] ** 3 * slope, rel=2e-3)


@pytest.mark.parametrize("slope", [0.0, 20.0])
def test_dam_break_keeps_the_volume(slope):
    """What the fan holds is what its rear has set in motion."""
    case = column_case(8, 6.0, geometry__slope_angle_deg=slope)
    time = 0.5
    shift = 0.5 * GRAVITY * np.sin(np.radians(slope)) * time**2
    c = np.sqrt(exact.gravity_normal(case))
    x = 6.0 + shift + np.linspace(-c, 2 * c, 100001) * time
    assert trapezoid(exact.dam_break_depth(case, x, time), x) == pytest.approx(c * time)


def test_growth_is_possible_exactly_where_the_criterion_says():
    """Over random states, the largest rate over all directions against `is_ill_posed`."""
    random = np.random.default_rng(3)
    angles = np.linspace(0.0, np.pi, 4001)
    waves = np.array([np.cos(angles), np.sin(angles)])
    for exponent, slope in random.uniform(0.01, 0.9, (400, 2)):
        rates = exact.growth_rate(waves, 1.0, 1.0, exponent, slope, 1.0)
        if abs(criterion(exponent, slope)) > 1e-3:
            assert (rates.max() > 0.0) == is_ill_posed(exponent, slope), (exponent, slope)
