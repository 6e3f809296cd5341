"""Bed friction: a block slides, brakes or glides as the weaker bed lets it."""

import math

import pytest
from effect_runs import centre_of_mass, collapse

from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

DEPTH, SPEED, TIME = 0.03, 0.5, 0.1


@pytest.mark.parametrize("mu_bed", [0.0, 0.2, 0.45])
@pytest.mark.parametrize("slope", [0.0, 16.0])
def test_a_block_feels_the_friction_of_the_effect(mu_bed, slope):
    """u = u_0 + g cos a (tan a - mu_b) t while it moves; a rigid block, mu_1 above mu_b."""
    case = layer_case(
        DEPTH / 6,
        DEPTH,
        geometry__slope_angle_deg=slope,
        rheology__mu_1=0.9,
        rheology__mu_2=0.9,
        effects__bed_friction={"mu_bed": mu_bed},
    )
    flow = run_until(layer(case, lambda z: SPEED + 0.0 * z, dt=2e-3, slip=SPEED), TIME)
    gain = exact.gravity_normal(case) * (math.tan(math.radians(slope)) - mu_bed) * TIME
    assert flow.mean_velocity() == pytest.approx(SPEED + gain, abs=1e-4 * SPEED)


def test_the_weaker_the_bed_the_farther_the_grains():
    reached = [
        centre_of_mass(collapse(0.3, effects__bed_friction={"mu_bed": mu}))
        for mu in (0.0, 0.2, 0.35, 0.48)
    ]
    assert all(near > far + 1e-4 for near, far in zip(reached, reached[1:], strict=False))


def test_a_bed_rougher_than_the_grains_changes_little():
    """Documented: above the friction of the sheared grains (mu_2) nothing slides any more."""
    reached = [
        centre_of_mass(collapse(0.3, effects__bed_friction={"mu_bed": mu})) for mu in (0.9, 2.0)
    ]
    assert reached[0] == pytest.approx(reached[1], abs=1e-4)
