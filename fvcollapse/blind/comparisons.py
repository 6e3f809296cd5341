"""Two diagnoses compared, parameters beside their true values, predicted beside actual reductions.

References
----------
McNemar (1947), Psychometrika 12, 153.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import binomtest

from fvcollapse.blind.outcomes import Outcome, bootstrapped, share
from fvcollapse.blind.plain_values import Average, Reduction

NORMAL_90 = 3.2897  # width of a central interval of 90 % in standard deviations


def mcnemar(first: Sequence[Outcome], second: Sequence[Outcome]) -> dict[str, float]:
    """Whether two diagnoses of the same cases differ: discordant cases and the exact p-value.

    Parameters
    ----------
    first, second : sequences of Outcome
        In the same order.
    """
    right = [
        [outcome.ranked()[0] == outcome.truth for outcome in outcomes]
        for outcomes in (first, second)
    ]
    pairs = list(zip(*right, strict=True))
    only_first = sum(a and not b for a, b in pairs)
    only_second = sum(b and not a for a, b in pairs)
    count = only_first + only_second
    p_value = float(binomtest(only_first, count).pvalue) if count else 1.0
    return {"only_first": only_first, "only_second": only_second, "p_value": p_value}


def parameter_scores(rows: Sequence[Mapping[str, Any]]) -> dict[str, Average | None]:
    """Errors of estimated parameters in their standard deviations, and coverage of the 90 % intervals.

    Parameters
    ----------
    rows : list of dict
        With `true`, `value`, `low`, `high`.
    """
    errors = [
        NORMAL_90 * (row["value"] - row["true"]) / (row["high"] - row["low"])
        for row in rows
        if row["high"] > row["low"]
    ]
    covered = share(row["low"] <= row["true"] <= row["high"] for row in rows)
    if len(errors) < 2:
        return {"z_mean": None, "z_sd": None, "interval_90_covers": covered}
    z = np.array(errors)
    return {
        "z_mean": bootstrapped(lambda i: z[i].mean(), len(z)),
        "z_sd": bootstrapped(lambda i: z[i].std(), len(z)),
        "interval_90_covers": covered,
    }


def reduction_scores(
    rows: Sequence[Reduction], tolerances: tuple[float, float] = (0.15, 0.10)
) -> dict[str, Average | None]:
    """Predicted beside actual reduction of the gap, and winner beside runner-up.

    Parameters
    ----------
    rows : list of dict
        Fractions of the gap closed, each may be None: `predicted` and `actual` of the fitted experiments,
        `winner` (absent: `actual`) and `runner_up` of those held out; `winner_left` and `runner_up_left`, what they
        leave of the gap of one held out, noise included, in standard deviations.
    tolerances : (float, float)
        Largest differences that count as right: of `within_tolerance` and of the narrower `within_narrow`.
    """
    pairs = [(r["predicted"], r["actual"]) for r in rows]
    both = [(p, a) for p, a in pairs if p is not None and a is not None]
    duels = [(r.get("winner", r["actual"]), r["runner_up"]) for r in rows]
    duel = [(a, b) for a, b in duels if a is not None and b is not None]
    rests = [(r.get("winner_left"), r.get("runner_up_left")) for r in rows]
    left = [(a, b) for a, b in rests if a is not None and b is not None]
    wide, narrow = tolerances
    table: dict[str, Average | None] = {
        "within_tolerance": share(abs(p - a) <= wide for p, a in both),
        "within_narrow": share(abs(p - a) <= narrow for p, a in both),
        "winner_beats_runner_up": share(a > b for a, b in duel),
        "winner_leaves_less": share(a < b for a, b in left),
        "rms": None,
        "slope": None,
    }
    if len(both) > 2:
        p, a = np.array(both).T
        table["rms"] = bootstrapped(lambda i: np.sqrt(np.mean((p - a)[i] ** 2)), len(p))
        if np.ptp(p) > 0.0:
            table["slope"] = bootstrapped(lambda i: slope(p[i], a[i]), len(p))
    return table


def slope(x: np.ndarray, y: np.ndarray) -> float:
    """Least-squares slope of y over x; NaN where x does not vary."""
    spread = ((x - x.mean()) ** 2).sum()
    return ((x - x.mean()) * (y - y.mean())).sum() / spread if spread > 0.0 else np.nan
