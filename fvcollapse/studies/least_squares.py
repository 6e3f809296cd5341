"""Numerical uncertainty from four or more sizes: power series fitted to all values; Eca & Hoekstra (2014).

Three sizes give an order whatever the scatter of the values; more of them show the scatter. The
value is taken to depend on the refinement size h as

    phi(h) = phi_0 + a h^p,

fitted by least squares with equal weights and with weights 1/h. Of the fits with 0.5 <= p <= 2 the
one of the smaller standard deviation s is taken. If there is none, the best of phi_0 + a h and
phi_0 + a h^2 (where p > 2), and also phi_0 + a h + b h^2 (where p < 0.5), with either weight. With
e = |fit(h_1) - phi_0| at the finest size and D = (max phi - min phi) / (n - 1), the uncertainty of
the finest value is

    F e + s + |phi_1 - fit(h_1)|                  where s < D,
    3 s/D (e + s + |phi_1 - fit(h_1)|)            elsewhere,

F = 1.25 where 0.5 <= p < 2.1 and s < D, else 3. The standard deviation counts the parameters of the
fit, s^2 = sum n w (phi - fit)^2 / (n - parameters).

References
----------
Eca & Hoekstra (2014), J. Comput. Phys. 262, 104.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from fvcollapse.studies.convergence import HIGHEST_ORDER, LOWEST_ORDER, SAFETY, SAFETY_UNKNOWN

LEAST_VALUES = 4
ORDERS = np.linspace(-4.0, 8.0, 61)  # searched
TRUSTED_ORDER = 2.1
FIXED = {"h": (1.0,), "h^2": (2.0,), "h + h^2": (1.0, 2.0)}


class Fit(NamedTuple):
    """The fit to all values; errors are fractions of the finest value.

    Attributes
    ----------
    series : str
        "h^p", "h", "h^2" or "h + h^2".
    order : float
        p of the best fit of h^p, also where another series was taken.
    extrapolated : float
        phi_0.
    deviation, uncertainty : float
        s, and the uncertainty of the finest value.
    coefficients : list of (float, float)
        Exponent and coefficient of each term beside phi_0.
    """

    series: str
    order: float
    extrapolated: float
    deviation: float
    uncertainty: float
    coefficients: list


class Series(NamedTuple):
    """One fitted series."""

    name: str
    order: float
    limit: float
    terms: list
    deviation: float

    def at(self, h: Any) -> Any:
        """Its value at a size."""
        return self.limit + sum(a * h**p for p, a in self.terms)


def fit(sizes: Any, values: Any) -> Fit | None:
    """The `Fit` of four or more values, from coarse to fine; None where there is nothing to fit.

    That is with fewer values, a missing one, sizes that do not fall, equal values, or a finest
    value of zero.
    """
    if sizes is None or len(values) < LEAST_VALUES or None in values:
        return None
    h, phi = np.array(sizes), np.array(values)
    width = float(np.ptp(phi)) / (phi.size - 1)
    if not (np.diff(h) < 0.0).all() or width <= 1e-12 * np.abs(phi).max() or phi[-1] == 0.0:
        return None
    best = best_series(h / h[-1], phi)  # in units of the finest size
    finest = best.at(1.0)
    error, miss = abs(finest - best.limit), abs(phi[-1] - finest)
    if best.deviation < width:
        trusted = LOWEST_ORDER <= best.order < TRUSTED_ORDER
        safety = SAFETY if trusted else SAFETY_UNKNOWN
        uncertainty = safety * error + best.deviation + miss
    else:
        uncertainty = SAFETY_UNKNOWN * best.deviation / width * (error + best.deviation + miss)
    scale = abs(phi[-1])
    terms = [(p, float(a / h[-1] ** p)) for p, a in best.terms]
    return Fit(
        best.name,
        best.order,
        float(best.limit),
        float(best.deviation / scale),
        float(uncertainty / scale),
        terms,
    )


def best_series(h: np.ndarray, phi: np.ndarray) -> Any:
    """The series of the module's docstring, chosen by its rule."""
    weights = [np.full(h.size, 1.0 / h.size), (1.0 / h) / (1.0 / h).sum()]
    powers = [power_series(h, phi, weight) for weight in weights]
    good = [power for power in powers if LOWEST_ORDER <= power.order <= HIGHEST_ORDER]
    if good:
        return min(good, key=deviation)
    order = min(powers, key=deviation).order
    slow = any(power.order < LOWEST_ORDER for power in powers)
    names = FIXED if slow else ("h", "h^2")
    fixed = [fixed_series(h, phi, weight, name, order) for weight in weights for name in names]
    return min(fixed, key=deviation)


def deviation(series: Series) -> float:
    """The standard deviation of a series."""
    return series.deviation


def power_series(h: np.ndarray, phi: np.ndarray, weight: np.ndarray) -> Series:
    """phi_0 + a h^p, with p, a and phi_0 of least squares."""

    def misfit(order):
        return solved(phi, weight, [basis(h, order)])[1]

    start = ORDERS[np.argmin([misfit(order) for order in ORDERS])]
    step = ORDERS[1] - ORDERS[0]
    order = minimize_scalar(misfit, bounds=(start - step, start + step), method="bounded").x
    (shifted, slope), squares = solved(phi, weight, [basis(h, order)])
    # back from (h^p - 1)/p, which has a limit for p -> 0, to h^p
    terms = [(float(order), float(slope / order))]
    limit = shifted - slope / order
    return Series("h^p", float(order), limit, terms, scatter(squares, h.size, 3))


def basis(h: np.ndarray, order: float) -> np.ndarray:
    """(h^p - 1)/p, ln h for p = 0."""
    logs = np.log(h)
    return logs if abs(order) < 1e-9 else np.expm1(order * logs) / order


def fixed_series(
    h: np.ndarray, phi: np.ndarray, weight: np.ndarray, name: str, order: Any
) -> Series:
    """A series of given exponents; `order` is what the best power law has shown."""
    (limit, *found), squares = solved(phi, weight, [h**p for p in FIXED[name]])
    terms = [(p, float(a)) for p, a in zip(FIXED[name], found, strict=True)]
    return Series(name, order, limit, terms, scatter(squares, h.size, 1 + len(terms)))


def solved(phi: np.ndarray, weight: np.ndarray, columns: Any) -> Any:
    """Coefficients (constant first) of the weighted least squares, and the weighted sum of squares."""
    matrix, root = np.column_stack([np.ones(phi.size), *columns]), np.sqrt(weight)
    found = np.linalg.lstsq(matrix * root[:, None], phi * root, rcond=None)[0]
    return found, float((weight * (phi - matrix @ found) ** 2).sum())


def scatter(squares: float, count: int, parameters: int) -> float:
    """Standard deviation from a weighted mean of squares."""
    return float(np.sqrt(count * squares / (count - parameters)))
