"""The banded factorisation: any symmetric positive matrix whose envelope is given, against a dense solve."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import cholesky_banded

from fvcollapse.step.banded import WIDE, allocate_system, factorise, solve_factorised


def random_system(n, width, seed):
    """Band, envelope and dense form of a diagonally dominant matrix with columns of random height."""
    random = np.random.default_rng(seed)
    heights = random.integers(0, width + 1, n)
    ends = np.maximum.accumulate(np.minimum(np.arange(n) + heights, n - 1))
    (band, rhs), dense = allocate_system(ends), np.zeros((n, n))
    for c in range(n):
        size = ends[c] - c
        band[c, 1 : size + 1] = random.normal(size=size)
        band[c, 0] = 4.0 * (width + 1)
        dense[c : ends[c] + 1, c] = dense[c, c : ends[c] + 1] = band[c, : size + 1]
    return band, rhs, ends, dense


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 60), st.integers(0, 20), st.integers(0, 10**6))
def test_solution_is_that_of_the_dense_matrix(n, width, seed):
    """A x = b to round-off, for n below, at and above the four pivots eliminated together."""
    band, solution, ends, dense = random_system(n, width, seed)
    rhs = np.random.default_rng(seed + 1).normal(size=n)
    solution[:n] = rhs
    assert factorise(band, ends) == 0
    solve_factorised(solution, band, ends)
    assert np.abs(dense @ solution[:n] - rhs).max() < 1e-13 * n
    assert not solution[n:].any()  # the lanes behind the last unknown
    assert not band.any()  # ready for the next matrix


@settings(max_examples=15, deadline=None)
@given(st.integers(WIDE, 3 * WIDE), st.integers(WIDE - 8, 2 * WIDE), st.integers(0, 10**6))
def test_solution_is_that_of_the_dense_matrix_where_the_band_is_wide(n, width, seed):
    """Panels of pivots, beside groups of four where the envelope is narrow and at the end."""
    test_solution_is_that_of_the_dense_matrix.hypothesis.inner_test(n, width, seed)


@pytest.mark.parametrize("rows", [2 * WIDE, 2 * WIDE + 7])
def test_panels_leave_what_pivots_one_by_one_leave(rows):
    """A full band, as of a column of grains: the factors agree with those of LAPACK."""
    ends = np.minimum(np.arange(rows) + WIDE + 5, rows - 1)
    band, _ = allocate_system(ends)
    height = WIDE + 6
    for c, end in enumerate(ends):
        band[c, : end - c + 1] = np.cos(np.arange(end - c + 1) + c) / (1.0 + np.arange(end - c + 1))
        band[c, 0] = 30.0
    lower = cholesky_banded(band[:rows, :height].T, lower=True)
    assert factorise(band, ends) == 0
    for c, end in enumerate(ends):
        root = np.sqrt(band[c, 0])  # 1/D and D L are kept
        np.testing.assert_allclose(
            band[c, 1 : end - c + 1] * root, lower[1 : end - c + 1, c], atol=1e-13
        )
        assert not band[c, end - c + 1 :].any()


@pytest.mark.parametrize("bad", [0, 5, 17, WIDE + 3])
def test_a_pivot_in_a_panel_that_is_not_positive_is_named(bad):
    ends = np.minimum(np.arange(2 * WIDE) + WIDE, 2 * WIDE - 1)
    band, _ = allocate_system(ends)
    band[: ends.size, 0] = 1.0
    band[bad, 0] = -1.0
    assert factorise(band, ends) == bad + 1


@pytest.mark.parametrize("bad", [0, 3, 4, 9, 10])
def test_a_pivot_that_is_not_positive_is_named(bad):
    band, _, ends, _ = random_system(11, 3, 0)
    band[bad, 0] = np.nan if bad == 3 else -50.0
    assert factorise(band, ends) == bad + 1


def test_a_system_without_room_behind_is_refused():
    """The lanes would write beyond the end of the arrays."""
    band, rhs, ends, _ = random_system(11, 3, 0)
    with pytest.raises(IndexError):
        factorise(band[:11], ends)
    with pytest.raises(IndexError):
        solve_factorised(rhs[:11], band, ends)
