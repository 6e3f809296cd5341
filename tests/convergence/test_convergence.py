"""The mathematics of a convergence study: exact power laws, and the published worked example."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fvcollapse.studies.convergence import (
    convergence,
    convergence_of_profiles,
    oscillating_share,
    profile_distance,
    spread,
    successive,
)

# Celik et al. (2008), J. Fluids Eng. 130, 078001, Table 1. Cells of the fine, medium and coarse
# grid (two dimensions: sizes are their inverse roots), values, and the published
# (p, extrapolated value, e_a, e_ext, GCI), the last three in per cent.
CELIK = {
    "monotone": ((18000, 8000, 4500), (6.063, 5.972, 5.863), (1.53, 6.1685, 1.5, 1.7, 2.2)),
    "p below 1": ((18000, 4500, 980), (10.7880, 10.7250, 10.6050), (0.75, 10.8801, 0.6, 0.9, 1.1)),
    "oscillatory": ((18000, 4500, 980), (6.0042, 5.9624, 6.0909), (1.51, 6.0269, 0.7, 0.4, 0.5)),
}
FORMAL = 2.0  # of the published examples
ORDERS = st.floats(0.5001, 1.9999)  # of the asymptotic range
ANY_ORDERS = st.floats(0.2, 6.0)
RATIOS = st.floats(1.15, 3.0)


def power_law(limit, constant, order, sizes):
    return [limit + constant * size**order for size in sizes]


@pytest.mark.parametrize("name", CELIK)
def test_published_example(name):
    cells, values, published = CELIK[name]
    found = convergence([n**-0.5 for n in reversed(cells)], list(reversed(values)), FORMAL)
    order, extrapolated, *errors = published
    assert found.order == pytest.approx(order, abs=0.006)
    assert 100 * found.relative_error == pytest.approx(errors[0], abs=0.06)
    if name == "oscillatory":
        # they extrapolate it; the limit of an alternating sequence lies on the other side
        assert found.behaviour == "oscillatory"
        assert found.extrapolated is found.extrapolated_error is None
        assert found.gci == pytest.approx(3.0 * (6.0909 - 5.9624) / 6.0042)
        return
    assert found.behaviour == "monotone"
    assert found.extrapolated == pytest.approx(extrapolated, abs=6e-4)
    assert 100 * found.extrapolated_error == pytest.approx(errors[1], abs=0.06)
    assert 100 * found.gci == pytest.approx(errors[2], abs=0.06)


@given(ORDERS, RATIOS, RATIOS, st.floats(-10, 10), st.sampled_from([-0.1, 0.1]))
def test_power_law_gives_its_order_and_limit(order, r_21, r_32, limit, constant):
    assume(abs(limit + constant) > 1e-3)
    sizes = [r_32 * r_21, r_21, 1.0]
    found = convergence(sizes, power_law(limit, constant, order, sizes), FORMAL)
    assert found.behaviour == "monotone"
    assert found.order == pytest.approx(order, rel=1e-6)
    assert found.extrapolated == pytest.approx(limit, abs=1e-6)
    # with the exact order the index is 1.25 times the true error of the finest value
    assert found.gci == pytest.approx(1.25 * abs(constant / (limit + constant)), rel=1e-5)


@given(st.floats(1.01, 1.99), RATIOS, RATIOS)
def test_index_never_counts_on_more_than_the_formal_order(order, r_21, r_32):
    sizes = [r_32 * r_21, r_21, 1.0]
    values = power_law(1.0, 0.1, order, sizes)
    found, limited = (convergence(sizes, values, formal) for formal in (FORMAL, 1.0))
    assert limited.gci == pytest.approx(1.25 * limited.relative_error / (r_21 - 1.0))
    assert limited.gci > found.gci
    assert limited[:5] == found[:5]


@pytest.mark.parametrize("order", [0.3, 0.45, 2.2, 4.0])
def test_order_outside_the_asymptotic_range_is_flagged_and_extrapolates_nothing(order):
    sizes = [3.0, 2.0, 1.0]
    coarse, medium, fine = values = power_law(1.0, 0.1, order, sizes)
    found = convergence(sizes, values, 1.0)
    assert found.behaviour == "not asymptotic"
    assert found.order == pytest.approx(order)
    assert found.extrapolated is found.extrapolated_error is None
    first_order = medium - fine  # over 2/1 - 1
    expected = 1.25 * max(first_order, coarse - fine) if order > 2.0 else 3.0 * (coarse - fine)
    assert found.gci == pytest.approx(expected / fine)


def test_ratios_on_which_the_plain_iteration_does_not_settle():
    sizes = [80.0, 2.0, 1.0]  # r_32 = 40, the square of r_21 is 4
    found = convergence(sizes, power_law(1.0, 0.3, 1.7, sizes), FORMAL)
    assert found.order == pytest.approx(1.7, rel=1e-9)


@given(ANY_ORDERS, RATIOS, RATIOS, st.floats(-10, 10))
def test_index_of_an_alternating_power_law_covers_its_limit(order, r_21, r_32, limit):
    assume(abs(limit + 1.0) > 1e-3)
    sizes = [r_32 * r_21, r_21, 1.0]
    values = [limit + sign * h**order for sign, h in zip((1, -1, 1), sizes, strict=True)]
    found = convergence(sizes, values, FORMAL)
    assert found.behaviour == "oscillatory"
    assert found.order == pytest.approx(order, rel=1e-6)
    assert found.extrapolated is None
    assert found.gci * abs(values[-1]) > abs(values[-1] - limit)


@given(ANY_ORDERS, RATIOS, RATIOS, st.booleans())
def test_growing_differences_diverge_and_extrapolate_nothing(order, r_21, r_32, alternate):
    sizes = [r_32 * r_21, r_21, 1.0]
    signs = (1, -1, 1) if alternate else (1, 1, 1)
    values = [sign * h**-order for sign, h in zip(signs, sizes, strict=True)]
    found = convergence(sizes, values, FORMAL)
    assert found.behaviour == "diverging"
    assert found.order == pytest.approx(-order, rel=1e-6)
    assert found.extrapolated is found.extrapolated_error is None
    assert found.gci == pytest.approx(3.0 * (max(values) - min(values)) / abs(values[-1]))


def test_logarithm_is_the_border_of_divergence():
    sizes = [6.0, 2.0, 1.0]
    found = convergence(sizes, [1.0 + math.log(h) for h in sizes], FORMAL)
    assert found.order == pytest.approx(0.0, abs=1e-6)


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
    st.lists(st.floats(1e-6, 1e3), min_size=3, max_size=3),
)
def test_any_three_values_give_finite_numbers_or_none(values, sizes):
    sizes = sorted(sizes, reverse=True)
    assume(sizes[0] > sizes[1] * 1.001 > sizes[2] * 1.002)
    found = convergence(sizes, values, FORMAL)
    assert all(number is None or math.isfinite(number) for number in found[1:])


@given(st.floats(1e-3, 1e3), ORDERS)
def test_units_do_not_matter(factor, order):
    sizes = [3.0, 2.0, 1.0]
    values = power_law(2.0, 0.3, order, sizes)
    found = convergence(sizes, values, FORMAL)
    other = convergence([factor * h for h in sizes], [factor * value for value in values], FORMAL)
    assert other.order == pytest.approx(found.order)
    assert other[3:] == pytest.approx(found[3:])


@pytest.mark.parametrize(
    ("values", "behaviour"),
    [
        ((1.0, 1.0, 1.0), "unchanged"),
        ((0.0, 0.0, 0.0), "unchanged"),
        ((1.1, 1.0, 1.0), "undetermined"),
        ((1.1, 1.1, 1.0), "undetermined"),
        ((None, 1.1, 1.0), "missing"),
        ((1.2, 1.1, None), "missing"),
    ],
)
def test_values_without_an_order(values, behaviour):
    found = convergence([3.0, 2.0, 1.0], list(values), FORMAL)
    assert found.behaviour == behaviour
    assert found.order is None
    indices = {"unchanged": 0.0, "undetermined": 3.0 * 0.1, "missing": None}
    assert found.gci == pytest.approx(indices[behaviour])


@pytest.mark.parametrize("sizes", [(1.0, 1.0, 0.5), (1.0, 2.0, 0.5), (2.0, 1.0, 0.0)])
def test_sizes_that_do_not_fall_are_no_refinement(sizes):
    assert convergence(list(sizes), [1.2, 1.1, 1.0], FORMAL).behaviour == "not refined"


def test_successive_triplets_from_coarse_to_fine():
    sizes = [8.0, 4.0, 2.0, 1.0]
    found = successive(convergence, sizes, power_law(1.0, 0.1, 1.5, sizes), FORMAL)
    assert [outcome.order for outcome in found] == pytest.approx([1.5, 1.5])
    assert found[1].gci < found[0].gci
    plain = successive(convergence, None, [1.3, 1.2, 1.1, 1.0], FORMAL)
    assert [outcome.behaviour for outcome in plain] == ["no order"] * 2
    assert plain[1].relative_error == pytest.approx(0.1)


def test_spread_is_the_largest_difference_from_the_last():
    assert spread([1.5, 0.9, 1.0]) == pytest.approx(0.5)
    assert spread([1.5, None, 1.0]) is None
    assert spread([1.0, 0.5, 0.0]) is None


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
def test_successive_profiles_give_order_and_distance_from_the_limit(order, r_21, r_32):
    sizes = [r_32 * r_21, r_21, 1.0]
    x = np.linspace(0.0, 1.0, 51)
    profiles = [(x, 1.0 + 0.1 * h**order * np.cos(6.0 * x)) for h in sizes]
    found = convergence_of_profiles(sizes, profiles, FORMAL)
    assert found.behaviour == "monotone"
    assert found.order == pytest.approx(order, rel=1e-5)
    limit = profile_distance(x, np.ones(51), *profiles[-1])
    assert found.extrapolated_error == pytest.approx(limit, rel=1e-4)
    assert found.gci == pytest.approx(1.25 * limit, rel=1e-4)
    assert found.relative_error == pytest.approx(profile_distance(*profiles[1], *profiles[2]))


def test_profiles_on_grids_of_their_own():
    """Triangles of the same foot, nodes apart: heights 1 + h, area of the finest as unit."""
    profiles = []
    for h, count in ((0.4, 5), (0.2, 9), (0.1, 17)):
        x = np.linspace(0.0, 2.0, count)
        profiles.append((x, (1.0 + h) * (2.0 - x)))
    found = convergence_of_profiles([0.4, 0.2, 0.1], profiles, 1.0)
    assert found.order == pytest.approx(1.0)
    assert found.extrapolated_error == pytest.approx(0.1 / 1.1)


def test_share_of_the_points_that_oscillate():
    x = np.linspace(0.0, 1.0, 11)
    rising = [np.full(11, value) for value in (1.0, 1.2, 1.3)]
    swinging = [np.full(11, value) for value in (1.0, 1.2, 1.1)]
    left = x < 0.45  # 5 of 11 points
    profiles = [(x, np.where(left, a, b)) for a, b in zip(swinging, rising, strict=True)]
    assert oscillating_share(profiles) == pytest.approx(5 / 11)
    bare = [(x, np.where(x > 0.95, 0.0, h)) for _, h in profiles]
    assert oscillating_share(bare) == pytest.approx(5 / 10)
