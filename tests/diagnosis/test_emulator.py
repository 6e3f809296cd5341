"""Emulator: polynomials exactly, its own error honestly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import qmc

from fvcollapse.diagnosis.emulator import Response

LEVELS = {
    1: np.array([[0.15], [0.5], [1.0]]),
    2: np.random.default_rng(2).random((9, 2)),
    3: np.random.default_rng(3).random((15, 3)),
}


@pytest.mark.parametrize("dimension", LEVELS)
@given(seed=st.integers(0, 1000))
def test_quadratic_responses_are_exact(dimension, seed):
    rng = np.random.default_rng(seed)
    constant, linear = rng.standard_normal((1, 5)), rng.standard_normal((dimension, 5))
    square = rng.standard_normal((dimension, dimension, 5))

    def truth(u):
        return constant + u @ linear + np.einsum("qi,qj,ijn->qn", u, u, square)

    levels = LEVELS[dimension]
    response = Response.fit(levels, truth(levels))
    u = rng.random((20, dimension))
    np.testing.assert_allclose(response.at(u), truth(u), atol=1.0e-7)
    np.testing.assert_allclose(response.at(u[0]), truth(u)[0], atol=1.0e-7)


def test_levels_are_met_without_error():
    levels = np.random.default_rng(0).random((7, 2))
    differences = np.random.default_rng(1).standard_normal((7, 4))
    response = Response.fit(levels, differences)
    np.testing.assert_allclose(response.at(levels), differences, atol=1.0e-6)
    for u in levels:
        assert np.abs(response.covariance(u)).max() < 1.0e-6


def test_off_is_a_level_of_no_difference():
    response = Response.fit([[0.3], [0.8]], [[3.0], [8.0]], off=[0.0])
    np.testing.assert_allclose(response.at(np.array([[0.0], [0.5]])), [[0.0], [5.0]], atol=1e-9)
    lone = Response.fit([[0.5]], [[2.0]], off=[-1.0])
    np.testing.assert_allclose(lone.at(np.array([[-1.0], [0.5]])), [[0.0], [2.0]], atol=1e-9)


def test_one_level_is_not_enough_without_off():
    with pytest.raises(ValueError, match="two levels"):
        Response.fit([[0.5]], [[1.0]])


def test_one_level_with_a_free_amplitude():
    response = Response.of_one_level([1.0, -2.0])
    ends = response.at(np.array([[0.0], [1.0]]))
    np.testing.assert_allclose(ends, [[0.15, -0.30], [2.0, -4.0]], atol=1e-9)
    assert not response.covariance(np.array([0.4])).any()


@pytest.mark.parametrize(("dimension", "count"), [(1, 3), (2, 7), (3, 9), (4, 11), (2, 16)])
def test_error_covers_what_the_emulator_misses(dimension, count):
    """Saturating responses of random steepness: nine in ten errors inside 1.645 standard deviations."""
    covered = []
    for case in range(60):
        rng = np.random.default_rng(case)
        levels = qmc.Sobol(dimension, seed=case).random(16)[:count]
        direction, steep = rng.random((dimension, 30)), rng.uniform(0.3, 1.5, 30)

        def truth(u, direction=direction, steep=steep):
            return np.tanh(steep * (u @ direction))

        response = Response.fit(levels, truth(levels))
        u = rng.random((5, dimension))
        error = np.abs(response.at(u) - truth(u))
        deviation = np.sqrt([np.diag(response.covariance(each)) for each in u])
        covered.append(error <= 1.645 * deviation)
    assert np.mean(covered) >= 0.87


def test_error_grows_away_from_the_levels():
    levels = np.array([[0.15], [0.4], [0.7], [1.0]])
    response = Response.fit(levels, np.tanh(3.0 * levels))
    near, between, outside = (response.covariance(np.array([u]))[0, 0] for u in (0.41, 0.55, 1.4))
    assert near < between < outside
