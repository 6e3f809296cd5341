"""Evidences, bounds and intervals are those of closed forms, and of sums over a fine grid of parameters."""

import numpy as np
import pytest
from fake_signatures import responses, setting, shape
from scipy.special import logsumexp
from scipy.stats import multivariate_normal, multivariate_t, norm

from fvcollapse.diagnosis import quadrature
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.evidence import ModelComparison, compare
from fvcollapse.diagnosis.likelihood import ResponseColumns
from fvcollapse.diagnosis.log_sums import log_sum_exp
from fvcollapse.diagnosis.quadrature import (
    DISCREPANCIES,
    EFFECT_DISCREPANCIES,
    UNKNOWN_DISCREPANCIES,
    Posterior,
    integrate,
    intervals,
    sigma_weights,
)


def linear_log_evidence(gap, slope, covariance, low, high):
    """Logarithm of the mean of N(gap + a slope; 0, C) over a in [low, high], in closed form."""
    inverse = np.linalg.inv(covariance)
    precision = slope @ inverse @ slope
    best = -(slope @ inverse @ gap) / precision
    top = multivariate_normal(cov=covariance).logpdf(gap + best * slope)
    a, b = (low - best) * np.sqrt(precision), (high - best) * np.sqrt(precision)
    inside = np.log(norm.cdf(b) - norm.cdf(a)) if a < 0 else np.log(norm.sf(a) - norm.sf(b))
    return top + 0.5 * np.log(2.0 * np.pi / precision) + inside - np.log(high - low)


@pytest.mark.parametrize("size", [0.003, 0.05, 5.0])
def test_evidence_of_a_linear_response_is_exact(size):
    """Weak, strong, and so strong that the posterior is narrower than the nodes."""
    points, covariance, kernel = setting()
    slope = shape(points, "arms", size)
    rng = np.random.default_rng(1)
    gap = -0.8 * slope + np.linalg.cholesky(covariance) @ rng.standard_normal(len(points))
    found = compare(gap, covariance, kernel, {"arms": Response.of_one_level(slope)}, points)
    weights = sigma_weights(EFFECT_DISCREPANCIES)
    matrices = [covariance + s**2 * kernel for s in EFFECT_DISCREPANCIES]
    for low, high, log_z in (
        (0.15, 2.0, found.hypotheses["arms"].log_evidence),
        (-0.775, 2.925, found.hypotheses["arms"].log_evidence_wide),
    ):
        parts = [linear_log_evidence(gap, slope, each, low, high) for each in matrices]
        assert log_z == pytest.approx(logsumexp(parts + weights), abs=0.01)
    small = matrices[: len(DISCREPANCIES)]
    none = [multivariate_normal(cov=each).logpdf(gap) for each in small]
    expected = logsumexp(none + sigma_weights(DISCREPANCIES))
    assert found.log_evidence()["none"] == pytest.approx(expected, abs=1e-6)
    unknown = [
        multivariate_normal(cov=covariance + s**2 * kernel).logpdf(gap)
        for s in UNKNOWN_DISCREPANCIES
    ]
    expected = logsumexp(unknown) - np.log(4.0)
    assert found.log_evidence()["unknown"] == pytest.approx(expected, abs=1e-6)


def test_evidence_of_two_parameters_is_exact():
    """Where the prior does not cut, the integral over both is that of a Gaussian."""
    points, covariance, kernel = setting()
    slopes = np.array([shape(points, "arms", 0.5), shape(points, "cups", 0.5)])
    levels = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    response = Response(levels, levels @ slopes, np.empty((0, len(points))))
    noise = np.linalg.cholesky(covariance) @ np.random.default_rng(2).standard_normal(len(points))
    gap = -np.array([0.4, 0.7]) @ slopes + noise
    found = compare(gap, covariance, kernel, {"both": response}, points)
    parts = []
    for s in EFFECT_DISCREPANCIES:
        inverse = np.linalg.inv(covariance + s**2 * kernel)
        precision = slopes @ inverse @ slopes.T
        best = np.linalg.solve(precision, -slopes @ inverse @ gap)
        top = multivariate_normal(cov=covariance + s**2 * kernel).logpdf(gap + best @ slopes)
        parts.append(top + np.log(2.0 * np.pi) - 0.5 * np.linalg.slogdet(precision)[1])
    exact = logsumexp(np.array(parts) + sigma_weights(EFFECT_DISCREPANCIES))
    assert found.log_evidence()["both"] == pytest.approx(exact, abs=0.05)
    np.testing.assert_allclose(found.best.u, [0.4, 0.7], atol=0.05)


