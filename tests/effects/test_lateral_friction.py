"""Lateral walls: their pressure K_w p and the weakening of their friction with depth, on a rigid block."""

import math

import pytest
from effect_runs import centre_of_mass, collapse, same_to_the_last_bit

from fvcollapse.step.rheology import material
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

DEPTH, WIDTH, MU_WALL, SPEED, TIME = 0.03, 0.10, 0.18, 1.0, 0.2


def block(cells, **walls):
    """A rigid block (mu_1 = 0.9) that slides at 1 m/s down 16 deg between lateral walls."""
    return layer_case(
        DEPTH / cells,
        DEPTH,
        geometry__slope_angle_deg=16.0,
        geometry__channel_width=WIDTH,
        rheology__mu_1=0.9,
        rheology__mu_2=0.9,
        effects__lateral_friction={"mu_wall": MU_WALL, **walls},
    )


def speed_after(case, scheme="implicit"):
    case = case.replace(**{"effects.lateral_friction.scheme": scheme})
    flow = layer(case, lambda z: SPEED + 0.0 * z, dt=2e-3, slip=SPEED)
    return run_until(flow, TIME).mean_velocity()


def wall_loss(case, moment):
    """Speed lost to both walls, 2 mu_w/(w H) g cos a `moment` t; the moment is the integral of y f(y) dy."""
    return exact.gravity_normal(case) * 2.0 * MU_WALL / (WIDTH * DEPTH) * moment * TIME


def exact_speed(case, moment):
    """Speed of the block after `TIME`, m/s."""
    bed = exact.slope_ratio(case) - case.boundary.mu_bed
    return SPEED + exact.gravity_normal(case) * bed * TIME - wall_loss(case, moment)


@pytest.mark.parametrize("scheme", ["implicit", "split"])
@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.3])
def test_walls_bear_the_given_part_of_the_pressure(ratio, scheme):
    case, moment = block(6, pressure_ratio=ratio), 0.5 * DEPTH**2 * ratio
    allowed = 1e-3 * wall_loss(case, moment) + 1e-4  # of the walls; and creep
    assert speed_after(case, scheme) == pytest.approx(exact_speed(case, moment), abs=allowed)


def test_older_closure_bears_it_too():
    walls = {"closure": "friction_increase", "pressure_ratio": 0.5}
    raised = material(block(6, **walls).resolved).mu_1
    assert raised == pytest.approx(0.9 + 0.5 * MU_WALL * 0.05 / WIDTH, rel=1e-12)


def weakened_moment(deep_ratio, length):
    """Integral of y (r + (1 - r) exp(-y/l)) over the depth."""
    part = length**2 - length * (length + DEPTH) * math.exp(-DEPTH / length)
    return 0.5 * deep_ratio * DEPTH**2 + (1.0 - deep_ratio) * part


@pytest.mark.parametrize("scheme", ["implicit", "split"])
@pytest.mark.parametrize(("deep_ratio", "length"), [(0.0, 0.01), (0.2, 0.02), (0.6, 0.005)])
def test_friction_weakens_with_depth(deep_ratio, length, scheme):
    """Second order in the cell: 12 cells in the depth, at least 2 in the depth of weakening."""
    walls = {"closure": "sink_weakening", "deep_ratio": deep_ratio, "weakening_depth": length}
    case = block(12, **walls)
    moment = weakened_moment(deep_ratio, length)
    allowed = 0.01 * wall_loss(case, moment)
    assert speed_after(case, scheme) == pytest.approx(exact_speed(case, moment), abs=allowed)


def collapsed(**walls):
    return collapse(0.3, effects__lateral_friction=walls)


def test_no_weakening_is_the_sink_to_the_last_bit():
    weakening = {"closure": "sink_weakening", "deep_ratio": 1.0}
    assert same_to_the_last_bit(collapsed(**weakening), collapsed())
    assert same_to_the_last_bit(collapsed(pressure_ratio=1.0), collapsed())


def test_weaker_walls_let_the_grains_go_farther():
    reached = [centre_of_mass(collapsed(pressure_ratio=ratio)) for ratio in (0.0, 0.5, 1.0, 2.0)]
    assert all(far > near + 1e-4 for far, near in zip(reached, reached[1:], strict=False))
    reached = [
        centre_of_mass(collapsed(closure="sink_weakening", deep_ratio=ratio))
        for ratio in (0.0, 0.5, 1.0)
    ]
    assert all(far > near + 1e-4 for far, near in zip(reached, reached[1:], strict=False))
