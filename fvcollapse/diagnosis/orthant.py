"""Probability that correlated normal numbers all lie on their side of zero: what bounds tell."""

import math

import numpy as np

from fvcollapse.step.compiled import kernel_jit

LOWEST = -15.0  # deviations below which the tail is expanded; its error there is 1e-8
LOG_SQRT_2_PI = 0.5 * math.log(2.0 * math.pi)


@kernel_jit()
def log_normal_tail(z: float) -> float:
    """Logarithm of the standard normal distribution function."""
    if z > LOWEST:
        return math.log(0.5 * math.erfc(-z / math.sqrt(2.0)))
    r = 1.0 / (z * z)
    series = 1.0 - r * (1.0 - 3.0 * r * (1.0 - 5.0 * r * (1.0 - 7.0 * r)))
    return -0.5 * z * z - math.log(-z) - LOG_SQRT_2_PI + math.log(series)


@kernel_jit()
def log_probability_positive(
    mean: np.ndarray, covariance: np.ndarray, side: np.ndarray
) -> np.ndarray:
    """Logarithm of P(side x > 0 for all components), (q,); exact for one, Mendell-Elston for more.

    One component after the other is taken to be positive, and the moments of the others are corrected
    as if they stayed normal (Mendell & Elston 1974, Biometrics 30, 41-57).

    Parameters
    ----------
    mean : (q, n) array
        Of side x.
    covariance : (q or 1, n, n) array
        Of x.
    side : (n,) array
        +1 or -1.
    """
    count, n = mean.shape
    total = np.zeros(count)
    m, c = np.empty(n), np.empty((n, n))
    for q in range(count):
        given = covariance[q if len(covariance) > 1 else 0]
        for i in range(n):
            m[i] = mean[q, i]
            for j in range(i + 1):
                c[i, j] = given[i, j] * side[i] * side[j]
        for i in range(n):
            deviation = math.sqrt(c[i, i])
            z = m[i] / deviation
            log_p = log_normal_tail(z)
            total[q] += log_p
            # moments of a normal variable that is known to be positive
            ratio = math.exp(-0.5 * z * z - LOG_SQRT_2_PI - log_p)
            shrink = ratio * (ratio + z) / (deviation * deviation)
            for j in range(i + 1, n):
                m[j] += ratio * c[j, i] / deviation
                scaled = shrink * c[j, i]
                for k in range(i + 1, j + 1):
                    c[j, k] -= scaled * c[k, i]
    return total
