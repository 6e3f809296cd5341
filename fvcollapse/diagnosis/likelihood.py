"""Likelihood of a gap with and without an effect, bounds included, for one size of the discrepancy.

    N(gap + Delta_k(u); 0, C_k(s, u)),    C_k(s, u) = U + s^2 K_delta + Sigma_emulator,k(u).

Everything that does not depend on the gap is whitened once (`Whitened`) and serves all gaps (`Seen`). A bound (kind
upper or lower) contributes the probability, given all values, that it holds.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cholesky, qr, solve_triangular
from scipy.special import chdtrc

from fvcollapse.diagnosis.orthant import log_probability_positive

if TYPE_CHECKING:
    from fvcollapse.diagnosis.emulator import Response
    from fvcollapse.diagnosis.evidence import ModelComparison


class ResponseColumns(NamedTuple):
    """One closure of an effect (or of two) among all columns that are whitened."""

    variant: tuple[int, ...]
    responses: "tuple[Response, ...]"
    levels: np.ndarray  # columns of the differences
    errors: np.ndarray  # and of the errors of the emulator


class Whitened:
    """All columns multiplied by the inverse Cholesky factor of C(s), and their products."""

    if TYPE_CHECKING:
        span: np.ndarray | None
        factors: dict[bytes, np.ndarray]

    def __init__(self, comparison: "ModelComparison", sigma: float) -> None:
        values, bounds = comparison.values, comparison.bounds
        self.values, self.bounds, self.side = values, bounds, comparison.side
        self.full = comparison.covariance + sigma**2 * comparison.kernel
        self.factor = cholesky(self.full[np.ix_(values, values)], lower=True, check_finite=False)
        self.log_determinant = 2.0 * np.log(np.diag(self.factor)).sum()
        self.columns = self.solve(comparison.columns[values])
        self.products = self.columns.T @ self.columns
        self.coupling = self.solve(self.full[np.ix_(values, bounds)]).T
        self.bound_columns = comparison.columns[bounds]
        self.bound_covariance = self.full[np.ix_(bounds, bounds)] - self.coupling @ self.coupling.T
        self.span, self.factors = None, {}
        self.stacks = comparison.stacks

    def solve(self, columns: np.ndarray) -> np.ndarray:
        """Inverse Cholesky factor times columns."""
        return solve_triangular(self.factor, columns, lower=True, check_finite=False)

    def see(self, gap: np.ndarray) -> "Seen":
        """The gap whitened in the same way."""
        return Seen(self, gap)

    def chi_square_p(
        self, residual: np.ndarray, errors: np.ndarray | None, mask: np.ndarray
    ) -> float:
        """Probability of a larger chi-square of the masked points; 1 where there is none.

        `errors` (m, N), whose squares are added to the covariance, may be None.
        """
        rows = np.flatnonzero(mask)
        if len(rows) == 0:
            return 1.0
        key = rows.tobytes()
        if key not in self.factors:
            part = self.full[np.ix_(rows, rows)]
            self.factors[key] = cholesky(part, lower=True, check_finite=False)
        columns = residual[rows, None]
        if errors is not None:
            columns = np.hstack([columns, errors[:, rows].T])
        white = solve_triangular(self.factors[key], columns, lower=True, check_finite=False)
        products = white.T @ white
        square, met, spread = products[0, 0], products[0, 1:], products[1:, 1:]
        square -= met @ np.linalg.solve(np.eye(len(met)) + spread, met)
        return float(chdtrc(len(rows), max(square, 0.0)))  # round-off can make it negative

    def basis(self) -> np.ndarray:
        """Orthonormal basis of the whitened columns; computed once."""
        if self.span is None:
            if 0 in self.columns.shape:  # no effects, or nothing but bounds was measured
                self.span = self.columns[:, :0]
            else:
                self.span = span_of(self.columns)
        return self.span


def span_of(columns: np.ndarray) -> np.ndarray:
    """Orthonormal basis (n, rank) of the span of columns (n, m).

    By a pivoted QR: the iteration for singular values failed on columns of very different size.
    """
    basis, rest, _ = qr(columns, mode="economic", pivoting=True)
    size = np.abs(np.diag(rest))
    return basis[:, size > 1.0e-6 * max(size[0], 1.0e-300)]


class Seen:
    """A gap through the eyes of one C(s)."""

    def __init__(self, whitened: Whitened, gap: np.ndarray) -> None:
        self.whitened = whitened
        self.gap = whitened.solve(gap[whitened.values])
        self.bound_gap = gap[whitened.bounds]
        self.square = float(self.gap @ self.gap)
        self.constant = len(self.gap) * np.log(2.0 * np.pi) + whitened.log_determinant
        self.projections = whitened.columns.T @ self.gap

    def log_likelihood(self) -> float:
        """Log-likelihood without an effect."""
        own = self.whitened
        expected = own.coupling @ self.gap
        beyond = own.side * (expected - self.bound_gap)
        return -0.5 * (self.square + self.constant) + float(
            log_probability_positive(beyond[None], own.bound_covariance[None], own.side)[0]
        )

    def outside(self, difference: np.ndarray) -> float:
        """Mean square of the whitened residual outside the span of all responses."""
        basis = self.whitened.basis()
        residual = self.gap + self.whitened.solve(difference[self.whitened.values])
        rest = residual - basis @ (basis.T @ residual)
        return float(rest @ rest / max(len(rest) - basis.shape[1], 1))


def joined(first: ResponseColumns, second: ResponseColumns) -> ResponseColumns:
    """The closure of two effects together."""
    return ResponseColumns(
        first.variant + second.variant,
        first.responses + second.responses,
        np.concatenate([first.levels, second.levels]),
        np.concatenate([first.errors, second.errors]),
    )


def level_weights(closure: ResponseColumns, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights (q, n) of the levels of a closure and variance (q,) of its errors.

    Of two effects the larger variance holds for the errors of both.
    """
    weights, variances, start = [], [], 0
    for response in closure.responses:
        own, variance = response.weights(u[:, start : start + response.dimension])
        start += response.dimension
        weights.append(own)
        variances.append(variance)
    return np.hstack(weights), np.max(variances, axis=0)


def response_at(closure: ResponseColumns, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Difference (N,) and errors (m, N), whose squares sum to their covariance, at u (d,)."""
    weights, variance = level_weights(closure, u[None])
    levels = np.vstack([each.differences for each in closure.responses])
    errors = np.vstack([each.errors for each in closure.responses])
    return weights[0] @ levels, np.sqrt(variance[0]) * errors
