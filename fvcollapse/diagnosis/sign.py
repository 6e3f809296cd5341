"""The sign counts: whether an effect can close the gap at all, and what it makes worse.

An effect that shortens a run cannot explain one that is longer than the model's; its evidence is only as small as that
of having no effect, since its prior reaches down to weak effects. What is asked here is not how probable it is but
whether any strength of it reduces the misfit of what has a significant gap,

    closes = 1 - min over u of chi^2(gap + Delta(u)) / chi^2(gap),

with the covariance U + s^2 K_delta of the gap at the s at which effects are compared (`separability`). Calibrated
parameters are in U: what they can move is no gap.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.stats import chi2

from fvcollapse.diagnosis.likelihood import level_weights
from fvcollapse.diagnosis.names import effects_of
from fvcollapse.diagnosis.quadrature import first_nodes

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Evidence
    from fvcollapse.diagnosis.likelihood import ResponseColumns

DISCREPANCY = 0.2  # s, as of `separability`
SIGNIFICANT = 0.01  # p-value of the gap of an observable below which it has one
LEAST_CLOSED = 0.02  # share of the gap; by chance one parameter closes 1 of a chi^2 of 100 or more
WORSE = 1.0  # growth of the rms misfit of an observable, in standard uncertainties


class Direction:
    """What the effects of a comparison do to the gap of each observable.

    Parameters
    ----------
    covariance : (N, N) array
        U + s^2 K_delta.
    columns : (N, n) array
        Of the responses, see `ModelComparison`.
    observable : (N,) array of str
    is_value : (N,) array of bool
        False where the measurement is a bound: that does not count here.
    """

    def __init__(
        self,
        covariance: np.ndarray,
        columns: np.ndarray,
        observable: np.ndarray,
        is_value: np.ndarray,
    ) -> None:
        self.covariance, self.columns = covariance, columns
        self.sigma = np.sqrt(np.diag(covariance))
        self.rows = {
            str(name): np.flatnonzero(is_value & (observable == name))
            for name in dict.fromkeys(observable)
            if (is_value & (observable == name)).any()
        }
        self.factors: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def whitened(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(factor, columns) of some points: lower Cholesky factor, and the columns whitened with it."""
        key = rows.tobytes()
        if key not in self.factors:
            factor = cholesky(self.covariance[np.ix_(rows, rows)], lower=True, check_finite=False)
            self.factors[key] = factor, solve(factor, self.columns[rows])
        return self.factors[key]

    def significant(self, gap: np.ndarray) -> np.ndarray:
        """Points (m,) of the observables whose gap (N,) is significant, each judged by itself."""
        found = [np.empty(0, int)]
        for rows in self.rows.values():
            white = solve(self.whitened(rows)[0], gap[rows])
            if chi2.sf(white @ white, len(rows)) < SIGNIFICANT:
                found.append(rows)
        return np.sort(np.concatenate(found))

    def closes(
        self, gap: np.ndarray, rows: np.ndarray, closures: "Sequence[ResponseColumns]"
    ) -> float | None:
        """Largest share of the misfit of some points that any strength of an effect takes away; below 0 none does.

        Parameters
        ----------
        gap : (N,) array
        rows : (m,) array
            As `significant` gives them.
        closures : sequence of ResponseColumns

        Returns
        -------
        float or None
            None where no gap is significant, and of an effect that scatters, for that closes what has no direction.
        """
        scatters = any(one.scatters for closure in closures for one in closure.responses)
        if scatters or not len(rows):
            return None
        factor, columns = self.whitened(rows)
        white = solve(factor, gap[rows])
        before, least = float(white @ white), np.inf
        for closure in closures:
            dimension = sum(response.dimension for response in closure.responses)
            weights, _ = level_weights(closure, first_nodes(dimension, 0.0, 1.0))
            levels = columns[:, closure.levels]
            change = 2.0 * weights @ (levels.T @ white)
            change += ((weights @ (levels.T @ levels)) * weights).sum(axis=1)
            least = min(least, float(change.min()))
        return -least / before

    def worsens(self, gap: np.ndarray, difference: np.ndarray) -> tuple[str, ...]:
        """Observables whose rms misfit a difference (N,) makes larger by more than `WORSE`, the worst first."""
        growth = {}
        for name, rows in self.rows.items():
            before, after = (
                gap[rows] / self.sigma[rows],
                (gap + difference)[rows] / self.sigma[rows],
            )
            growth[name] = float(np.sqrt(np.mean(after**2)) - np.sqrt(np.mean(before**2)))
        worse = [name for name in growth if growth[name] > WORSE]
        return tuple(sorted(worse, key=lambda name: -growth[name]))


def solve(factor: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Inverse of a lower Cholesky factor times columns."""
    return solve_triangular(factor, columns, lower=True, check_finite=False)


def ruled_out(evidence: "Evidence") -> dict[str, str]:
    """{effect: reason} of the single effects that cannot close the gap in any direction of their prior.

    Without a significant gap none is ruled out: there is nothing to close.

    Parameters
    ----------
    evidence : Evidence
    """
    reasons = {}
    for name, hypothesis in evidence.hypotheses.items():
        closes = hypothesis.closes
        if len(effects_of(name)) != 1 or closes is None or closes >= LEAST_CLOSED:
            continue
        if closes < 0.0:
            reasons[name] = "at every plausible strength it makes the gap larger"
        else:
            least = f"{100.0 * LEAST_CLOSED:.0f} %"
            reasons[name] = f"no plausible strength of it closes {least} of the gap"
    return reasons
