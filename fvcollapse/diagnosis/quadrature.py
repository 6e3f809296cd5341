"""Integrals of the likelihood over the parameters of an effect and the size of the discrepancy.

p(D | k) = sum_s w_s  integral over [0, 1]^d of  N(gap + Delta_k(u); 0, C_k(s, u)) du
"""

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.special import chdtri, gammaln, ndtri
from scipy.stats import qmc

from fvcollapse.diagnosis.log_sums import log_sum_exp
from fvcollapse.diagnosis.node_likelihood import stack_of

if TYPE_CHECKING:
    from fvcollapse.diagnosis.likelihood import ResponseColumns, Seen

DISCREPANCIES = np.array([0.05, 0.1, 0.2, 0.4, 0.8])  # where nothing acts
# where an effect acts: its closure is not that of real grains, so that with it more may be left
EFFECT_DISCREPANCIES = np.array([0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2])
UNKNOWN_DISCREPANCIES = np.array([1.0, 2.0, 4.0, 8.0])
CAUCHY = 0.15  # scale of the half-Cauchy prior of s; the grid is even in log s
NODES = {1: 128}  # of the quadrature; in more dimensions:
NODES_SOBOL = 1024
LEAST_SHARE = 0.2  # effective part of the nodes below which they are drawn together
NEGLIGIBLE = 14.0  # log-likelihood below the maximum that is cut off in doing so
ROUNDS = 8
RIDGE_TAILS = 5.0  # degrees of freedom of the t distribution along a ridge


class Posterior(NamedTuple):
    """Likelihood over the quantiles of one closure: `nodes` (q, d), `log_likelihood` (q, number of s).

    `log_ratio` (q,) is the logarithm of the prior density over that of the nodes.
    """

    log_evidence: float
    nodes: np.ndarray
    log_likelihood: np.ndarray
    log_ratio: np.ndarray

    @classmethod
    def of(cls, nodes: np.ndarray, log_likelihood: np.ndarray, log_ratio: np.ndarray) -> Self:
        """With the evidence, the mean of likelihood x prior / density."""
        terms = log_sum_exp(log_likelihood, axis=1) + log_ratio
        return cls(float(log_sum_exp(terms) - np.log(len(terms))), nodes, log_likelihood, log_ratio)

    def log_weights(self) -> np.ndarray:
        """Logarithms of the posterior weights of the nodes, (q,); they sum to one."""
        terms = log_sum_exp(self.log_likelihood, axis=1) + self.log_ratio
        return terms - log_sum_exp(terms)

    def effective(self) -> float:
        """Effective number of nodes."""
        return float(np.exp(-log_sum_exp(2.0 * self.log_weights())))


def sigma_weights(sigmas: np.ndarray) -> np.ndarray:
    """Logarithms of the prior weights of a grid of s."""
    if sigmas is UNKNOWN_DISCREPANCIES:
        return np.full(len(sigmas), -np.log(len(sigmas)))
    weights = sigmas / (1.0 + (sigmas / CAUCHY) ** 2)
    return np.log(weights / weights.sum())


def integrate(
    seen: "Mapping[float, Seen]",
    closure: "ResponseColumns",
    limits: tuple[float, float],
    temperature: float = 1.0,
) -> Posterior:
    """The `Posterior` of a closure whose prior is uniform between the same limits in all dimensions.

    The likelihood is raised to the power 1 / temperature.

    Quasi-random nodes (midpoints in one dimension) are drawn together where the likelihood is, until
    enough of them count: within a smaller box, and where that does not help, since only a combination of
    the parameters is known, along the ridge.
    """
    d = sum(response.dimension for response in closure.responses)
    low, high = np.full(d, limits[0]), np.full(d, limits[1])
    log_share, nodes = 0.0, first_nodes(d, *limits)
    for number in range(ROUNDS):
        if number:
            nodes = low + unit_nodes(d) * (high - low)
        posterior = Posterior.of(
            nodes, likelihood(seen, closure, nodes, temperature), np.full(len(nodes), log_share)
        )
        if posterior.effective() >= LEAST_SHARE * len(nodes):
            return posterior
        weights = posterior.log_weights()
        inside = nodes[weights > weights.max() - NEGLIGIBLE]
        margin = 2.0 * (high - low) / len(nodes) ** (1.0 / d)
        new_low = np.maximum(low, inside.min(axis=0) - margin)
        new_high = np.minimum(high, inside.max(axis=0) + margin)
        shrunk = np.log((new_high - new_low) / (high - low)).sum()
        if shrunk > -0.05:
            break
        log_share += shrunk
        low, high = new_low, new_high
    return posterior if d == 1 else along_ridge(seen, closure, limits, posterior, temperature)