def test_errors_of_the_emulator_enter_as_a_covariance():
    points, covariance, kernel = setting(1)
    rng = np.random.default_rng(3)
    levels = np.array([[0.0], [0.3], [0.6], [1.0]])
    rough = shape(points, "arms") * levels + 0.004 * rng.standard_normal((4, len(points)))
    response = Response.fit(levels, rough)
    gap = -response.at(np.array([0.45])) + 0.01 * rng.standard_normal(len(points))
    found = compare(gap, covariance, kernel, {"arms": response}, points)
    nodes = (np.arange(128) + 0.5) / 128
    parts = np.empty((128, len(EFFECT_DISCREPANCIES)))
    for i, u in enumerate(nodes[:, None]):
        for j, s in enumerate(EFFECT_DISCREPANCIES):
            total = covariance + s**2 * kernel + response.covariance(u)
            parts[i, j] = multivariate_normal(cov=total).logpdf(gap + response.at(u))
    exact = logsumexp(parts + sigma_weights(EFFECT_DISCREPANCIES)) - np.log(128)
    assert found.log_evidence()["arms"] == pytest.approx(exact, abs=0.01)


def test_a_bound_beyond_is_the_probability_that_it_holds():
    """One bound, correlated with the values: exactly the product of density and probability."""
    points, covariance, kernel = setting(1, (("runout", "upper"),))
    rng = np.random.default_rng(10)
    gap = 0.01 * rng.standard_normal(len(points))
    gap[-1] = 0.03
    levels = np.array([[0.0], [0.4], [1.0]])
    rough = shape(points, "arms") * levels + 0.003 * rng.standard_normal((3, len(points)))
    response = Response.fit(levels, rough)
    found = compare(gap, covariance, kernel, {"arms": response}, points)

    def exact(total, residual):
        inverse = np.linalg.inv(total[:-1, :-1])
        mean = total[-1, :-1] @ inverse @ residual[:-1]
        variance = total[-1, -1] - total[-1, :-1] @ inverse @ total[:-1, -1]
        density = multivariate_normal(cov=total[:-1, :-1]).logpdf(residual[:-1])
        return density + norm.logcdf((mean - residual[-1]) / np.sqrt(variance))

    weights = sigma_weights(DISCREPANCIES)
    none = [exact(covariance + s**2 * kernel, gap) for s in DISCREPANCIES]
    assert found.log_evidence()["none"] == pytest.approx(logsumexp(none + weights), abs=1e-6)
    parts = [
        [
            exact(covariance + s**2 * kernel + response.covariance(u), gap + response.at(u))
            for s in EFFECT_DISCREPANCIES
        ]
        for u in ((np.arange(128) + 0.5) / 128)[:, None]
    ]
    expected = logsumexp(np.array(parts) + sigma_weights(EFFECT_DISCREPANCIES)) - np.log(128)
    assert found.log_evidence()["arms"] == pytest.approx(expected, abs=0.01)


def test_an_interval_holds_the_most_probable_value_and_no_less_than_its_share():
    nodes = (np.arange(1000)[:, None] + 0.5) / 1000
    even = np.zeros(1000)
    falling = Posterior.of(nodes, -nodes / 0.1, even)  # from the end of the prior
    low, high = intervals(falling, nodes[0])
    assert low[0] <= nodes[0, 0] < 0.001
    assert high[0] == pytest.approx(0.1 * np.log(10.0), rel=0.01)
    normal = Posterior.of(nodes, -0.5 * ((nodes - 0.5) / 0.1) ** 2, even)
    low, high = intervals(normal, np.array([0.5]))
    assert [low[0], high[0]] == pytest.approx([0.5 - 0.1645, 0.5 + 0.1645], abs=0.002)
    low, high = intervals(Posterior.of(nodes, nodes / 0.1, even), np.array([0.9999]))
    assert low[0] == pytest.approx(1.0 - 0.1 * np.log(10.0), abs=0.002)
    assert high[0] == 0.9999  # beyond the last node


