"""Observed order, Richardson extrapolation and grid convergence index; knows nothing of runs.

The procedure is that of Celik et al. (2008), J. Fluids Eng. 130, 078001. A value is taken to depend
on the refinement size h as phi(h) = phi_0 + C h^p. From three sizes h_3 > h_2 > h_1, with
r_21 = h_2/h_1, r_32 = h_3/h_2, eps_21 = phi_2 - phi_1, eps_32 = phi_3 - phi_2 and
s = sign(eps_32/eps_21), the order is the fixed point of

    p = (ln|eps_32/eps_21| + q(p)) / ln r_21,    q(p) = ln((r_21^p - s) / (r_32^p - s)).

The iteration of the paper does not settle when r_32 exceeds the square of r_21, so the same fixed
point is bracketed instead: both sides differ by a function that only grows with p, which makes it
unique. One deviation: the paper takes the modulus of the right-hand side, and would so give a
positive order to differences that grow on refinement. Here the sign is kept, a fixed point p <= 0
is called diverging, and nothing is extrapolated from it. An order far from the formal one of the
scheme means that the sizes are not in the asymptotic range. A large one makes the index needlessly
small (two values that happen to agree), so beside it stands the index with the order limited to the
formal 2.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

SAFETY = 1.25  # factor of the index for three grids or more
FORMAL_ORDER = 2.0  # the highest of any term of the scheme
ROUND_OFF = 1.0e-12  # relative; differences below it are none


class Convergence(NamedTuple):
    """What three successive sizes say; None where it cannot be said. Errors are fractions.

    Attributes
    ----------
    behaviour : str
        "monotone" or "oscillatory" (both converge), "diverging", "unchanged" (three equal values),
        "undetermined" (two equal values, or a missing one), "not refined" (the sizes do not fall),
        "no order" (`differences`).
    order : float
        Observed p; negative if diverging.
    extrapolated : float
        Richardson's value at size zero.
    relative_error : float
        |phi_1 - phi_2| / |phi_1|, approximate.
    extrapolated_error : float
        |phi_ext - phi_1| / |phi_ext|.
    gci : float
        Index of the finest of the three: 1.25 relative_error / (r_21^p - 1).
    gci_limited : float
        The same with p at most 2.
    """

    behaviour: str
    order: float | None = None
    extrapolated: float | None = None
    relative_error: float | None = None
    extrapolated_error: float | None = None
    gci: float | None = None
    gci_limited: float | None = None


def successive(sizes, values, scale=None):
    """The `Convergence` of each three successive sizes.

    Parameters
    ----------
    sizes, values : sequences of float
        From coarse to fine; a value may be None. `sizes` None: differences only, without order.
    scale : float, optional
        What errors are relative to; default the values themselves.

    Returns
    -------
    list of Convergence
        The last one belongs to the finest three.
    """
    count = len(values) - 2
    if sizes is None:
        return [differences(values[n : n + 3], scale) for n in range(count)]
    return [convergence(sizes[n : n + 3], values[n : n + 3], scale) for n in range(count)]


def convergence(sizes, values, scale=None):
    """The `Convergence` of three sizes, from coarse to fine; parameters as in `successive`."""
    if not sizes[0] > sizes[1] > sizes[2] > 0.0:
        return differences(values, scale)._replace(behaviour="not refined")
    if any(value is None for value in values):
        return differences(values, scale)._replace(behaviour="undetermined")
    coarse, medium, fine = values
    eps_32, eps_21 = coarse - medium, medium - fine
    error = relative(fine - medium, fine, scale)
    none = ROUND_OFF * max(abs(value) for value in values)
    if abs(eps_32) <= none and abs(eps_21) <= none:
        return Convergence("unchanged", None, fine, 0.0, 0.0, 0.0, 0.0)
    if abs(eps_32) <= none or abs(eps_21) <= none:
        return Convergence("undetermined", relative_error=error)
    order = observed_order(sizes, eps_32 / eps_21)
    if order <= 0.0:
        return Convergence("diverging", order, relative_error=error)
    growth = growth_less_one(sizes, order)
    limited = growth_less_one(sizes, min(order, FORMAL_ORDER))
    extrapolated = fine - eps_21 / growth
    return Convergence(
        "monotone" if eps_32 * eps_21 > 0.0 else "oscillatory",
        order,
        extrapolated,
        error,
        relative(extrapolated - fine, extrapolated, scale),
        None if error is None else SAFETY * error / growth,
        None if error is None else SAFETY * error / limited,
    )


def growth_less_one(sizes, order):
    """r_21^p - 1, without overflow."""
    return math.expm1(min(order * math.log(sizes[1] / sizes[2]), 700.0))


def differences(values, scale=None):
    """Only the relative difference of the finest two of three values: no order is to be expected."""
    _, medium, fine = values
    missing = medium is None or fine is None
    error = None if missing else relative(fine - medium, fine, scale)
    return Convergence("no order", relative_error=error)


def observed_order(sizes, ratio):
    """Signed order p at which the differences of three sizes have the ratio eps_32/eps_21.

    Parameters
    ----------
    sizes : (h_3, h_2, h_1)
        From coarse to fine.
    ratio : float
        Not zero; negative when the values oscillate.
    """
    log_21, log_32 = math.log(sizes[1] / sizes[2]), math.log(sizes[0] / sizes[1])
    oscillates = ratio < 0.0

    def mismatch(order):
        return log_ratio(order, log_21, log_32, oscillates) - math.log(abs(ratio))

    bound = 1.0
    while mismatch(-bound) > 0.0 or mismatch(bound) < 0.0:
        bound *= 2.0
    return brentq(mismatch, -bound, bound, xtol=1e-12, rtol=1e-12)


def log_ratio(order, log_21, log_32, oscillates):
    """ln|eps_32/eps_21| of an exact power law of this order: p ln r_21 - q(p), for every sign of p."""
    if oscillates:
        q = np.logaddexp(0.0, order * log_21) - np.logaddexp(0.0, order * log_32)
    elif order == 0.0:
        q = math.log(log_21 / log_32)  # the limit
    else:
        q = log_minus_one(order * log_21) - log_minus_one(order * log_32)
    return order * log_21 - q


def log_minus_one(exponent):
    """ln|exp(exponent) - 1| without overflow or cancellation."""
    return max(exponent, 0.0) + math.log(-math.expm1(-abs(exponent)))


def relative(difference, value, scale=None):
    """|difference| over the scale, or over |value| where there is none; None if that is zero."""
    denominator = abs(value) if scale is None else scale
    return abs(difference) / denominator if denominator > 0.0 else None


def spread(values, scale=None):
    """Largest difference of any value from the last, relative; None if nothing can be compared."""
    if any(value is None for value in values):
        return None
    return relative(max(abs(value - values[-1]) for value in values), values[-1], scale)


def profile_distance(x, h, x_reference, h_reference):
    """L1 distance of two profiles over the area of the reference.

    Parameters
    ----------
    x, h : (n,) arrays
        Profile, linear between the abscissae and zero beyond the last.
    x_reference, h_reference : (m,) arrays
        The same on its own abscissae.
    """
    nodes = np.union1d(x, x_reference)
    gap = np.interp(nodes, x, h, right=0.0) - np.interp(nodes, x_reference, h_reference, right=0.0)
    a, b = gap[:-1], gap[1:]
    size = np.abs(a) + np.abs(b)
    # where the gap changes sign, two triangles instead of a trapezium
    mean = np.where(a * b < 0.0, (a * a + b * b) / np.where(size > 0.0, size, 1.0), size)
    distance = 0.5 * float((mean * np.diff(nodes)).sum())
    area = 0.5 * float(((h_reference[:-1] + h_reference[1:]) * np.diff(x_reference)).sum())
    return distance / area
