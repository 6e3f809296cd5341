"""Effects of the observation and errors of the set-up: what they do to the curves, and nothing else."""

import math

import hypothesis.strategies as st
import numpy as np
import pytest
from effect_runs import collapse, same_to_the_last_bit
from hypothesis import given, settings

from fvcollapse import observe, run
from fvcollapse.case.case import Case
from fvcollapse.effects.front_saltation import correlated_scatter
from fvcollapse.errors import CaseError
from fvcollapse.measure.observation import flow_case, seen_front
from fvcollapse.measure.series_readings import front_velocity, peak_front_velocity
from fvcollapse.step.grid import gate_column, spacing
from fvcollapse.verification.flows import layer, layer_case, run_until

SHORT = {"grid.cell_size": 0.02, "time.end": 0.3, "time.output_interval": 0.05}


def observed(**effects):
    return observe(run(Case().replace(**SHORT, **effects)))


@pytest.fixture(scope="module")
def result():
    return run(Case().replace(**SHORT))


@pytest.fixture(scope="module")
def plain(result):
    return observe(result)


# -- saltation ---------------------------------------------------------------------------------


def case_with(name, **keys):
    return Case().replace(**{f"effects.{name}": keys})


def test_bias_sets_in_over_the_first_height_of_the_column():
    front = np.array([0.15, 0.20, 0.27, 0.34, 0.8])  # gate at 0.20, height 0.14 m
    seen = seen_front(np.arange(5.0), front, case_with("front_saltation", bias=0.02))
    assert seen - front == pytest.approx([0.0, 0.0, 0.01, 0.02, 0.02], abs=1e-15)


def test_scatter_has_unit_variance_and_the_stated_correlation():
    """Means over 2000 seeds, each 2 % at one standard deviation; a Gaussian has a kurtosis of 3."""
    time = np.array([0.0, 0.02, 0.1])
    scatter = np.array([correlated_scatter(time, 0.05, seed) for seed in range(2000)])
    correlation = scatter.T @ scatter / len(scatter)
    expected = np.exp(-np.abs(time[:, None] - time) / 0.05)
    assert correlation == pytest.approx(expected, abs=0.08)
    assert (scatter**4).mean() == pytest.approx(3.0, abs=0.3)


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32), steps=st.integers(2, 60))
def test_scatter_is_that_of_its_seed_whatever_the_time_steps(seed, steps):
    coarse, fine = np.linspace(0.0, 1.0, steps), np.linspace(0.0, 1.0, 3 * steps - 2)
    scatter = correlated_scatter(fine, 0.05, seed)
    assert correlated_scatter(coarse, 0.05, seed) == pytest.approx(scatter[::3], abs=1e-9)
    assert np.abs(scatter - correlated_scatter(fine, 0.05, seed + 1)).max() > 1e-3


def test_when_the_front_has_stopped_so_have_its_beads():
    time = np.linspace(0.0, 1.0, 101)
    front = np.minimum(0.2 + time, 0.7)
    seen = seen_front(time, front, case_with("front_saltation", spread=0.01))
    assert np.ptp(seen[time > 0.5]) == 0.0
    assert np.diff((seen - front)[(time > 0.2) & (time < 0.49)]).std() > 1e-4


@settings(max_examples=30)
@given(
    bias=st.floats(-0.1, 0.1),
    more=st.floats(0.0, 0.1),
    spread=st.floats(0.0, 0.05),
    seed=st.integers(0, 1000),
)
def test_the_seen_front_grows_with_the_bias(bias, more, spread, seed):
    time, front = np.linspace(0.0, 1.0, 40), np.linspace(0.2, 0.9, 40)
    keys = {"spread": spread, "seed": seed}
    less = seen_front(time, front, case_with("front_saltation", bias=bias, **keys))
    ahead = seen_front(time, front, case_with("front_saltation", bias=bias + more, **keys))
    assert (ahead >= less - 1e-12).all()
    assert ahead[-1] - less[-1] == pytest.approx(more, abs=1e-12)


def test_velocity_is_that_of_the_seen_front(plain, result):
    """A bias sets in over 14 cm: 1 + 2/14 times the velocity of the front, while it travels them."""
    case = result.case.replace(**{"effects.front_saltation": {"bias": 0.02}})
    seen = observe(result, case=case)
    peak, plain_peak = (each.scalars["peak_front_velocity"] for each in (seen, plain))
    assert plain_peak == peak_front_velocity(result.time, result.front_velocity)[0]
    expected = peak_front_velocity(*front_with_velocity(seen.front))[0]
    assert peak == expected
    assert 1.05 * plain_peak < peak < 1.15 * plain_peak


def front_with_velocity(front):
    return front[:, 0], front_velocity(*front.T)


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("front_saltation", {"bias": 0.01, "spread": 0.01}),
        ("time_origin", {"offset": 0.03}),
        ("transverse_profile", {"view": "wall", "velocity_ratio": 1.3}),
    ],
)
def test_one_run_serves_all_that_is_only_seen(name, keys):
    """The run of the case itself and that of its flow give the same observations."""
    case = case_with(name, **keys).replace(**SHORT)
    own, shared = observe(run(case)), observe(run(flow_case(case)), case=case)
    assert own.scalars == shared.scalars
    for curve in ("front", "profiles", "volume", "interface"):
        assert np.array_equal(getattr(own, curve), getattr(shared, curve))


