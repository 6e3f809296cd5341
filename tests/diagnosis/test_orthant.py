"""Probability of several bounds at once, against the exact one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import log_ndtr
from scipy.stats import multivariate_normal

from fvcollapse.diagnosis.orthant import log_normal_tail, log_probability_positive


@given(st.floats(-300.0, 300.0))
def test_the_tail_is_that_of_the_library(z):
    assert log_normal_tail(z) == pytest.approx(log_ndtr(z), rel=1e-7, abs=1e-15)


def test_several_bounds_are_nearly_exact():
    covariance = np.array([[1.0, 0.5, 0.2], [0.5, 2.0, -0.4], [0.2, -0.4, 1.5]])
    side = np.array([1.0, -1.0, 1.0])
    for mean in ([0.5, -0.3, 1.0], [-1.0, 0.2, 0.4], [4.0, 6.0, 5.0]):
        found = log_probability_positive(np.array([mean]), covariance[None], side)[0]
        turned = covariance * np.outer(side, side)
        exact = multivariate_normal(cov=turned).cdf(np.array(mean))
        assert found == pytest.approx(np.log(exact), abs=0.03)


def test_every_row_may_have_its_own_covariance():
    rng = np.random.default_rng(0)
    roots, mean, side = rng.normal(size=(4, 3, 5)), rng.normal(size=(4, 3)), np.ones(3)
    covariance = roots @ roots.transpose(0, 2, 1)
    together = log_probability_positive(mean, covariance, side)
    alone = [
        log_probability_positive(m[None], c[None], side)[0]
        for m, c in zip(mean, covariance, strict=True)
    ]
    assert together == pytest.approx(alone, rel=1e-14)
