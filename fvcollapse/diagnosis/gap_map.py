"""Where the gap lies."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class Region(NamedTuple):
    experiment: str
    observable: str
    units: str
    t_range: tuple  # (first, last) s; None for a scalar
    x_range: tuple  # (first, last) m; None where there is no x
    gap: float  # mean simulated - measured
    uncertainty: float  # combined standard uncertainty of that mean
    significance: float  # gap / uncertainty
    p_value: float  # family-wise
    points: np.ndarray  # indices
    text: str


class Share(NamedTuple):
    experiment: str
    observable: str
    phase: str
    share: float  # of E^T U^-1 E, all shares sum to 1
    sign: int  # +1 simulated larger


class Level(NamedTuple):
    experiment: str  # "" = all together
    observable: str
    units: str
    rms: float
    combined: float
    ratio: float


@dataclass(frozen=True)
class GapMap:
    gap: np.ndarray  # (N,)
    uncertainty: np.ndarray  # (N,)
    z: np.ndarray  # (N,)
    regions: tuple  # of Region, family-wise 5 %
    discoveries: np.ndarray  # (N,) bool, Benjamini-Yekutieli 5 %
    shares: tuple  # of Share
    by_observable: tuple  # of Level
    lines: tuple  # plain words, one per region, or one that nothing is significant


def gap_map(points, simulated, covariance, rng):
    raise NotImplementedError
