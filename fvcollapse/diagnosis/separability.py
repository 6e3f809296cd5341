"""Which effects these data can tell apart, before and after looking at them.

Signatures are whitened with C(s) at the discrepancy s = 0.2, which holds the calibrated parameters: what
they can imitate does not count. With W_k the whitened response to effect k at a typical strength,

    d^2_jk = |W_j|^2 (1 - cos^2_jk)

is twice the expected log Bayes factor for j, which is true, against k with a free amplitude; the
unique signal-to-noise ratio of k is the length of W_k outside the span of all others.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.sparse.csgraph import connected_components

from fvcollapse.diagnosis.likelihood import span_of

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Closures, ModelComparison

DISCREPANCY = 0.2
EQUIVALENT = 3.0  # d^2 below which two effects are one to these data
VISIBLE = 3.0  # signal-to-noise ratio of its own that an effect needs to be named
OFF_BY = 1.5  # standard deviations of the calibrated parameters in the null test


@dataclass(frozen=True)
class Separability:
    """How alike the K effects look.

    Attributes
    ----------
    names : tuple of str
    cosine : (K, K) array
    distance : (K, K) array
        d^2_jk; the row is the true effect.
    snr, unique_snr : (K,) arrays
        |W_k|; the same outside the span of all others.
    classes : tuple of tuples of str
        Visible effects that cannot be told apart; only classes of two or more.
    insufficient : tuple of str
        Effects whose unique signal-to-noise ratio is below 3: these data cannot name them for sure.
    """

    names: tuple[str, ...]
    cosine: np.ndarray
    distance: np.ndarray
    snr: np.ndarray
    unique_snr: np.ndarray
    classes: tuple[tuple[str, ...], ...]
    insufficient: tuple[str, ...]


def separability(
    covariance: np.ndarray,
    kernel: np.ndarray,
    responses: "Mapping[str, Closures]",
    at: Mapping[str, np.ndarray] | None = None,
    sigma: float = DISCREPANCY,
) -> Separability:
    """The `Separability` of some effects.

    Parameters
    ----------
    covariance, kernel : (N, N) arrays
        U and K_delta.
    responses : dict
        Name -> `Response`, or a sequence of them of which the first counts; empty where nothing that was
        measured changes with any effect.
    at : dict, optional
        Name -> quantiles (d,) of the parameters; default: the median of every prior.
    sigma : float
        Discrepancy s.
    """
    if not responses:
        return Separability((), *np.zeros((2, 0, 0)), *np.zeros((2, 0)), (), ())  # type: ignore[call-arg]
    at, names, columns = at or {}, tuple(responses), []
    for name, given in responses.items():
        response = given[0] if isinstance(given, list | tuple) else given
        columns.append(response.at(at.get(name, np.full(response.dimension, 0.5))))
    factor = cholesky(covariance + sigma**2 * kernel, lower=True, check_finite=False)
    white = solve_triangular(factor, np.array(columns).T, lower=True, check_finite=False)
    snr = np.linalg.norm(white, axis=0)
    unit = white / np.where(snr > 0.0, snr, 1.0)
    cosine = np.clip(unit.T @ unit, -1.0, 1.0)
    distance = snr[:, None] ** 2 * (1.0 - cosine**2)
    np.fill_diagonal(distance, 0.0)
    unique = np.array([unique_length(unit, k) for k in range(len(names))]) * snr
    visible = snr**2 >= EQUIVALENT
    alike = (np.minimum(distance, distance.T) < EQUIVALENT) & visible & visible[:, None]
    _, label = connected_components(alike, directed=False)
    classes: list[tuple[str, ...]] | tuple[tuple[str, ...], ...] = [
        tuple(name for name, own in zip(names, label, strict=True) if own == k)
        for k in range(label.max() + 1)
    ]
    classes = tuple(group for group in classes if len(group) > 1)
    insufficient = tuple(n for n, own in zip(names, unique, strict=True) if own < VISIBLE)
    return Separability(names, cosine, distance, snr, unique, classes, insufficient)


def unique_length(unit: np.ndarray, k: int) -> float:
    """Length of a unit column outside the span of the others."""
    others = np.delete(unit, k, axis=1)
    if others.shape[1] == 0:
        return float(np.linalg.norm(unit[:, k]))
    left = span_of(others)
    return float(np.linalg.norm(unit[:, k] - left @ (left.T @ unit[:, k])))


def null_test(
    samples: np.ndarray,
    mean: np.ndarray,
    comparison: "ModelComparison",
    measurement: np.ndarray,
    rng: np.random.Generator,
) -> dict[str, float]:
    """Effects that win although nothing but the calibration is off (BaNTER).

    Every run of the ensemble, its parameters off by about 1.5 standard deviations, with drawn errors of
    measurement, is taken as data without an effect. An effect that wins often cannot be told from a
    mis-calibration.

    Parameters
    ----------
    samples : (m, N) array
        Of the ensemble.
    mean : (N,) array
        Its mean.
    comparison : ModelComparison
    measurement : (N, N) array
        Sigma_D.
    rng : numpy.random.Generator

    Returns
    -------
    dict
        Name of each hypothesis that won -> share of the draws, the most frequent first.
    """
    factor = cholesky(measurement, lower=True, check_finite=False)
    wins: dict[str, int] = {}
    for sample in samples:
        noise = factor @ rng.standard_normal(len(mean))
        winner = comparison.best_name(-OFF_BY * (sample - mean) - noise)
        wins[winner] = wins.get(winner, 0) + 1
    return {
        name: count / len(samples)
        for name, count in sorted(wins.items(), key=lambda each: -each[1])
    }
