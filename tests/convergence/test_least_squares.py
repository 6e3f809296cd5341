"""Power series fitted to four or more values: exact series, scatter, and what cannot be fitted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fvcollapse.studies.least_squares import fit

SIZES = [6.0, 4.0, 3.0, 2.0]


@given(st.floats(0.55, 1.95), st.sampled_from([-0.3, 0.1]))
def test_exact_power_law(order, constant):
    values = [5.0 + constant * h**order for h in SIZES]
    found = fit(SIZES, values)
    assert found.series == "h^p"
    assert found.order == pytest.approx(order, abs=1e-3)
    assert found.extrapolated == pytest.approx(5.0, abs=3e-3)
    # no scatter: the index of three grids is recovered, 1.25 times the error
    error = abs(values[-1] - 5.0) / abs(values[-1])
    assert found.uncertainty == pytest.approx(1.25 * error, rel=2e-2)


def at(found, h):
    return found.extrapolated + sum(a * h**p for p, a in found.coefficients)


@pytest.mark.parametrize("order", [0.9, 1.6, 3.0, 0.2])
def test_coefficients_belong_to_the_sizes(order):
    values = [5.0 + 0.1 * h**order for h in SIZES]
    found = fit(SIZES, values)
    assert at(found, SIZES[-1]) == pytest.approx(values[-1], rel=0.2)
    scaled = fit([1e-3 * h for h in SIZES], values)
    assert scaled.uncertainty == pytest.approx(found.uncertainty, rel=1e-6)
    assert at(scaled, 2e-3) == pytest.approx(at(found, 2.0), rel=1e-6)


def test_too_fast_values_are_given_a_second_order_and_three_times_the_error():
    values = [1.0 + 1e-3 * h**4 for h in SIZES]
    found = fit(SIZES, values)
    assert found.order == pytest.approx(4.0, abs=0.01)
    assert found.series == "h^2"
    finest = at(found, 2.0)
    error = abs(finest - found.extrapolated)
    parts = 3.0 * error + found.deviation * values[-1] + abs(values[-1] - finest)
    assert found.uncertainty * values[-1] == pytest.approx(parts)


def test_too_slow_values_are_fitted_by_fixed_exponents():
    values = [1.0 + 0.1 * h**0.1 for h in SIZES]
    found = fit(SIZES, values)
    assert found.order == pytest.approx(0.1, abs=0.02)
    assert found.series == "h + h^2"


def test_scatter_beyond_the_range_of_the_data():
    """Values that jump up and down: nothing fits, and the uncertainty exceeds their range."""
    values = [1.00, 1.02, 1.00, 1.02]
    found = fit(SIZES, values)
    assert found.uncertainty > 0.02


@given(st.lists(st.floats(0.5, 2.0), min_size=4, max_size=7))
def test_any_values_give_finite_numbers_or_nothing(values):
    sizes = list(np.linspace(6.0, 2.0, len(values)))
    found = fit(sizes, values)
    if found is not None:
        numbers = [found.order, found.extrapolated, found.deviation, found.uncertainty]
        assert np.isfinite(numbers).all()
        assert found.uncertainty >= found.deviation >= 0.0


@pytest.mark.parametrize(
    ("sizes", "values"),
    [
        (None, [1.0, 1.1, 1.2, 1.3]),
        (SIZES[:3], [1.3, 1.2, 1.1]),
        (SIZES, [1.3, None, 1.1, 1.0]),
        (SIZES, [1.0, 1.0, 1.0, 1.0]),
        ([6.0, 4.0, 4.0, 2.0], [1.3, 1.2, 1.1, 1.0]),
        (SIZES, [0.3, 0.2, 0.1, 0.0]),
    ],
)
def test_nothing_to_fit(sizes, values):
    assert fit(sizes, values) is None
