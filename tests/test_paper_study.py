"""The study of the paper: what is read off curves and fields, verdicts, tables, the committed files."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import GRAVITY, Case
from runs import table
from runs.measured import Measured
from runs.paper import measures, pressure, readings
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED, Clause, Statement, claims, combined

TIME = measures.STEP * np.arange(201)


# -- fronts --------------------------------------------------------------------------------------


def rising_to(peak, after):
    """A velocity that rises to its peak at 0.3 s and then follows `after(time since)`."""
    return np.where(TIME < 0.3, peak * TIME / 0.3, np.maximum(after(TIME - 0.3), 0.0))


def two_slopes(since):
    """1.2 m/s, falls to 0.4 in 0.2 s, stays within 0.05 for 0.8 s, then stops in 0.1 s."""
    return np.interp(since, [0.0, 0.2, 1.0, 1.1], [1.2, 0.4, 0.35, 0.0])


def test_velocity_of_a_parabolic_front_is_exact():
    front = 0.2 + 0.5 * TIME + 0.3 * TIME**2
    np.testing.assert_allclose(measures.front_velocity(front), 0.5 + 0.6 * TIME, atol=1e-9)


@pytest.mark.parametrize("phase", [0.0, 0.3, 1.0])
def test_the_time_of_the_peak_is_the_middle_of_what_is_fast(phase):
    """A flat peak from 0.30 to 0.50 s, on which a ripple of 2 % moves the largest value about."""
    ripple = 0.02 * np.sin(2.0 * np.pi * (TIME / 0.09 + phase))
    trapeze = np.clip(np.minimum(TIME / 0.3, (0.8 - TIME) / 0.3), 0.0, 1.0)
    velocity = 1.2 * trapeze * (1.0 + ripple * (trapeze == 1.0))
    assert measures.peak_time(velocity) == pytest.approx(0.40, abs=0.01)
    assert measures.peak_time(1.2 * trapeze) == pytest.approx(0.40, abs=1e-9)


def test_a_front_that_is_fastest_at_the_end_has_its_peak_before_the_end():
    assert measures.peak_time(TIME) == pytest.approx(0.5 * 1.95 * TIME[-1], abs=0.01)


def test_plateau_is_found_where_it_is():
    found = measures.plateau(rising_to(1.2, two_slopes))
    # the slope is a fit over 140 ms, so that each end is blurred by about half of that
    assert found.start == pytest.approx(0.5, abs=0.07)
    assert found.duration == pytest.approx(0.8, abs=0.12)
    assert found.velocity == pytest.approx(0.375, abs=0.02)


@pytest.mark.parametrize(
    "after",
    [
        lambda since: 1.2 - since,  # constant deceleration
        lambda since: 1.2 * np.exp(-since / 0.3),
        lambda since: 1.2 * (1.0 - (since / 1.2) ** 2),  # slow first, then fast
        lambda since: np.where(since < 0.5, 1.2, 0.0),  # fast all the time: not slow
    ],
)
def test_no_plateau(after):
    assert measures.plateau(rising_to(1.2, after)).duration < measures.PLATEAU_LEAST


def test_noise_of_a_few_per_cent_hides_no_plateau_and_makes_none():
    noise = 0.02 * np.sin(2.0 * np.pi * TIME / 0.05)
    assert measures.plateau(rising_to(1.2, two_slopes) + noise).duration > 0.6
    straight = rising_to(1.2, lambda since: 1.2 - since)
    assert measures.plateau(straight + noise * (straight > 0.1)).duration < measures.PLATEAU_LEAST


def test_a_front_that_does_not_move_has_no_plateau():
    assert measures.plateau(np.zeros(100)) == measures.Plateau()


def test_tail_ratio():
    straight = rising_to(1.2, lambda since: 1.2 - since)
    assert measures.tail_ratio(straight) == pytest.approx(1.0, abs=0.05)
    assert measures.tail_ratio(rising_to(1.2, two_slopes)) > 4.0
    assert math.isnan(measures.tail_ratio(rising_to(1.2, lambda since: 1.2 - 0.1 * since)))


def test_early_acceleration_is_the_slope_between_two_levels():
    velocity = np.minimum(4.0 * TIME, 1.0)
    assert measures.early_acceleration(TIME, velocity, 0.4, 0.8) == pytest.approx(4.0)
    assert math.isnan(measures.early_acceleration(TIME, velocity, 2.0, 3.0))


# -- profiles ------------------------------------------------------------------------------------

X = np.linspace(0.0, 1.2, 241)


def test_roughness_of_a_smooth_surface_is_nothing_and_of_a_wave_its_rms():
    cubic = 0.05 - 0.03 * X + 0.01 * X**2 - 0.004 * X**3
    assert measures.roughness(X, cubic, 0.1, 1.1) < 1e-9
    wave = 2e-3 * np.sin(2.0 * np.pi * X / 0.06)
    rms = 2e-3 / math.sqrt(2.0)
    # a wave of 6 cm is not quite removed by a smoothing over 15 cm
    assert measures.roughness(X, cubic + wave, 0.1, 1.1) == pytest.approx(rms, rel=0.25)
    assert math.isnan(measures.roughness(X, cubic, 0.1, 0.2))


def test_interface_of_a_parabola():
    static = np.maximum(0.06 - 0.1 * X - 0.15 * X**2, 0.0)
    found = measures.interface(X, static, static + 0.01)
    assert found.curvature == pytest.approx(0.3, rel=1e-6)
    end = X[static > 0.006][-1]  # 10 % of the top
    start = X[static <= 0.048][0]
    chord = (np.interp(start, X, static) - np.interp(end, X, static)) / (end - start)
    assert found.angle == pytest.approx(math.degrees(math.atan(chord)), rel=0.02)


def test_no_interface_where_all_or_nothing_moves():
    h = np.maximum(0.06 - 0.05 * X, 0.0)
    assert math.isnan(measures.interface(X, np.zeros_like(X), h).angle)
    assert math.isnan(measures.interface(X, h, h).angle)


def test_surface_slope_of_a_wedge():
    wedge = np.maximum(0.1 - 0.2 * X, 0.0)
    angle = math.degrees(math.atan(0.2))
    assert measures.surface_slope(X, wedge, 0.01) == pytest.approx(angle)


# -- columns -------------------------------------------------------------------------------------


def test_bands_are_counted_per_column():
    z = np.linspace(0.0, 1.0, 40)
    single = np.exp(-(((z - 0.5) / 0.2) ** 2))
    double = np.exp(-(((z - 0.25) / 0.08) ** 2)) + np.exp(-(((z - 0.75) / 0.08) ** 2))
    flowing = np.ones((2, 40), bool)
    assert measures.bands(np.array([single, single]), flowing) == 1.0
    assert measures.bands(np.array([single, double]), flowing) == 1.5
    ripple = single * (1.0 + 0.05 * np.sin(40.0 * z))
    assert measures.bands(np.array([ripple, ripple]), flowing) == 1.0
    flowing[:, 3:] = False
    assert math.isnan(measures.bands(np.array([single, double]), flowing))


def test_unevenness_sees_bands_thinner_than_its_length():
    z = 1e-3 * (np.arange(60) + 0.5)
    smooth, flowing = np.full((3, 60), 20.0), np.ones((3, 60), bool)
    assert measures.unevenness(smooth, flowing, 1e-3, 0.012) < 1e-9
    banded = smooth * (1.0 + np.sin(2.0 * np.pi * z / 0.006))
    assert measures.unevenness(banded, flowing, 1e-3, 0.012) > 0.5


def test_weighted_quantiles():
    values, weights = np.array([3.0, 1.0, 2.0]), np.array([1.0, 8.0, 1.0])
    found = measures.weighted_quantiles(values, weights, (0.5, 0.9, 1.0))
    np.testing.assert_allclose(found, [1.0, 2.0, 3.0])


# -- the pressure --------------------------------------------------------------------------------


def flow_field(case, slope=-0.1, stretch=0.5, shear=10.0, dx=0.005):
    """A sheared and stretched layer whose pressure is that of equation 22, cell means included."""
    nx, nz = 60, 24
    x_node, z_node = dx * np.arange(nx + 1), dx * np.arange(nz + 1)
    h_node = 0.060 + slope * (x_node - 0.15)
    level_set = z_node[None, :] - h_node[:, None]
    z = dx * (np.arange(nz) + 0.5)
    u = shear * z[None, :] + stretch * x_node[:, None]
    h = 0.5 * (h_node[:-1] + h_node[1:])[:, None]
    low = z[None, :] - 0.5 * dx
    depth = h - 0.5 * (low + np.minimum(low + dx, h))
    alpha = math.radians(case.geometry.slope_angle_deg)
    factor = math.cos(alpha) - math.sin(alpha) * (slope + 2.0 * stretch / shear)
    p = case.rheology.density_bulk * GRAVITY * factor * np.maximum(depth, 0.0)
    fields = {"level_set": level_set, "u": u, "w": np.zeros((nx, nz + 1)), "pressure": p}
    return fields | {"dx": dx, "dz": dx, "time": 0.0, "shear_rate": np.full((nx, nz), shear)}


def test_equation_22_is_recognised_and_differs_from_hydrostatic():
    case = Case()
    found = pressure.columns(flow_field(case), case)
    assert pressure.flowing_share_valid(found) > 0.9
    assert pressure.misfit(found, "equation_22") < 1e-6
    alpha = math.radians(22.0)
    expected = 1.0 - math.cos(alpha) / (math.cos(alpha) - math.sin(alpha) * (-0.1 + 0.1))
    assert pressure.misfit(found, "hydrostatic") == pytest.approx(abs(expected), abs=1e-6)
    steeper = pressure.columns(flow_field(case, slope=-0.3), case)
    factor = math.cos(alpha) - math.sin(alpha) * (-0.3 + 0.1)
    gap = 1.0 - math.cos(alpha) / factor
    assert pressure.misfit(steeper, "hydrostatic") == pytest.approx(gap, rel=1e-3)


def test_where_nothing_shears_equation_22_is_not_compared():
    case = Case()
    found = pressure.columns(flow_field(case, shear=1e-3, stretch=1.0), case)
    assert pressure.flowing_share_valid(found) == 0.0
    assert math.isnan(pressure.misfit(found, "equation_22"))


def test_viscosity_of_equation_6():
    """By hand: 0.25 * 1000 / (10 + 0.279/0.035 sqrt(1000))."""
    field = {"pressure": np.array([1000.0]), "shear_rate": np.array([10.0])}
    expected = 0.25 * 1000.0 / (10.0 + 0.279 / 0.035 * math.sqrt(1000.0))
    assert readings.eta_I(field, Case()) == pytest.approx(expected)


# -- verdicts ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "error", "sense", "limit", "verdict"),
    [
        (1.0, 0.1, "above", 0.5, CONFIRMED),
        (0.3, 0.1, "above", 0.5, REFUTED),
        (0.55, 0.1, "above", 0.5, OPEN),
        (0.45, 0.1, "above", 0.5, OPEN),
        (0.0, 0.0, "above", 0.0, REFUTED),
        (0.3, 0.1, "below", 0.5, CONFIRMED),
        (1.0, 0.1, "below", 0.5, REFUTED),
        (0.45, 0.1, "below", 0.5, OPEN),
        (1.6, 0.05, "within", (1.5, 1.7), CONFIRMED),
        (1.6, 0.2, "within", (1.5, 1.7), OPEN),
        (1.9, 0.1, "within", (1.5, 1.7), REFUTED),
        (math.nan, 0.1, "above", 0.5, OPEN),
        (1.0, math.nan, "above", 0.5, OPEN),
    ],
)
def test_verdict_on_a_clause(value, error, sense, limit, verdict):
    assert Clause("", Measured(value, error), sense, limit, of_paper=True).verdict == verdict


def test_verdict_on_a_statement():
    assert combined([CONFIRMED, CONFIRMED]) == CONFIRMED
    assert combined([CONFIRMED, OPEN]) == OPEN
    assert combined([CONFIRMED, OPEN, REFUTED]) == REFUTED
    assert combined([]) == OPEN
    clauses = [
        Clause("10°", Measured(0.123456, 0.00071), "above", 0.02, "m"),
        Clause("0°", Measured(0.01), "above", 0.02, "m"),
    ]
    statement = Statement("3", "claim", "criterion", clauses, "more")
    assert statement.measured() == "10° 0.123 ± 0.0007; 0° 0.0100 ± ? m (1 of 2 confirmed). more"
    many = Statement("3", "claim", "criterion", clauses * 4)
    assert many.measured().startswith("8 values, 0.0100 to 0.123 m; of these 0° 0.0100 ± ?; 0°")
    assert many.measured().endswith("m (4 of 8 confirmed)")


def test_a_missing_run_leaves_a_claim_open():
    listed, claim = claims()

    @claim("3", "said", "criterion")
    def measure(of):
        return [Clause("", Measured(of.row("muI_a0_w10")["end_s"], 0.0), "above", 0.0)]

    statement = listed[0].statement(table.Tables("no such folder"))
    assert statement.verdict == OPEN
    assert "not run: muI_a0_w10" in statement.measured()
