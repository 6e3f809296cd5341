"""How sharp and how well calibrated the probabilities of answers are.

References
----------
Brier (1950), Mon. Weather Rev. 78, 1; Guo et al. (2017), ICML (expected calibration error).
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fvcollapse.blind.outcomes import SAMPLES, Outcome, best_credit, bootstrapped, credit, share
from fvcollapse.blind.plain_values import Average

CONFIDENT = 0.9
LEAST_PROBABILITY = 1.0e-4  # for the logarithm: an answer of zero is not punished without end
BINS = (5, 10)


def squared_errors(
    outcomes: Sequence[Outcome], probabilities: Sequence[Mapping[str, float]]
) -> np.ndarray:
    """Brier score of each case: 0 at best, 2 at worst."""
    scores = []
    for outcome, probability in zip(outcomes, probabilities, strict=True):
        names = {*probability, outcome.truth}
        scores.append(sum((probability.get(n, 0.0) - (n == outcome.truth)) ** 2 for n in names))
    return np.array(scores)


def log_scores(
    outcomes: Sequence[Outcome], probabilities: Sequence[Mapping[str, float]]
) -> np.ndarray:
    """-ln of the probability of the truth, of each case."""
    pairs = zip(outcomes, probabilities, strict=True)
    return np.array(
        [-np.log(max(p.get(outcome.truth, 0.0), LEAST_PROBABILITY)) for outcome, p in pairs]
    )


def sharpness(outcomes: Sequence[Outcome]) -> dict[str, Average]:
    """Brier and logarithmic score, and their skill against the frequencies of the causes themselves."""
    counts = Counter(outcome.truth for outcome in outcomes)
    rates = {name: count / len(outcomes) for name, count in counts.items()}
    given, reference = [outcome.probability for outcome in outcomes], [rates] * len(outcomes)
    table: dict[str, Average] = {}
    for name, score in (("brier", squared_errors), ("log_score", log_scores)):
        mean, skill = with_skill(score(outcomes, given), score(outcomes, reference))
        table |= {name: mean, f"{name}_skill": skill}
    return table


def with_skill(earned: np.ndarray, base: np.ndarray) -> tuple[Average, Average]:
    """Mean of the scores (n,) of some answers, and its skill against the scores (n,) of others."""
    return (
        bootstrapped(lambda i: earned[i].mean(), len(earned)),
        bootstrapped(lambda i: 1.0 - earned[i].mean() / base[i].mean(), len(earned)),
    )


def calibration(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Calibration error, beside the one of a perfect diagnosis with the same confidences."""
    confidence = np.array([outcome.confidence() for outcome in outcomes])
    right = np.array([outcome.ranked()[0] == outcome.truth for outcome in outcomes], float)
    rng = np.random.default_rng(0)
    perfect = rng.random((SAMPLES, len(right))) < confidence
    table: dict[str, Any] = {
        "mean_confidence": float(confidence.mean()),
        "accuracy": float(right.mean()),
        "confident_errors": share(
            outcome.confidence() > CONFIDENT and credit(outcome.truth, outcome.ranked()[0]) == 0.0
            for outcome in outcomes
        ),
    }
    for bins in BINS:
        floor = [calibration_error(confidence, drawn, bins) for drawn in perfect]
        error = calibration_error(confidence, right, bins)
        limit = float(np.quantile(floor, 0.95))
        table[f"ece_{bins}_bins"] = {
            "value": error,
            "perfect_mean": float(np.mean(floor)),
            "perfect_95": limit,
            "within_floor": bool(error <= limit),
        }
    return table


def calibration_error(confidence: np.ndarray, right: np.ndarray, bins: int) -> float:
    """Mean over the cases of |accuracy - confidence| of their bin of equal width."""
    place = np.minimum((confidence * bins).astype(int), bins - 1)
    difference = np.bincount(place, right - confidence, bins)
    return float(np.abs(difference).sum() / len(confidence))


def risk_coverage(outcomes: Sequence[Outcome]) -> list[dict[str, float]]:
    """Share of errors among the most confident cases, for growing shares of the cases."""
    order = sorted(outcomes, key=lambda outcome: -outcome.confidence())
    rows = []
    for tenth in range(1, 11):
        chosen = order[: max(1, round(0.1 * tenth * len(order)))]
        risk = 1.0 - np.mean([best_credit(outcome, outcome.ranked()[:1]) for outcome in chosen])
        rows.append({"coverage": len(chosen) / len(order), "risk": float(risk)})
    return rows
