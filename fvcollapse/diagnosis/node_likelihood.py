"""Likelihood of a gap with an effect, at many nodes of its parameters and all sizes of the discrepancy at once.

    N(gap + sum_j w_j(u) Delta_j; 0, C(s) + v(u) sum_j e_j e_j')

is a quadratic form of the weights w of the levels. What does not depend on the gap is computed once for each closure
(`Stack`), and once for nodes that come again with every gap (`Terms`).
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.diagnosis.likelihood import level_weights
from fvcollapse.diagnosis.orthant import log_probability_positive

if TYPE_CHECKING:
    from fvcollapse.diagnosis.likelihood import ResponseColumns, Seen, Whitened


class Terms(NamedTuple):
    """What the likelihood at q nodes is made of, whatever the gap; S sizes of the discrepancy.

    Attributes
    ----------
    nodes : (q, d) array
    weights : (q, n) array
        Of the levels.
    shrunk : (S, q, m) array
        Variance of the errors of the emulator, given the data, in units of that without.
    fixed : (S, q) array
        Quadratic form of the weights and logarithm of the determinant.
    """

    nodes: np.ndarray
    weights: np.ndarray
    shrunk: np.ndarray
    fixed: np.ndarray


class Stack:
    """The whitened columns of one closure for S sizes of the discrepancy.

    The errors of the emulator are latent amplitudes of variance v: Sherman-Morrison-Woodbury in their eigenbasis.

    Parameters
    ----------
    whitened : sequence of Whitened
    closure : ResponseColumns
    """

    def __init__(self, whitened: "Sequence[Whitened]", closure: "ResponseColumns") -> None:
        levels, errors = closure.levels, closure.errors
        self.closure, self.whitened, self.remembered = closure, whitened, {}  # type: ignore[var-annotated]
        products = np.array([own.products for own in whitened])
        sizes, self.turn = np.linalg.eigh(products[:, errors[:, None], errors])
        self.sizes = np.maximum(sizes, 0.0)
        self.square = products[:, levels[:, None], levels]
        self.met = products[:, levels[:, None], errors] @ self.turn
        self.bounds = [
            BoundColumns(own, closure, turn)
            for own, turn in zip(whitened, self.turn, strict=True)
            if len(own.bounds)
        ]

    def terms(self, nodes: np.ndarray) -> Terms:
        """The `Terms` of nodes (q, d); those of nodes that cannot be written to are remembered."""
        found = self.remembered.get(id(nodes))
        if found is not None:
            return found
        weights, variance = level_weights(self.closure, nodes)
        quadratic = ((weights @ self.square) * weights).sum(axis=2)
        growth = 1.0 + variance[:, None] * self.sizes[:, None, :]
        fixed = quadratic + np.log(growth).sum(axis=2)
        found = Terms(nodes, weights, variance[:, None] / growth, fixed)
        if not nodes.flags.writeable:  # they are in the terms: their id stays theirs
            self.remembered[id(nodes)] = found
        return found

    def log_likelihood(self, seen: "Sequence[Seen]", nodes: np.ndarray) -> np.ndarray:
        """Log-likelihood of a gap, seen by each C(s), at nodes (q, d): (q, S)."""
        terms = self.terms(nodes)
        closure, weights = self.closure, terms.weights
        projections = np.array([own.projections for own in seen])
        start = projections[:, None, closure.errors] @ self.turn
        met = start + weights @ self.met
        square = np.array([own.square for own in seen])[:, None] + terms.fixed
        square += 2.0 * (projections[:, closure.levels] @ weights.T)
        square -= (met**2 * terms.shrunk).sum(axis=2)
        constant = [own.constant for own in seen]
        log_values = -0.5 * (square + np.array(constant)[:, None])
        for row, columns in enumerate(self.bounds):
            log_values[row] += columns.log_probability(
                seen[row], weights, met[row], terms.shrunk[row]
            )
        return log_values.T


class BoundColumns:
    """The columns of a closure at the bounds, given all values, for one size of the discrepancy.

    Parameters
    ----------
    whitened : Whitened
    closure : ResponseColumns
    turn : (m, m) array
        Eigenbasis of the errors of the emulator.
    """

    def __init__(self, whitened: "Whitened", closure: "ResponseColumns", turn: np.ndarray) -> None:
        levels, errors = closure.levels, closure.errors
        error_columns = whitened.columns[:, errors] @ turn
        self.errors = whitened.bound_columns[:, errors] @ turn - whitened.coupling @ error_columns
        self.products = self.errors.T[:, :, None] * self.errors.T[:, None, :]
        self.levels = whitened.bound_columns[:, levels].T
        self.expected = (whitened.coupling @ whitened.columns[:, levels]).T

    def log_probability(
        self, seen: "Seen", weights: np.ndarray, met: np.ndarray, shrunk: np.ndarray
    ) -> np.ndarray:
        """Logarithm of the probability that the bounds hold, (q,): mean and covariance of what they miss."""
        own = seen.whitened
        residual = seen.bound_gap + weights @ self.levels
        expected = own.coupling @ seen.gap + weights @ self.expected
        expected = expected + (met * shrunk) @ self.errors.T
        spread = np.tensordot(shrunk, self.products, 1)
        spread += own.bound_covariance
        return log_probability_positive(own.side * (expected - residual), spread, own.side)


def stack_of(seen: "Sequence[Seen]", closure: "ResponseColumns") -> Stack:
    """The `Stack` of a closure for some `Seen` of the same comparison; made once."""
    stacks = seen[0].whitened.stacks
    key = (
        closure.levels.tobytes(),
        closure.errors.tobytes(),
        tuple(id(own.whitened) for own in seen),
    )
    if key not in stacks:
        stacks[key] = Stack([own.whitened for own in seen], closure)
    return stacks[key]
