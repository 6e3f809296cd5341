"""Verification problems: definition, solution and pass criterion.

Errors are relative to a scale of the flow (its surface velocity, the weight, the area of the
surface). A problem passes if its largest error on the finest grid is within `tolerance` and, where
theory gives an order of convergence, the fitted order is at least the expected one less 0.2.
"""

import math
import sys
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from fvcollapse.errors import NumericalError
from fvcollapse.verification.terms import Term

ORDER_MARGIN = 0.2


class Problem(NamedTuple):
    """A flow with a known solution.

    `term` is the term of the equations that it verifies. `errors` takes the number of cells per
    depth (or per side) and returns the relative errors, a 1-D array. `tolerance` is that of the
    largest error on the finest grid, and `source` its origin where no order of convergence is
    expected.
    """

    name: str
    term: Term
    errors: Callable
    grids: tuple
    expected_order: float | None
    tolerance: float
    source: str = "discretisation"


def solve(problem: Problem, grids: Sequence[int] | None = None) -> dict:
    """Run a problem; return its row of the table.

    Returns
    -------
    dict
        name, grids, error_l1, error_l2, error_linf (lists, one value per grid; infinite where the
        solver failed), observed_order, expected_order, tolerance, passed.
    """
    grids = problem.grids if grids is None else grids
    errors = [errors_on(problem, cells) for cells in grids]
    l1 = [float(np.mean(np.abs(error))) for error in errors]
    l2 = [float(np.sqrt(np.mean(error**2))) for error in errors]
    linf = [float(np.max(np.abs(error))) for error in errors]
    order = fitted_order(grids, l2)
    passed = linf[-1] <= problem.tolerance
    if problem.expected_order is not None:
        passed = passed and order is not None and order >= problem.expected_order - ORDER_MARGIN
    return {
        "name": problem.name,
        "grids": list(grids),
        "error_l1": l1,
        "error_l2": l2,
        "error_linf": linf,
        "observed_order": order,
        "expected_order": problem.expected_order,
        "tolerance": problem.tolerance,
        "passed": bool(passed),
    }


def errors_on(problem: Problem, cells: int) -> np.ndarray:
    """Errors on one grid; infinite, with a line on stderr, where the solver fails."""
    try:
        return np.atleast_1d(problem.errors(cells))
    except NumericalError as error:
        print(f"{problem.name}, {cells} cells: {error}", file=sys.stderr)
        return np.array([math.inf])


def fitted_order(grids: Sequence[int], errors: Sequence[float]) -> float | None:
    """Least-squares slope of log(error) against log(cell size); None on one grid, or if an error is zero or NaN."""
    if len(errors) < 2 or not all(0.0 < error < math.inf for error in errors):
        return None
    return float(-np.polyfit(np.log(grids), np.log(errors), 1)[0])