def test_a_case_that_changes_the_flow_keeps_its_run():
    case = case_with("gate", mu_gate=0.2)
    assert flow_case(case) == case


def test_saltation_moves_the_front_and_nothing_else(plain):
    ahead = observed(**{"effects.front_saltation": {"bias": 0.02}})
    assert ahead.scalars["runout"] == pytest.approx(plain.scalars["runout"] + 0.02, abs=1e-12)
    for name in ("profiles", "volume", "interface"):
        assert np.array_equal(getattr(ahead, name), getattr(plain, name))
    biases = [-0.02, 0.0, 0.01, 0.02]
    runouts = [
        observed(**{"effects.front_saltation": {"bias": b}}).scalars["runout"] for b in biases
    ]
    assert runouts == sorted(runouts)


# -- errors of the set-up ----------------------------------------------------------------------


def test_clock_that_starts_late_shifts_every_curve(plain):
    late = observed(**{"effects.time_origin": {"offset": 0.02}})
    for name in ("front", "profiles", "volume", "interface"):
        there, here = getattr(late, name), getattr(plain, name)
        assert there[:, 0] == pytest.approx(here[:, 0] - 0.02, abs=1e-15)
        assert np.array_equal(there[:, 1:], here[:, 1:])


def test_tilt_is_another_slope_to_the_last_bit():
    tilted = collapse(0.1, effects__tilt={"angle_deg": 0.5})
    assert same_to_the_last_bit(tilted, collapse(0.1, geometry__slope_angle_deg=16.5))


@pytest.mark.parametrize("angle", [-0.5, -3.0])
def test_a_level_bed_may_tilt_upwards(angle):
    """A block then brakes by friction and weight, u = u_0 - g (mu_b cos a + sin a) t; another rests."""
    case = layer_case(
        0.005,
        0.03,
        geometry__slope_angle_deg=0.0,
        rheology__mu_1=0.9,
        rheology__mu_2=0.9,
        effects__bed_friction={"mu_bed": 0.2},
    )
    flow = layer(tilted_by(case, angle), lambda z: 0.5 + 0.0 * z, dt=2e-3, slip=0.5)
    a = math.radians(-angle)
    loss = 9.81 * (0.2 * math.cos(a) + math.sin(a)) * 0.1
    assert run_until(flow, 0.1).mean_velocity() == pytest.approx(0.5 - loss, abs=5e-5)
    column = collapse(
        0.05, geometry__slope_angle_deg=0.0, gate__speed=0.0, effects__tilt={"angle_deg": angle}
    )
    assert column.max_speed() < 1e-4


def tilted_by(case, angle):
    return case.replace(**{"effects.tilt": {"angle_deg": angle}})


def test_height_of_the_column_is_another_height_to_the_last_bit():
    taller = collapse(0.1, effects__column_size={"height": 0.003})
    assert same_to_the_last_bit(taller, collapse(0.1, geometry__height_0=0.14 + 0.003))


@pytest.mark.parametrize("error", [-0.011, 0.004, 0.019])
def test_another_length_keeps_the_number_of_cells(error):
    case = case_with("column_size", length=error).resolved
    assert gate_column(case) == gate_column(Case())
    dx, dz = spacing(case)
    assert dx * gate_column(case) == pytest.approx(0.20 + error, rel=1e-12)
    assert dz == Case().grid.cell_size


def test_responses_are_monotone():
    """A steeper bed, a higher and a longer column: each runs out farther, beyond its own gate."""

    def runout(**effects):
        return observed(**effects).scalars["runout"]

    tilts = [runout(**{"effects.tilt": {"angle_deg": angle}}) for angle in (-1.0, 0.0, 1.0)]
    heights = [runout(**{"effects.column_size": {"height": h}}) for h in (-0.01, 0.0, 0.01)]
    lengths = [runout(**{"effects.column_size": {"length": s}}) for s in (-0.01, 0.0, 0.01)]
    for values in (tilts, heights, lengths):
        assert all(low < high - 1e-4 for low, high in zip(values, values[1:], strict=False))


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"effects.tilt": {"angle_deg": 3.5}}, "effects.tilt.angle_deg"),
        ({"effects.tilt": {"angle_deg": math.nan}}, "effects.tilt.angle_deg"),
        ({"effects.front_saltation": {"spread": -0.01}}, "effects.front_saltation.spread"),
        (
            {"effects.front_saltation": {"correlation_time": 0.0}},
            "effects.front_saltation.correlation_time",
        ),
        ({"effects.front_saltation": {"seed": 1.5}}, "effects.front_saltation.seed"),
        ({"effects.time_origin": {"offset": math.inf}}, "effects.time_origin.offset"),
        ({"effects.time_origin": {"shift": 0.1}}, "effects.time_origin.shift"),
        ({"effects.column_size": {"height": -0.13}}, "effects.column_size.height"),
        ({"effects.column_size": {"length": -0.2}}, "effects.column_size.length"),
        (
            {"effects.column_size": {"length": 0.1}, "boundary.domain_length": 0.25},
            "boundary.domain_length",
        ),
        (
            {
                "gate.speed": math.inf,
                "effects.gate": {"speed": 1.0},
                "geometry.polygon": [[0, 0], [0.3, 0], [0, 0.14]],
            },
            "geometry.polygon",
        ),
    ],
)
def test_refused(changes, key):
    with pytest.raises(CaseError) as caught:
        Case().replace(**changes)
    assert caught.value.key == key
    assert "\n" not in str(caught.value)