def test_intervals_are_those_of_a_tempered_likelihood():
    points, covariance, kernel = setting()
    response = responses(points, 0.3)["arms"]
    gap = -response.at(np.array([0.5]))
    comparison = ModelComparison(covariance, kernel, {"arms": response}, points)
    one = comparison.evidence(gap).hypotheses["arms"]
    seen = {sigma: each.see(gap) for sigma, each in comparison.whitened.items()}
    (closure,) = comparison.closures["arms"]
    plain = intervals(integrate(seen, closure, (0.0, 1.0)), one.u)
    width = one.high[0] - one.low[0]
    assert 2.0 * (plain[1][0] - plain[0][0]) < width < 0.9
    assert one.low[0] < 0.5 < one.high[0]


def ridge(seen, closure, nodes, temperature):
    """A likelihood that knows the sum of three quantiles to 1e-4, and nothing else."""
    logs = -0.5 * ((nodes.sum(axis=1) - 1.5) / 1.0e-4) ** 2 / temperature
    return np.column_stack(
        [logs] + [np.full(len(nodes), -np.inf)] * (len(EFFECT_DISCREPANCIES) - 1)
    )


def test_the_evidence_of_a_ridge(monkeypatch):
    monkeypatch.setattr(quadrature, "likelihood", ridge)
    closure = ResponseColumns((0,), (type("R", (), {"dimension": 3})(),), np.empty(0), np.empty(0))
    found = integrate(None, closure, (0.0, 1.0))
    # the density of the sum of three uniform numbers is 3/4 at 1.5
    exact = np.log(0.75 * 1.0e-4 * np.sqrt(2.0 * np.pi))
    assert found.log_evidence == pytest.approx(exact, abs=0.15)
    low, high = intervals(found, found.nodes[np.argmax(found.log_likelihood[:, 0])])
    assert (low < 0.2).all()
    assert (high > 0.8).all()


def test_the_likelihood_at_all_nodes_is_the_normal_density_at_each():
    points, covariance, kernel = setting()
    response = responses(points, 0.3)["bars"]
    comparison = ModelComparison(covariance, kernel, {"bars": response}, points)
    gap = np.random.default_rng(3).normal(0.0, 0.02, len(points))
    seen = {sigma: each.see(gap) for sigma, each in comparison.whitened.items()}
    (closure,) = comparison.closures["bars"]
    nodes = quadrature.first_nodes(1, 0.0, 1.0)
    for _ in range(2):  # the second time with what was remembered
        found = quadrature.likelihood(seen, closure, nodes) - sigma_weights(EFFECT_DISCREPANCIES)
        for row in (0, 50, 127):
            residual = gap + response.at(nodes[row])
            exact = [
                multivariate_normal(
                    cov=covariance + s**2 * kernel + response.covariance(nodes[row])
                )
                for s in EFFECT_DISCREPANCIES
            ]
            expected = [density.logpdf(residual) for density in exact]
            assert found[row] == pytest.approx(expected, abs=1e-6)


def test_densities_and_sums_are_those_of_scipy():
    rng = np.random.default_rng(5)
    factor = np.linalg.cholesky(np.cov(rng.normal(size=(3, 20))))
    apart = rng.normal(size=(50, 3))
    expected = multivariate_t(np.zeros(3), factor @ factor.T, quadrature.RIDGE_TAILS).logpdf(apart)
    assert quadrature.log_density_t(apart, factor) == pytest.approx(expected, rel=1e-12)
    values = rng.normal(0.0, 400.0, (6, 5))
    values[2], values[3, 1] = -np.inf, -np.inf
    assert log_sum_exp(values) == pytest.approx(logsumexp(values), rel=1e-14)
    assert log_sum_exp(values, axis=1) == pytest.approx(logsumexp(values, axis=1), rel=1e-14)
