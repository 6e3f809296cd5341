"""Which effects these data can tell apart."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Separability:
    names: tuple
    cosine: np.ndarray  # (K, K)
    distance: np.ndarray  # (K, K) d^2_jk: row = truth
    snr: np.ndarray  # (K,)
    unique_snr: np.ndarray  # (K,)
    classes: tuple  # of tuples of names, d^2 < 3, only those of two or more
    insufficient: tuple  # names with unique SNR < 3


def separability(covariance, kernel, responses, at=None, sigma=0.2):
    """`at`: name -> u (default 0.5 in every dimension)."""
    raise NotImplementedError


def null_test(samples, mean, comparison, measurement, rng):
    """Effects that win although only nu is off: {name: share of the draws in which it wins}."""
    raise NotImplementedError
