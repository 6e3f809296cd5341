"""Scores of probabilistic answers to cases whose truth is known, each with its uncertainty.

A case of two causes is one name, the two joined by "+"; one of them alone earns half. Shares come with
the interval of Clopper and Pearson at 95 % (its beta form, which takes half counts as well), means with
one of 2000 bootstrap samples of the cases.

References
----------
Brier (1950), Mon. Weather Rev. 78, 1; Clopper & Pearson (1934), Biometrika 26, 404; McNemar (1947),
Psychometrika 12, 153; Guo et al. (2017), ICML (expected calibration error).
"""

from collections import Counter
from typing import NamedTuple

import numpy as np
from scipy.stats import beta, binomtest

from fvcollapse.diagnosis.names import NAMED, NONE, UNKNOWN

CONFIDENT = 0.9
LEAST_PROBABILITY = 1.0e-4  # for the logarithm: an answer of zero is not punished without end
SAMPLES = 2000
BINS = (5, 10)
NORMAL_90 = 3.2897  # width of a central interval of 90 % in standard deviations


class Outcome(NamedTuple):
    """One case: the true name, the kind of unknown (or None), and the answer.

    `verdict` is "effect", "several", "none" or "unknown"; `probability` {name: p}; `names` the set of
    names that the answer leaves open.
    """

    truth: str
    kind: str | None
    verdict: str
    probability: dict
    names: tuple

    def ranked(self):
        """Names by probability; among equals the wrong ones first."""
        pairs = self.probability.items()
        return [name for name, p in sorted(pairs, key=lambda e: (-e[1], credit(self.truth, e[0])))]

    def confidence(self):
        """Largest probability."""
        return max(self.probability.values())


def credit(truth, name):
    """1 for the truth, 1/2 for one of its two causes, else 0."""
    if name == truth:
        return 1.0
    return 0.5 if "+" in truth and name in truth.split("+") else 0.0


def best_credit(outcome, names):
    """Largest credit of some names."""
    return max((credit(outcome.truth, name) for name in names), default=0.0)


# -- numbers with intervals --------------------------------------------------------------------------------


def share(credits):
    """{"value", "low", "high", "n"} of the mean of numbers between 0 and 1; value None if there is none."""
    credits = np.asarray(list(credits), float)
    n, k = len(credits), float(credits.sum())
    if n == 0:
        return {"value": None, "low": None, "high": None, "n": 0}
    low = beta.ppf(0.025, k, n - k + 1.0) if k > 0.0 else 0.0
    high = beta.ppf(0.975, k + 1.0, n - k) if k < n else 1.0
    return {"value": k / n, "low": float(low), "high": float(high), "n": n}


def bootstrapped(statistic, count):
    """{"value", "low", "high", "n"} of `statistic(indices)` over `count` cases."""
    rng = np.random.default_rng(0)
    draws = [statistic(rng.integers(count, size=count)) for _ in range(SAMPLES)]
    low, high = np.nanquantile(draws, [0.025, 0.975])
    value = statistic(np.arange(count))
    return {"value": float(value), "low": float(low), "high": float(high), "n": count}


# -- one after the other -----------------------------------------------------------------------------------


def ranking(outcomes):
    """First and first two names, the sets and their size."""
    sizes = [max(len(outcome.names), 1) for outcome in outcomes]
    return {
        "top_1": share(best_credit(one, one.ranked()[:1]) for one in outcomes),
        "top_2": share(best_credit(one, one.ranked()[:2]) for one in outcomes),
        "set_holds_truth": share(best_credit(one, one.names or (UNKNOWN,)) for one in outcomes),
        "mean_set_size": bootstrapped(lambda i: np.mean(np.array(sizes)[i]), len(sizes)),
    }


def by_class(outcomes):
    """`ranking` of known single effects, pairs, none and unknown, and the first name of every cause."""
    groups = {
        "single": [one for one in outcomes if class_of(one.truth) == "single"],
        "pair": [one for one in outcomes if class_of(one.truth) == "pair"],
        NONE: [one for one in outcomes if one.truth == NONE],
        UNKNOWN: [one for one in outcomes if one.truth == UNKNOWN],
    }
    return {name: ranking(group) for name, group in groups.items() if group}


def class_of(truth):
    """Single, pair, none or unknown."""
    if truth in (NONE, UNKNOWN):
        return truth
    return "pair" if "+" in truth else "single"


