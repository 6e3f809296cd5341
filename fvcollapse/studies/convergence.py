"""Observed order, Richardson extrapolation and grid convergence index of given values.

A value is taken to depend on the refinement size h as phi(h) = phi_0 + C h^p. From three sizes
h_3 > h_2 > h_1, with r_21 = h_2/h_1, r_32 = h_3/h_2, eps_21 = phi_2 - phi_1, eps_32 = phi_3 - phi_2
and s = sign(eps_32/eps_21), the order is the fixed point of

    p = (ln|eps_32/eps_21| + q(p)) / ln r_21,    q(p) = ln((r_21^p - s) / (r_32^p - s))

(Celik et al. 2008). The iteration of the paper does not settle when r_32 exceeds the square of r_21,
so the same fixed point is bracketed instead: both sides differ by a function that only grows with
p, which makes it unique. The paper takes the modulus of the right-hand side, and would so give a
positive order to differences that grow on refinement; here the sign is kept.

The index of the finest value says how far off it may be. With E = |eps_21| / (r_21^q - 1) and D the
largest difference among the three values:

| behaviour | when | index |
|---|---|---|
| monotone | eps_32/eps_21 > 0, 0.5 <= p <= 2 | 1.25 E, q = p but at most the formal order |
| not asymptotic | eps_32/eps_21 > 0, p > 2 | 1.25 max(E, D), q the formal order |
| not asymptotic | eps_32/eps_21 > 0, 0 < p < 0.5 | 3 D |
| oscillatory | eps_32/eps_21 < 0, p > 0 | 3 D |
| diverging | p <= 0 | 3 D |
| undetermined | one of the differences is zero | 3 D |

The first line is Celik et al., who do not limit p; limiting it to the formal order is the rule of
Oberkampf & Roy (2010), since two values that happen to agree give a large p and a small index. The
formal order is that of the term of lowest order, so that the index never counts on more than what
all terms have. Beyond 2, the highest order of any term of the scheme, and below 0.5 the sizes are
not in the asymptotic range, whatever the cause. Where no order can be trusted the range of the data
takes the place of the extrapolated error, with the factors of Eca & Hoekstra (2008). Nothing is
extrapolated but in the first line: an alternating sequence has its limit between its last two
values, and Richardson's formula would leave it on the other side. As in Celik et al. the share of
what oscillates is to be reported (`oscillating_share` for the points of a profile).

A profile has no sign: its differences are L1 distances of successive profiles, so it is monotone or
diverging, and eps_21, eps_32 enter the same formulas. (Distances to the finest profile would make
the last of them zero by construction, and distances to an extrapolated one would presuppose the
order that is sought.)

References
----------
Celik, Ghia, Roache, Freitas, Coleman & Raad (2008), J. Fluids Eng. 130, 078001.
Oberkampf & Roy (2010), Verification and Validation in Scientific Computing, chapter 8.
Eca & Hoekstra (2008), J. Mar. Sci. Technol. 13, 328, appendix 1.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

SAFETY = 1.25  # factor of the index where the order is observed, on three grids or more
SAFETY_UNKNOWN = 3.0  # where it is not
LOWEST_ORDER, HIGHEST_ORDER = 0.5, 2.0  # of the asymptotic range
ROUND_OFF = 1.0e-12  # relative; differences below it are none


class Convergence(NamedTuple):
    """Convergence over three successive sizes; None for what cannot be determined. Errors are fractions.

    Attributes
    ----------
    behaviour : str
        Of the table above, or "unchanged" (three equal values), "missing" (one of them), "not
        refined" (the sizes do not fall), "no order" (`difference_only`).
    order : float
        Observed p; negative if diverging.
    extrapolated : float
        Richardson's value at size zero; none for a profile.
    relative_error : float
        |phi_1 - phi_2| / |phi_1|, approximate.
    extrapolated_error : float
        |phi_ext - phi_1| / |phi_ext|.
    gci : float
        Index of the finest of the three.
    """

    behaviour: str
    order: float | None = None
    extrapolated: float | None = None
    relative_error: float | None = None
    extrapolated_error: float | None = None
    gci: float | None = None


def successive(judge: Callable, sizes: Any, values: Any, formal_order: float) -> list[Convergence]:
    """The `Convergence` of each three successive sizes.

    Parameters
    ----------
    judge : function
        `convergence` or `convergence_of_profiles`.
    sizes, values : sequences
        From coarse to fine; a value may be None. `sizes` None: differences only, without order.
    formal_order : float
        Order of the term of lowest order.

    Returns
    -------
    list of Convergence
        The last one belongs to the finest three.
    """
    triplets = [slice(n, n + 3) for n in range(len(values) - 2)]
    return [judge(sizes and sizes[three], values[three], formal_order) for three in triplets]


def convergence(sizes: Any, values: Any, formal_order: float) -> Convergence:
    """The `Convergence` of three numbers, from coarse to fine; parameters as in `successive`."""
    coarse, medium, fine = values
    error = None if medium is None or fine is None else relative(fine - medium, fine)
    if sizes is None:
        return Convergence("no order", relative_error=error)
    if None in values:
        return Convergence("missing", relative_error=error)
    none = ROUND_OFF * max(abs(value) for value in values)
    width = max(values) - min(values)
    found = judged(sizes, coarse - medium, medium - fine, width, none, formal_order)
    extrapolated = extrapolated_error = None
    if found.shift is not None:
        extrapolated = fine + found.shift
        extrapolated_error = relative(found.shift, extrapolated)
    gci = None if found.bound is None else relative(found.bound, fine)
    return Convergence(found.behaviour, found.order, extrapolated, error, extrapolated_error, gci)


def convergence_of_profiles(sizes: Any, profiles: Any, formal_order: float) -> Convergence:
    """The same for three profiles (x, h); errors are L1 distances over the area of the finest."""
    coarse, medium, fine = profiles
    eps_21 = profile_distance(*medium, *fine)
    if sizes is None:
        return Convergence("no order", relative_error=eps_21)
    eps_32 = profile_distance(*coarse, *medium) * area(*medium) / area(*fine)
    width = max(eps_21, eps_32, profile_distance(*coarse, *fine))
    found = judged(sizes, eps_32, eps_21, width, ROUND_OFF, formal_order)
    error = None if found.shift is None else abs(found.shift)
    return Convergence(found.behaviour, found.order, None, eps_21, error, found.bound)


class Judgement(NamedTuple):
    """Behaviour and order; Richardson's correction of the finest value, and the bound of the index, both absolute."""

    behaviour: str
    order: float | None
    shift: float | None
    bound: float | None


