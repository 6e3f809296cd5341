"""Physics that the model lacks in controls and experiments alike, as far as an effect of the catalogue describes it.

A laboratory whose grains are stronger in thin layers has that in all its runs. The controls, in which nothing more is
hidden, show it; on another slope the same effect has another size, which its response there tells and a smooth
discrepancy does not. With D_q the change of all runs (N,) at the levels q of an effect j, of which the amplitudes are
of one prior, a model that lacks effect j has the further covariance

    W_j = mean over q of D_q D_q'.

Effects are taken one after the other as long as the probability of the gaps of the controls rises by a factor of at
least `exp(LEAST_GAIN)`; those that raise it nearly as much share the place in proportion. Given the controls, the
covariance between their gaps and those of the experiments carries the finding over (`controls.condition`).

References
----------
Brynjarsdottir & O'Hagan (2014), Inverse Problems 30, 114007 (a discrepancy that knows physics extrapolates).
"""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular

from fvcollapse.diagnosis.log_sums import log_sum_exp

LEAST_GAIN = (
    3.0  # of the logarithm of the evidence; twelve effects that might do it cost ln 12 = 2.5
)
NEARLY = 2.0  # behind the best, in the same unit: left out
MOST = 2  # effects one after the other
SCALES = (
    0.1,
    0.25,
    0.5,
    1.0,
)  # of the discrepancy that is left beside the effect, over that without it


def shared_physics(
    columns: Mapping[str, np.ndarray],
    given: np.ndarray,
    gap: np.ndarray,
    known: np.ndarray,
    discrepancy: np.ndarray,
) -> dict[str, float]:
    """{effect: share} of what the controls show; empty where no effect of the catalogue explains their gaps better.

    Parameters
    ----------
    columns : dict
        Effect -> (m, N) array, D_q / sqrt(m).
    given : (N,) bool array
        Points of the controls.
    gap : (N,) array
        Simulated - measured.
    known, discrepancy : (N, N) arrays
        U, and the discrepancy that was learned without such an effect.
    """
    own = np.ix_(given, given)
    views = []
    for scale in SCALES:
        try:
            factor = cholesky(known[own] + scale**2 * discrepancy[own], lower=True)
        except LinAlgError:
            continue
        white = {
            name: solve_triangular(factor, rows[:, given].T, lower=True)
            for name, rows in columns.items()
        }
        views.append((white, solve_triangular(factor, gap[given], lower=True), factor))
    chosen, best = {}, max((log_evidence(view, {}) for view in views), default=0.0)  # type: ignore[var-annotated]
    for _ in range(MOST if views else 0):
        logs = {
            name: max(log_evidence(view, chosen | {name: 1.0}) for view in views)
            for name in columns
            if name not in chosen
        }
        if not logs or max(logs.values()) < best + LEAST_GAIN:
            break
        best = max(logs.values())
        near = {name: value for name, value in logs.items() if value > best - NEARLY}
        total = log_sum_exp(np.array([*near.values()]))
        chosen |= {name: float(np.exp(value - total)) for name, value in near.items()}
    return chosen


def log_evidence(
    view: tuple[dict[str, np.ndarray], np.ndarray, np.ndarray], shares: Mapping[str, float]
) -> float:
    """Ln p of the gaps of the controls, up to a constant, with some effects (Woodbury)."""
    white, gap, factor = view
    value = -0.5 * gap @ gap - np.log(np.diag(factor)).sum()
    if not shares:
        return float(value)
    joint = np.hstack([np.sqrt(share) * white[name] for name, share in shares.items()])
    inner = np.eye(joint.shape[1]) + joint.T @ joint
    met = joint.T @ gap
    _, log_determinant = np.linalg.slogdet(inner)
    return float(value - 0.5 * log_determinant + 0.5 * met @ np.linalg.solve(inner, met))


def covariance_of(
    columns: Mapping[str, np.ndarray], shares: Mapping[str, float], count: int
) -> np.ndarray:
    """Sum of share x W_j over some effects, (count, count)."""
    total = np.zeros((count, count))
    for name, share in shares.items():
        total += share * columns[name].T @ columns[name]
    return total