def along_ridge(
    seen: "Mapping[float, Seen]",
    closure: "ResponseColumns",
    limits: tuple[float, float],
    posterior: Posterior,
    temperature: float,
) -> Posterior:
    """The `Posterior` by importance sampling: nodes of a t distribution that is fitted to the last nodes.

    One node in ten is spread over the whole prior, so that no weight is large without reason.
    """
    d = posterior.nodes.shape[1]
    unit, steps = ridge_nodes(d)
    everywhere = np.arange(len(unit)) % 10 == 0
    log_prior = -d * np.log(limits[1] - limits[0])
    for _ in range(ROUNDS):
        centre, covariance = tempered_moments(posterior, 10 * d)
        factor = cholesky(covariance, lower=True)
        nodes = centre + steps @ factor.T
        nodes[everywhere] = limits[0] + unit[everywhere] * (limits[1] - limits[0])
        inside = ((nodes > limits[0]) & (nodes < limits[1])).all(axis=1)
        fitted = log_density_t(nodes - centre, factor)
        density = np.logaddexp(np.log(0.9) + fitted, np.log(0.1) + log_prior)
        log_likelihood = np.full((len(nodes), len(EFFECT_DISCREPANCIES)), -np.inf)
        log_likelihood[inside] = likelihood(seen, closure, nodes[inside], temperature)
        posterior = Posterior.of(nodes, log_likelihood, log_prior - density)
        if posterior.effective() >= LEAST_SHARE * len(nodes):
            break
    return posterior


def tempered_moments(posterior: Posterior, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean (d,) and covariance (d, d) of the nodes, weights flattened until `count` of them are effective."""
    logs = posterior.log_weights()
    power = 1.0
    while power > 1.0e-4:
        weights = np.exp(power * logs - log_sum_exp(power * logs))
        if 1.0 / (weights**2).sum() >= count:
            break
        power *= 0.7
    centre = weights @ posterior.nodes
    apart = posterior.nodes - centre
    covariance = (weights[:, None] * apart).T @ apart
    return centre, covariance + 1.0e-10 * np.eye(len(centre))


def likelihood(
    seen: "Mapping[float, Seen]",
    closure: "ResponseColumns",
    nodes: np.ndarray,
    temperature: float = 1.0,
) -> np.ndarray:
    """Log-likelihood / temperature, x weight of s, (q, number of s)."""
    own = [seen[sigma] for sigma in EFFECT_DISCREPANCIES]
    log_values = stack_of(own, closure).log_likelihood(own, nodes)
    return log_values / temperature + sigma_weights(EFFECT_DISCREPANCIES)


def log_density_t(apart: np.ndarray, factor: np.ndarray) -> np.ndarray:
    """Logarithm of the density of the t distribution of `RIDGE_TAILS` at distances (q, d) from its centre, (q,).

    `factor` (d, d) is the lower Cholesky factor of its scale.
    """
    d = len(factor)
    square = (solve_triangular(factor, apart.T, lower=True) ** 2).sum(axis=0)
    constant = gammaln(0.5 * (RIDGE_TAILS + d)) - gammaln(0.5 * RIDGE_TAILS)
    constant -= 0.5 * d * np.log(RIDGE_TAILS * np.pi) + np.log(np.diag(factor)).sum()
    return constant - 0.5 * (RIDGE_TAILS + d) * np.log1p(square / RIDGE_TAILS)


@cache
def ridge_nodes(d: int) -> tuple[np.ndarray, np.ndarray]:
    """Quasi-random numbers in [0, 1]^d, and steps of a t distribution of unit scale, (q, d) each."""
    unit = qmc.Sobol(d + 1, seed=0).random(NODES_SOBOL)
    spread = np.sqrt(RIDGE_TAILS / chdtri(RIDGE_TAILS, 1.0 - unit[:, -1]))
    return unit[:, :-1], ndtri(unit[:, :-1]) * spread[:, None]


@cache
def first_nodes(d: int, low: float, high: float) -> np.ndarray:
    """Nodes (q, d) over the whole prior, the same array at every call; it cannot be written to."""
    nodes = low + unit_nodes(d) * (high - low)
    nodes.flags.writeable = False
    return nodes


@cache
def unit_nodes(d: int) -> np.ndarray:
    """Nodes of the quadrature on [0, 1]^d, (q, d)."""
    if d in NODES:
        return (np.arange(NODES[d])[:, None] + 0.5) / NODES[d]
    return qmc.Sobol(d, seed=0).random(NODES_SOBOL)


def intervals(
    posterior: Posterior, u: np.ndarray, level: float = 0.9
) -> tuple[np.ndarray, np.ndarray]:
    """Ends (d,), (d,) of the shortest posterior intervals of the quantiles that contain u (d,).

    Not the central ones: where the likelihood falls from the end of a prior, they leave out its maximum.
    """
    weights = np.exp(posterior.log_weights())
    nodes, weights = posterior.nodes[weights > 0.0], weights[weights > 0.0]
    below = np.linspace(0.0, 1.0 - level, 101)
    low, high = np.empty(len(u)), np.empty(len(u))
    for axis, column in enumerate(nodes.T):
        order = np.argsort(column)
        middle = np.cumsum(weights[order]) - 0.5 * weights[order]
        lows = np.interp(below, middle, column[order])
        highs = np.interp(below + level, middle, column[order])
        inside = np.clip(u[axis], lows[0], highs[-1])  # u may lie beyond the last node
        around = (lows <= inside) & (inside <= highs)
        best = np.argmin(np.where(around, highs - lows, np.inf))
        low[axis], high[axis] = min(lows[best], u[axis]), max(highs[best], u[axis])
    return low, high