def judged(
    sizes: Any, eps_32: float, eps_21: float, width: float, none: float, formal_order: float
) -> Judgement:
    """The table of this module's docstring; `width` is the largest difference of the three."""
    if not sizes[0] > sizes[1] > sizes[2] > 0.0:
        return Judgement("not refined", None, None, None)
    if abs(eps_32) <= none and abs(eps_21) <= none:
        return Judgement("unchanged", None, 0.0, 0.0)
    if abs(eps_32) <= none or abs(eps_21) <= none:
        return Judgement("undetermined", None, None, SAFETY_UNKNOWN * width)
    order = observed_order(sizes, eps_32 / eps_21)
    if order <= 0.0:
        return Judgement("diverging", order, None, SAFETY_UNKNOWN * width)
    if eps_32 * eps_21 < 0.0:
        return Judgement("oscillatory", order, None, SAFETY_UNKNOWN * width)
    if order < LOWEST_ORDER:
        return Judgement("not asymptotic", order, None, SAFETY_UNKNOWN * width)
    limited = abs(eps_21) / growth_less_one(sizes, min(order, formal_order))
    if order > HIGHEST_ORDER:
        return Judgement("not asymptotic", order, None, SAFETY * max(limited, width))
    shift = -eps_21 / growth_less_one(sizes, order)
    return Judgement("monotone", order, shift, SAFETY * limited)


def growth_less_one(sizes: Any, order: float) -> float:
    """r_21^p - 1, without overflow."""
    return math.expm1(min(order * math.log(sizes[1] / sizes[2]), 700.0))


def observed_order(sizes: Any, ratio: float) -> float:
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


def log_ratio(order: float, log_21: float, log_32: float, oscillates: bool) -> float:
    """ln|eps_32/eps_21| of an exact power law of this order: p ln r_21 - q(p), for every sign of p."""
    if oscillates:
        q = np.logaddexp(0.0, order * log_21) - np.logaddexp(0.0, order * log_32)
    elif order == 0.0:
        q = math.log(log_21 / log_32)  # the limit
    else:
        q = log_minus_one(order * log_21) - log_minus_one(order * log_32)
    return order * log_21 - q


def log_minus_one(exponent: float) -> float:
    """ln|exp(exponent) - 1| without overflow or cancellation."""
    return max(exponent, 0.0) + math.log(-math.expm1(-abs(exponent)))


def relative(difference: float, value: float) -> float | None:
    """|difference| over |value|; None of a difference where the value vanishes beside it."""
    if difference == 0.0:
        return 0.0
    ratio = abs(difference) / abs(value) if value != 0.0 else math.inf
    return ratio if math.isfinite(ratio) else None


def spread(values: Sequence[Any]) -> float | None:
    """Largest difference of any value from the last, relative; None if nothing can be compared."""
    if None in values:
        return None
    return relative(max(abs(value - values[-1]) for value in values), values[-1])


# -- profiles ------------------------------------------------------------------------------------


def area(x: np.ndarray, h: np.ndarray) -> float:
    """Area below a profile."""
    return 0.5 * float(((h[:-1] + h[1:]) * np.diff(x)).sum())


def profile_distance(
    x: np.ndarray, h: np.ndarray, x_reference: np.ndarray, h_reference: np.ndarray
) -> float:
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
    return 0.5 * float((mean * np.diff(nodes)).sum()) / area(x_reference, h_reference)


def oscillating_share(profiles: Sequence[Any]) -> float:
    """Share of the points of the finest of three profiles at which the thickness oscillates on refinement.

    Counted are the nodes of the finest profile where any of the three has grains.
    """
    x = profiles[-1][0]
    coarse, medium, fine = (np.interp(x, place, height, right=0.0) for place, height in profiles)
    filled = np.maximum(np.maximum(coarse, medium), fine) > 0.0
    return float(((coarse - medium) * (medium - fine) < 0.0)[filled].mean())
