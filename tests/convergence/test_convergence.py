"""The mathematics of a convergence study: exact power laws, and the published worked example."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fvcollapse.convergence import convergence, profile_distance, spread, successive

# Celik et al. (2008), J. Fluids Eng. 130, 078001, Table 1. Cells of the fine, medium and coarse
# grid (two dimensions: sizes are their inverse roots), values, and the published
# (p, extrapolated value, e_a, e_ext, GCI), the last three in per cent.
CELIK = {
    "monotone": ((18000, 8000, 4500), (6.063, 5.972, 5.863), (1.53, 6.1685, 1.5, 1.7, 2.2)),
    "p below 1": ((18000, 4500, 980), (10.7880, 10.7250, 10.6050), (0.75, 10.8801, 0.6, 0.9, 1.1)),
    "oscillatory": ((18000, 4500, 980), (6.0042, 5.9624, 6.0909), (1.51, 6.0269, 0.7, 0.4, 0.5)),
}
ORDERS = st.floats(0.2, 6.0)
RATIOS = st.floats(1.15, 3.0)


def power_law(limit, constant, order, sizes):
    return [limit + constant * size**order for size in sizes]


@pytest.mark.parametrize("name", CELIK)
def test_published_example(name):
    cells, values, published = CELIK[name]
    found = convergence([n**-0.5 for n in reversed(cells)], list(reversed(values)))
    order, extrapolated, *errors = published
    assert found.behaviour == ("oscillatory" if name == "oscillatory" else "monotone")
    assert found.order == pytest.approx(order, abs=0.006)
    assert found.extrapolated == pytest.approx(extrapolated, abs=6e-4)
    for number, percent in zip(found[3:6], errors, strict=True):
        assert 100 * number == pytest.approx(percent, abs=0.06)


@given(ORDERS, RATIOS, RATIOS, st.floats(-10, 10), st.sampled_from([-0.1, 0.1]))
def test_power_law_gives_its_order_and_limit(order, r_21, r_32, limit, constant):
    sizes = [r_32 * r_21, r_21, 1.0]
    found = convergence(sizes, power_law(limit, constant, order, sizes), scale=1.0)
    assert found.behaviour == "monotone"
    assert found.order == pytest.approx(order, rel=1e-6)
    assert found.extrapolated == pytest.approx(limit, abs=1e-6)
    # with the exact order the index is 1.25 times the true error of the finest value
    assert found.gci == pytest.approx(1.25 * abs(constant), rel=1e-5)
    limited = found.relative_error * 1.25 / (r_21 ** min(found.order, 2.0) - 1.0)
    assert found.gci_limited == pytest.approx(limited, rel=1e-6)
    assert found.gci_limited >= found.gci


def test_ratios_on_which_the_plain_iteration_does_not_settle():
    sizes = [80.0, 2.0, 1.0]  # r_32 = 40, the square of r_21 is 4
    found = convergence(sizes, power_law(1.0, 0.3, 1.7, sizes))
    assert found.order == pytest.approx(1.7, rel=1e-9)


@given(ORDERS, RATIOS, RATIOS, st.floats(-10, 10))
def test_alternating_power_law_is_oscillatory(order, r_21, r_32, limit):
    sizes = [r_32 * r_21, r_21, 1.0]
    values = [limit + sign * h**order for sign, h in zip((1, -1, 1), sizes, strict=True)]
    found = convergence(sizes, values, scale=1.0)
    assert found.behaviour == "oscillatory"
    assert found.order == pytest.approx(order, rel=1e-6)


@given(ORDERS, RATIOS, RATIOS, st.booleans())
def test_growing_differences_diverge_and_extrapolate_nothing(order, r_21, r_32, alternate):
    sizes = [r_32 * r_21, r_21, 1.0]
    signs = (1, -1, 1) if alternate else (1, 1, 1)
    values = [sign * h**-order for sign, h in zip(signs, sizes, strict=True)]
    found = convergence(sizes, values)
    assert found.behaviour == "diverging"
    assert found.order == pytest.approx(-order, rel=1e-6)
    assert found.extrapolated is found.gci is found.extrapolated_error is None
    assert found.relative_error > 0.0


def test_logarithm_is_the_border_of_divergence():
    sizes = [6.0, 2.0, 1.0]
    found = convergence(sizes, [math.log(h) for h in sizes], scale=1.0)
    assert found.order == pytest.approx(0.0, abs=1e-6)


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
    st.lists(st.floats(1e-6, 1e3), min_size=3, max_size=3),
)
def test_any_three_values_give_finite_numbers_or_none(values, sizes):
    sizes = sorted(sizes, reverse=True)
    assume(sizes[0] > sizes[1] * 1.001 > sizes[2] * 1.002)
    found = convergence(sizes, values)
    assert all(number is None or math.isfinite(number) for number in found[1:])


@given(st.floats(1e-3, 1e3), st.floats(0.5, 3.0))
def test_units_do_not_matter(factor, order):
    sizes = [3.0, 2.0, 1.0]
    values = power_law(2.0, 0.3, order, sizes)
    found = convergence(sizes, values)
    other = convergence([factor * h for h in sizes], [factor * value for value in values])
    assert other.order == pytest.approx(found.order)
    assert other[3:] == pytest.approx(found[3:])


@pytest.mark.parametrize(
    ("values", "behaviour"),
    [
        ((1.0, 1.0, 1.0), "unchanged"),
        ((0.0, 0.0, 0.0), "unchanged"),
        ((1.1, 1.0, 1.0), "undetermined"),
        ((1.1, 1.1, 1.0), "undetermined"),
        ((None, 1.1, 1.0), "undetermined"),
        ((1.2, 1.1, None), "undetermined"),
    ],
)
def test_values_without_an_order(values, behaviour):
    found = convergence([3.0, 2.0, 1.0], list(values))
    assert found.behaviour == behaviour
    assert found.order is None
    assert found.gci == (0.0 if behaviour == "unchanged" else None)


@pytest.mark.parametrize("sizes", [(1.0, 1.0, 0.5), (1.0, 2.0, 0.5), (2.0, 1.0, 0.0)])
def test_sizes_that_do_not_fall_are_no_refinement(sizes):
    assert convergence(list(sizes), [1.2, 1.1, 1.0]).behaviour == "not refined"


def test_successive_triplets_from_coarse_to_fine():
    sizes = [8.0, 4.0, 2.0, 1.0]
    found = successive(sizes, power_law(1.0, 0.1, 2.0, sizes))
    assert [outcome.order for outcome in found] == pytest.approx([2.0, 2.0])
    assert found[1].gci < found[0].gci
    plain = successive(None, [1.3, 1.2, 1.1, 1.0])
    assert [outcome.behaviour for outcome in plain] == ["no order"] * 2
    assert plain[1].relative_error == pytest.approx(0.1)


def test_spread_is_the_largest_difference_from_the_last():
    assert spread([1.5, 0.9, 1.0]) == pytest.approx(0.5)
    assert spread([1.5, None, 1.0]) is None
    assert spread([1.0, 0.5, 0.0]) is None
    assert spread([1.0, 0.5, 0.0], scale=2.0) == 0.5


# -- profiles ------------------------------------------------------------------------------------


def test_distance_of_crossing_profiles_is_exact():
    # triangles of area 1/2 that cross in the middle: twice two triangles of 1/2 * 1 * 1/2
    up, down = np.array([0.0, 1.0]), np.array([1.0, 0.0])
    assert profile_distance(np.array([0, 1.0]), up, np.array([0, 1.0]), down) == pytest.approx(1.0)


@given(st.integers(2, 40), st.floats(0.1, 3.0))
def test_distance_of_rectangular_shift(count, height):
    """The same profile on another grid is at distance zero; a taller one at its excess."""
    x, fine = np.linspace(0.0, 2.0, count), np.linspace(0.0, 2.0, 3 * count)
    h, h_fine = height * (2.0 - x), height * (2.0 - fine)
    assert profile_distance(x, h, fine, h_fine) == pytest.approx(0.0, abs=1e-12)
    assert profile_distance(x, 1.1 * h, fine, h_fine) == pytest.approx(0.1)


@given(ORDERS, RATIOS, RATIOS)
def test_distances_to_the_finest_profile_keep_order_and_limit(order, r_21, r_32):
    sizes = [r_32 * r_21, r_21, 1.0]
    x = np.linspace(0.0, 1.0, 51)
    profiles = [1.0 + 0.1 * h**order * np.cos(6.0 * x) for h in sizes]
    distances = [profile_distance(x, h, x, profiles[-1]) for h in profiles]
    found = convergence(sizes, distances, scale=1.0)
    assert found.order == pytest.approx(order, rel=1e-5)
    limit = profile_distance(x, np.ones(51), x, profiles[-1])
    assert -found.extrapolated == pytest.approx(limit, rel=1e-4)