def by_cause(outcomes):
    """First name, and set, of every cause."""
    return {
        truth: {
            "top_1": share(best_credit(one, one.ranked()[:1]) for one in group),
            "set_holds_truth": share(best_credit(one, one.names or (UNKNOWN,)) for one in group),
        }
        for truth, group in grouped(outcomes, lambda one: one.truth)
    }


def grouped(outcomes, key):
    """(value of the key, outcomes) in alphabetical order."""
    groups = {}
    for one in outcomes:
        groups.setdefault(key(one), []).append(one)
    return sorted(groups.items())


def confusion(outcomes):
    """{truth: {first name: count}}."""
    return {
        truth: dict(Counter(one.ranked()[0] for one in group).most_common())
        for truth, group in grouped(outcomes, lambda one: one.truth)
    }


def alarms(outcomes):
    """False alarms where there is nothing, and what became of causes outside the catalogue."""
    nothing = [one for one in outcomes if one.truth == NONE]
    unknown = [one for one in outcomes if one.truth == UNKNOWN]
    return {
        "false_alarm_on_none": share(one.verdict != NONE for one in nothing),
        "effect_named_on_none": share(one.verdict in NAMED for one in nothing),
        "unknown": fate(unknown),
        "single": verdicts([one for one in outcomes if class_of(one.truth) == "single"]),
        "pair": verdicts([one for one in outcomes if class_of(one.truth) == "pair"]),
        "unknown_by_kind": {
            kind: fate(group) for kind, group in grouped(unknown, lambda one: one.kind or "?")
        },
    }


def fate(outcomes):
    """Shares found, wrongly named and missed of causes outside the catalogue."""
    return {
        "found": share(one.verdict == UNKNOWN for one in outcomes),
        "wrongly_named": share(one.verdict in NAMED for one in outcomes),
        "missed": share(one.verdict == NONE for one in outcomes),
    }


def verdicts(outcomes):
    """What the verdict says of known causes: the cause alone, another one, none or unknown."""
    told = [(*one.names, *one.ranked())[0] if one.verdict in NAMED else None for one in outcomes]
    right = [name == one.truth for name, one in zip(told, outcomes, strict=True)]
    return {
        "named": share(right),
        "wrongly_named": share(
            name is not None and not good for name, good in zip(told, right, strict=True)
        ),
        "taken_for_none": share(one.verdict == NONE for one in outcomes),
        "taken_for_unknown": share(one.verdict == UNKNOWN for one in outcomes),
    }


def squared_errors(outcomes, probabilities):
    """Brier score of each case: 0 at best, 2 at worst."""
    scores = []
    for one, probability in zip(outcomes, probabilities, strict=True):
        names = {*probability, one.truth}
        scores.append(sum((probability.get(n, 0.0) - (n == one.truth)) ** 2 for n in names))
    return np.array(scores)


def log_scores(outcomes, probabilities):
    """-ln of the probability of the truth, of each case."""
    pairs = zip(outcomes, probabilities, strict=True)
    return np.array([-np.log(max(p.get(one.truth, 0.0), LEAST_PROBABILITY)) for one, p in pairs])


def sharpness(outcomes):
    """Brier and logarithmic score, and their skill against the frequencies of the causes themselves."""
    counts = Counter(one.truth for one in outcomes)
    rates = {name: count / len(outcomes) for name, count in counts.items()}
    given, reference = [one.probability for one in outcomes], [rates] * len(outcomes)
    table = {}
    for name, score in (("brier", squared_errors), ("log_score", log_scores)):
        own, base = score(outcomes, given), score(outcomes, reference)
        table[name] = bootstrapped(lambda i, own=own: own[i].mean(), len(own))
        skill = bootstrapped(
            lambda i, own=own, base=base: 1.0 - own[i].mean() / base[i].mean(), len(own)
        )
        table[f"{name}_skill"] = skill
    return table


