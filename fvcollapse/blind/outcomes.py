"""Outcomes of probabilistic answers to cases whose truth is known, and shares with their uncertainty.

A case of two causes is one name, the two joined by "+"; one of its causes alone earns half.
Shares come with the interval of Clopper and Pearson at 95 % (its beta form, which takes half counts as
well), means with that of 2000 bootstrap samples of the cases.

References
----------
Clopper & Pearson (1934), Biometrika 26, 404.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from scipy.stats import beta

from fvcollapse.blind.plain_values import Average
from fvcollapse.diagnosis.names import NONE, UNKNOWN

SAMPLES = 2000


class Outcome(NamedTuple):
    """One case: the true name, the kind of unknown (or None), and the answer.

    `verdict` is "effect", "several", "none" or "unknown"; `probability` {name: p}; `names` the set of
    names that the answer leaves open.
    """

    truth: str
    kind: str | None
    verdict: str
    probability: dict[str, float]
    names: tuple[str, ...]

    def ranked(self) -> list[str]:
        """Names by probability; among equals the wrong ones first."""
        pairs = self.probability.items()
        return [name for name, p in sorted(pairs, key=lambda e: (-e[1], credit(self.truth, e[0])))]

    def confidence(self) -> float:
        """Largest probability."""
        return max(self.probability.values())


def credit(truth: str, name: str) -> float:
    """1 for the truth, 1/2 for one of its two causes, else 0."""
    if name == truth:
        return 1.0
    return 0.5 if "+" in truth and name in truth.split("+") else 0.0


def best_credit(outcome: Outcome, names: Iterable[str]) -> float:
    """Largest credit of some names."""
    return max((credit(outcome.truth, name) for name in names), default=0.0)


def class_of(truth: str) -> str:
    """Single, pair, none or unknown."""
    if truth in (NONE, UNKNOWN):
        return truth
    return "pair" if "+" in truth else "single"


def grouped(
    outcomes: Iterable[Outcome], key: Callable[[Outcome], str]
) -> list[tuple[str, list[Outcome]]]:
    """(value of the key, outcomes) in alphabetical order."""
    groups: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault(key(outcome), []).append(outcome)
    return sorted(groups.items())


def share(credits: Iterable[float]) -> Average:
    """{"value", "low", "high", "n"} of the mean of numbers between 0 and 1; value None if there is none."""
    credits = np.asarray(list(credits), float)
    n, k = len(credits), float(credits.sum())
    if n == 0:
        return {"value": None, "low": None, "high": None, "n": 0}
    low = beta.ppf(0.025, k, n - k + 1.0) if k > 0.0 else 0.0
    high = beta.ppf(0.975, k + 1.0, n - k) if k < n else 1.0
    return {"value": k / n, "low": float(low), "high": float(high), "n": n}


def bootstrapped(statistic: Callable[[np.ndarray], float], count: int) -> Average:
    """{"value", "low", "high", "n"} of `statistic(indices)` over `count` cases."""
    rng = np.random.default_rng(0)
    draws = [statistic(rng.integers(count, size=count)) for _ in range(SAMPLES)]
    low, high = np.nanquantile(draws, [0.025, 0.975])
    value = statistic(np.arange(count))
    return {"value": float(value), "low": float(low), "high": float(high), "n": count}
