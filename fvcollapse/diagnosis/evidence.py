"""Evidence of each effect."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class Hypothesis(NamedTuple):
    name: str  # effect, "none", "unknown", or "a+b"
    log_evidence: float
    log_evidence_wide: float  # prior twice as wide
    log_prior: float  # 0; log 0.1 for pairs
    sigma: float  # most probable discrepancy
    variant: int  # index of the most probable closure (of a pair: tuple)
    u: np.ndarray  # (d,) most probable; empty for none, unknown
    low: np.ndarray  # (d,) 5 % and 95 % of the posterior
    high: np.ndarray
    p_value: float  # posterior predictive, all points
    p_by_run: dict  # experiment -> p
    p_by_phase: dict  # (experiment, phase) -> p
    residual_outside: float  # SPE: mean square whitened residual outside the span of all responses
    difference: np.ndarray  # (N,) response at u


@dataclass(frozen=True)
class Evidence:
    hypotheses: dict  # name -> Hypothesis, in the order of evidence x prior

    def log_evidence(self):
        """{name: ln Z}"""
        raise NotImplementedError

    def posterior(self, temperature=1.0):
        """{name: probability} from evidence and prior odds, tempered."""
        raise NotImplementedError


def compare(gap, covariance, kernel, responses, points=None):
    """Evidence; gap (N,) = ensemble mean - measured (unclipped at bounds); responses: dict name ->
    Response or sequence of Responses (closures). `points` gives kinds (bounds), runs and phases."""
    raise NotImplementedError


class Comparison:
    """The same for many gaps with the same covariance: Comparison(covariance, kernel, responses,
    points).evidence(gap)."""

    def __init__(self, covariance, kernel, responses, points=None):
        raise NotImplementedError

    def evidence(self, gap):
        raise NotImplementedError