def calibration(outcomes):
    """Calibration error, beside the one of a perfect diagnosis with the same confidences."""
    confidence = np.array([one.confidence() for one in outcomes])
    right = np.array([one.ranked()[0] == one.truth for one in outcomes], float)
    rng = np.random.default_rng(0)
    perfect = rng.random((SAMPLES, len(right))) < confidence
    table = {
        "mean_confidence": float(confidence.mean()),
        "accuracy": float(right.mean()),
        "confident_errors": share(
            one.confidence() > CONFIDENT and credit(one.truth, one.ranked()[0]) == 0.0
            for one in outcomes
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


def calibration_error(confidence, right, bins):
    """Mean over the cases of |accuracy - confidence| of their bin of equal width."""
    own = np.minimum((confidence * bins).astype(int), bins - 1)
    difference = np.bincount(own, right - confidence, bins)
    return float(np.abs(difference).sum() / len(confidence))


def risk_coverage(outcomes):
    """Share of errors among the most confident cases, for growing shares of the cases."""
    order = sorted(outcomes, key=lambda one: -one.confidence())
    rows = []
    for tenth in range(1, 11):
        chosen = order[: max(1, round(0.1 * tenth * len(order)))]
        risk = 1.0 - np.mean([best_credit(one, one.ranked()[:1]) for one in chosen])
        rows.append({"coverage": len(chosen) / len(order), "risk": float(risk)})
    return rows


def all_scores(outcomes):
    """Every score of some outcomes."""
    return {
        "cases": len(outcomes),
        "all": ranking(outcomes),
        "by_class": by_class(outcomes),
        "by_cause": by_cause(outcomes),
        "alarms": alarms(outcomes),
        "sharpness": sharpness(outcomes),
        "calibration": calibration(outcomes),
        "risk_coverage": risk_coverage(outcomes),
        "confusion": confusion(outcomes),
    }


# -- two diagnoses, parameters, reductions -----------------------------------------------------------------


def mcnemar(first, second):
    """Whether two diagnoses of the same cases differ: discordant cases and the exact p-value.

    Parameters
    ----------
    first, second : sequences of Outcome
        In the same order.
    """
    right = [[one.ranked()[0] == one.truth for one in each] for each in (first, second)]
    pairs = list(zip(*right, strict=True))
    only_first = sum(a and not b for a, b in pairs)
    only_second = sum(b and not a for a, b in pairs)
    count = only_first + only_second
    p_value = float(binomtest(only_first, count).pvalue) if count else 1.0
    return {"only_first": only_first, "only_second": only_second, "p_value": p_value}


def parameter_scores(rows):
    """Errors of found parameters in their standard deviations, and coverage of the 90 % intervals.

    Parameters
    ----------
    rows : list of dict
        With `true`, `value`, `low`, `high`.
    """
    z = [
        NORMAL_90 * (row["value"] - row["true"]) / (row["high"] - row["low"])
        for row in rows
        if row["high"] > row["low"]
    ]
    covered = share(row["low"] <= row["true"] <= row["high"] for row in rows)
    if len(z) < 2:
        return {"z_mean": None, "z_sd": None, "interval_90_covers": covered}
    z = np.array(z)
    return {
        "z_mean": bootstrapped(lambda i: z[i].mean(), len(z)),
        "z_sd": bootstrapped(lambda i: z[i].std(), len(z)),
        "interval_90_covers": covered,
    }


def reduction_scores(rows, tolerance=0.15):
    """Predicted beside actual reduction of the gap, and winner beside runner-up.

    Parameters
    ----------
    rows : list of dict
        Fractions of the gap closed, each may be None: `predicted` and `actual` of the fitted experiments,
        `winner` (absent: `actual`) and `runner_up` of those held out.
    tolerance : float
        Largest difference that counts as right.
    """
    both = [
        (r["predicted"], r["actual"]) for r in rows if None not in (r["predicted"], r["actual"])
    ]
    duels = [(r.get("winner", r["actual"]), r["runner_up"]) for r in rows]
    duel = [pair for pair in duels if None not in pair]
    table = {
        "within_tolerance": share(abs(p - a) <= tolerance for p, a in both),
        "winner_beats_runner_up": share(a > b for a, b in duel),
        "rms": None,
        "slope": None,
    }
    if len(both) > 2:
        p, a = np.array(both).T
        table["rms"] = bootstrapped(lambda i: np.sqrt(np.mean((p - a)[i] ** 2)), len(p))
        if np.ptp(p) > 0.0:
            table["slope"] = bootstrapped(lambda i: slope(p[i], a[i]), len(p))
    return table


def slope(x, y):
    """Least-squares slope of y over x; NaN where x does not vary."""
    spread = ((x - x.mean()) ** 2).sum()
    return ((x - x.mean()) * (y - y.mean())).sum() / spread if spread > 0.0 else np.nan
