"""Effects of the observation and errors of the set-up: what they do to the curves, and nothing else."""

import math

import numpy as np
import pytest
from effect_runs import collapse, same_to_the_last_bit

from fvcollapse import observe, run
from fvcollapse.case import Case
from fvcollapse.effects import with_effects
from fvcollapse.errors import CaseError
from fvcollapse.grid import gate_column, spacing
from fvcollapse.observation import correlated_scatter, seen_front

SHORT = {"grid.cell_size": 0.02, "time.end": 0.3, "time.output_interval": 0.05}


def observed(**effects):
    return observe(run(Case().replace(**SHORT, **effects)))


@pytest.fixture(scope="module")
def plain():
    return observed()


# -- saltation ---------------------------------------------------------------------------------


def case_with(name, **keys):
    return Case().replace(**{f"effects.{name}": keys})


def test_bias_sets_in_over_the_first_height_of_the_column():
    front = np.array([0.15, 0.20, 0.27, 0.34, 0.8])  # gate at 0.20, height 0.14 m
    seen = seen_front(np.arange(5.0), front, case_with("front_saltation", bias=0.02))
    assert seen - front == pytest.approx([0.0, 0.0, 0.01, 0.02, 0.02], abs=1e-15)


def test_scatter_has_unit_variance_and_the_stated_correlation():
    """Means over 20 000 independent correlation times: 1 % at one standard deviation."""
    step, correlation_time = 0.02, 0.05
    scatter = correlated_scatter(step * np.arange(100_000), correlation_time, seed=3)
    assert scatter.std() == pytest.approx(1.0, abs=0.03)
    correlation = (scatter[1:] * scatter[:-1]).mean()
    assert correlation == pytest.approx(math.exp(-step / correlation_time), abs=0.03)


def test_scatter_is_that_of_its_seed():
    time = np.linspace(0.0, 1.0, 50)
    first, again, other = (correlated_scatter(time, 0.05, seed) for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert np.abs(first - other).max() > 0.1


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


def test_height_of_the_column_is_another_height_to_the_last_bit():
    taller = collapse(0.1, effects__column_size={"height": 0.003})
    assert same_to_the_last_bit(taller, collapse(0.1, geometry__height_0=0.14 + 0.003))


@pytest.mark.parametrize("error", [-0.011, 0.004, 0.019])
def test_another_length_keeps_the_number_of_cells(error):
    case = with_effects(case_with("column_size", length=error))
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
        ({"effects.tilt": {"angle_deg": 9.0}}, "effects.tilt.angle_deg"),
        ({"effects.tilt": {"angle_deg": -23.0}}, "effects.tilt.angle_deg"),
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
