"""Answers by simple rules, as baselines: a chi-square test, the best fit, the nearest signature."""

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.stats import chi2

from fvcollapse.blind.plain_values import Answer, Simple
from fvcollapse.diagnosis.names import EFFECT, NONE, UNKNOWN
from fvcollapse.diagnosis.separability import DISCREPANCY

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.evidence import Evidence

LEVEL = 0.01  # p-value of the chi-square baseline
BASELINE_PROBABILITY = 0.9  # of the name that a simple rule gives


def chi_square(analysis: "Analysis") -> dict[str, tuple[float, float]]:
    """{hypothesis: (chi-square, p-value)} with independent errors of measurement and nothing else."""
    points = analysis.points
    use = points.kind == "value"
    sigma, gap = points.sigma[use], (analysis.baseline - points.measured)[use] / points.sigma[use]
    values = {NONE: float(gap @ gap)}
    for name, responses in analysis.responses.items():
        best = min(fit_of(gap, response.differences[:, use] / sigma) for response in responses)
        values[name] = best
    return {name: (value, float(chi2.sf(value, len(gap)))) for name, value in values.items()}


def fit_of(gap: np.ndarray, levels: np.ndarray) -> float:
    """Least square of gap + level over the levels that were run."""
    return float(((gap + levels) ** 2).sum(axis=1).min())


def signature(analysis: "Analysis") -> dict[str, float]:
    """{effect: cosine between the gap and its signature}, whitened; and p-value of no gap as `none`."""
    covariance = analysis.covariance + DISCREPANCY**2 * analysis.kernel
    factor = cholesky(covariance, lower=True, check_finite=False)
    gap = analysis.baseline - analysis.shift + analysis.expected - analysis.points.measured
    white = solve_triangular(factor, gap, lower=True, check_finite=False)
    values = {NONE: float(chi2.sf(white @ white, len(white)))}
    for name, responses in analysis.responses.items():
        middle = [response.at(np.full(response.dimension, 0.5)) for response in responses]
        columns = solve_triangular(factor, np.array(middle).T, lower=True, check_finite=False)
        lengths = np.linalg.norm(columns, axis=0) * np.linalg.norm(white)
        cosines = -(columns.T @ white) / np.where(lengths > 0.0, lengths, 1.0)
        values[name] = float(cosines.max())
    return values


def chi_square_answer(simple: Simple) -> str:
    """The best fit where a chi-square test accepts it; unknown where it accepts no fit."""
    values = simple["chi_square"]
    if values[NONE][1] >= LEVEL:
        return NONE
    best = min((name for name in values if name != NONE), key=lambda name: values[name][0])
    return best if values[best][1] >= LEVEL else UNKNOWN


def chi_square_ranking(simple: Simple) -> str:
    """The best fit of all effects, whatever its p-value, unless there is no gap."""
    values = simple["chi_square"]
    if values[NONE][1] >= LEVEL:
        return NONE
    return min((name for name in values if name != NONE), key=lambda name: values[name][0])


def signature_answer(simple: Simple) -> str:
    """The effect whose signature is nearest, unless there is no gap."""
    values = simple["signature"]
    if values[NONE] >= LEVEL:
        return NONE
    return max((name for name in values if name != NONE), key=lambda name: values[name])


SIMPLE = {
    "chi_square_test": chi_square_answer,
    "chi_square_ranking": chi_square_ranking,
    "nearest_signature": signature_answer,
}


def simple_answer(name: str, evidence: "Evidence") -> Answer:
    """An answer that names one hypothesis."""
    others = [other for other in evidence.hypotheses if other != name and "+" not in other]
    share = (1.0 - BASELINE_PROBABILITY) / len(others)
    kind = name if name in (NONE, UNKNOWN) else EFFECT
    probability = {name: BASELINE_PROBABILITY} | dict.fromkeys(others, share)
    return {"verdict": kind, "probability": probability, "set": [name]}
