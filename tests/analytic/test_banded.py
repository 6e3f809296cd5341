"""The banded factorisation: any symmetric positive matrix whose envelope is given, against a dense solve."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fvcollapse.step.banded import allocate_system, factorise, solve_factorised


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
