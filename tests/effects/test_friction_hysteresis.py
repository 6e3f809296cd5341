"""Friction hysteresis: between stop and start angle a layer stays if it rests and flows on if it flows."""

import math

import numpy as np
import pytest
from effect_runs import centre_of_mass, collapse

from fvcollapse.step.friction_hysteresis import STOP_SHARE, FrictionHysteresis, settled_after
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

LAW = FrictionHysteresis(delta_mu=0.05, I_start=0.01, strain=0.05)
GRAIN_SCALE, PRESSURE = 0.035, 400.0
RATE_START = LAW.I_start * math.sqrt(PRESSURE) / GRAIN_SCALE
MU_STOP = 0.38  # arctan: 20.8 deg; with delta_mu 23.3 deg
DEPTH = 0.02


def after(share, rate, time, steps):
    for _ in range(steps):
        share = settled_after(share, rate, PRESSURE, time / steps, LAW, GRAIN_SCALE)
    return share


@pytest.mark.parametrize("steps", [1, 10])
def test_contacts_break_with_strain_and_settle_with_time_exactly_for_any_step(steps):
    rate, time = 3.0 * RATE_START, 0.02
    broken = math.exp(-rate * time / LAW.strain)
    assert after(1.0, rate, time, steps) == pytest.approx(broken, rel=1e-12)
    settled = 1.0 - math.exp(-RATE_START * time / LAW.strain)
    assert after(0.0, 0.0, time, steps) == pytest.approx(settled, rel=1e-12)


def test_between_the_two_inertial_numbers_the_contacts_keep_their_share():
    for factor in (1.01 * STOP_SHARE, 0.99):
        assert after(0.4, factor * RATE_START, 10.0, 1) == 0.4


def test_without_pressure_nothing_settles():
    assert settled_after(0.3, 0.0, 0.0, 10.0, LAW, GRAIN_SCALE) == pytest.approx(0.3)
    assert settled_after(0.3, 10.0, 0.0, 10.0, LAW, GRAIN_SCALE) < 1e-6


def inclined_layer(slope, kick):
    """A layer on a rough bed that starts with `kick` times the velocity of its Bagnold flow at 22 deg."""
    case = layer_case(
        0.0025,
        DEPTH,
        geometry__slope_angle_deg=slope,
        boundary__mu_bed=math.inf,
        rheology__mu_1=MU_STOP,
        rheology__mu_2=0.64,
        effects__friction_hysteresis=LAW._asdict(),
        numerics__tolerance=1e-6,
        numerics__max_sweeps=60,
    )
    at_22 = case.replace(**{"geometry.slope_angle_deg": 22.0})
    return layer(case, lambda z: kick * exact.bagnold(at_22, z), 0.01)


def test_between_stop_and_start_angle_what_rests_stays():
    flow = run_until(inclined_layer(22.0, 0.0), 1.0)
    creep = 5.0 * DEPTH * flow.case.numerics.shear_rate_min  # r/sqrt(1 - r^2) = 2.8 at 22 deg
    assert flow.surface_velocity() < creep
    assert flow.state.settled_share[flow.geometry.filled > 0.5] == pytest.approx(1.0)


def test_between_stop_and_start_angle_what_is_kicked_flows_as_without_hysteresis():
    flow = run_until(inclined_layer(22.0, 1.0), 3.0)
    z, u = flow.profile()
    assert u == pytest.approx(exact.bagnold(flow.case, z), rel=0.03)
    assert flow.state.settled_share[flow.geometry.filled > 0.5].max() < 1e-3


def test_a_small_kick_is_not_enough():
    flow = run_until(inclined_layer(22.0, 0.02), 1.0)
    assert flow.surface_velocity() < 5.0 * DEPTH * flow.case.numerics.shear_rate_min


def test_above_the_start_angle_it_starts_and_below_the_stop_angle_it_stops():
    assert run_until(inclined_layer(24.5, 0.0), 1.0).surface_velocity() > 0.05
    stopped = run_until(inclined_layer(20.0, 1.0), 2.0)
    assert stopped.surface_velocity() < 5.0 * DEPTH * stopped.case.numerics.shear_rate_min
    assert stopped.state.settled_share[stopped.geometry.filled > 0.5] == pytest.approx(
        1.0, abs=0.01
    )


def test_it_starts_at_the_friction_of_the_inertial_number_that_breaks_contacts():
    """arctan(mu(I_start) + delta_mu) is 23.70 deg; from arctan(mu_1 + delta_mu) = 23.27 deg on it creeps."""
    below = run_until(inclined_layer(23.5, 0.0), 2.0)
    assert below.state.settled_share[below.geometry.filled > 0.5].min() > 0.99
    above = run_until(inclined_layer(23.9, 0.0), 2.0)
    assert above.state.settled_share[above.geometry.filled > 0.5].min() < 0.5
    assert above.surface_velocity() > 3.0 * below.surface_velocity()


def test_static_friction_shortens_the_run_the_more_the_higher_it_is():
    runs = [
        collapse(0.4, effects__friction_hysteresis={"delta_mu": delta})
        for delta in (0.0, 0.05, 0.2)
    ]
    assert [centre_of_mass(run) for run in runs] == sorted(
        (centre_of_mass(run) for run in runs), reverse=True
    )
    share = runs[1].state.settled_share[runs[1].geometry.filled > 0.5]
    assert share.min() < 0.01
    assert share.max() > 0.99
    assert np.all((share >= 0.0) & (share <= 1.0))
