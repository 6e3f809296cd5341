"""Constants of the partially regularised mu(I) law, and whether it can be evaluated at all.

The law (Barker & Gray 2017, equations 6.3 and 6.4) keeps mu(I) where that is well-posed, and replaces
it below the smallest such inertial number I_1 by sqrt(alpha / ln(A/I)). The criterion is that of
Barker, Schaeffer, Bohorquez & Gray (2015): with n = I mu'/mu and t = mu (1 - n/2) mu(I) is ill-posed
where C = 4 n (n - 1) + t^2 > 0 (and t < 2 (1 - n)).
"""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


LOWEST = 1.0e-300  # inertial number below which no limit is looked for
EXPONENT_MAX = 600.0  # of A/I_1: its exponential is a number, whatever I is


class Regularised(NamedTuple):
    """I_1 and A of the module docstring."""

    I_1: float
    A_minus: float


def mu_upper(inertial: float, mu_1: float, mu_2: float, I_0: float, mu_infinity: float) -> float:
    """(mu_1 I_0 + mu_2 I + mu_inf I^2) / (I_0 + I), Barker & Gray (2017), equation 6.3."""
    return (mu_1 * I_0 + mu_2 * inertial + mu_infinity * inertial * inertial) / (I_0 + inertial)


def criterion_mu_I(inertial: float, mu_1: float, mu_2: float, I_0: float) -> float:
    """C of the mu(I) law at inertial number `inertial`."""
    mu = mu_1 + (mu_2 - mu_1) * inertial / (inertial + I_0)
    exponent = inertial * (mu_2 - mu_1) * I_0 / (inertial + I_0) ** 2 / mu
    slope = mu * (1.0 - 0.5 * exponent)
    return 4.0 * exponent * (exponent - 1.0) + slope * slope


def lower_well_posed_limit(mu_1: float, mu_2: float, I_0: float) -> float:
    """Smallest inertial number at which mu(I) is well-posed.

    Raises
    ------
    ValueError
        The law is ill-posed for every inertial number, or for none.
    """
    from scipy.optimize import brentq  # 0.3 s that only the regularised law needs

    if mu_1 <= 0.0:
        raise ValueError("is well-posed down to I = 0")
    candidates = [I_0 * 10.0 ** (0.02 * j - 4.0) for j in range(300)]
    for low, high in zip(candidates, candidates[1:], strict=False):
        if criterion_mu_I(high, mu_1, mu_2, I_0) <= 0.0:
            tolerance = 1e-12
            while criterion_mu_I(low, mu_1, mu_2, I_0) <= 0.0 and low > LOWEST:
                low, high, tolerance = 0.1 * low, low, 1e-12 * low
            if low <= LOWEST:
                raise ValueError("is well-posed down to I = 0")
            return brentq(criterion_mu_I, low, high, args=(mu_1, mu_2, I_0), xtol=tolerance)
    raise ValueError("is ill-posed for every I")


def frictions(case: "Case") -> tuple[float, float]:
    """Friction coefficients (mu_1, mu_2) of the law: the older wall closure (equation 21) raises both."""
    rheology, walls, extra = case.rheology, case.effects.lateral_friction, 0.0
    if walls is not None and walls.closure == "friction_increase":
        wall = walls.mu_wall * walls.pressure_ratio
        extra = wall * walls.flowing_thickness / case.geometry.channel_width
    return rheology.mu_1 + extra, rheology.mu_2 + extra


def regularised(case: "Case") -> Regularised:
    """The `Regularised` constants of a case that passed `rule_regularised`."""
    (mu_1, mu_2), law = frictions(case), case.rheology
    I_1 = lower_well_posed_limit(mu_1, mu_2, law.I_0)
    mu_at_I_1 = mu_upper(I_1, mu_1, mu_2, law.I_0, law.mu_infinity)
    return Regularised(I_1, I_1 * math.exp(law.alpha_regularised / mu_at_I_1**2))


def rule_regularised(case: "Case") -> Iterator[tuple[str, str, str]]:
    """The regularised law joins a well-posed mu(I), by a logarithm that is a number."""
    law = case.rheology
    if law.law != "mu_I_regularised":
        return
    mu_1, mu_2 = frictions(case)
    try:
        I_1 = lower_well_posed_limit(mu_1, mu_2, law.I_0)
    except ValueError as error:
        found = f"{law.mu_1:g}, with which mu(I) {error} (mu_2 = {law.mu_2:g})"
        if mu_1 <= 0.0:
            yield "rheology.mu_1", found, "> 0 with rheology.law = mu_I_regularised"
            return
        limit = (
            "mu_1 and mu_2 that make mu(I) well-posed at some I: mu_2 well above mu_1, and both "
            "below about 1 (such as 0.48 and 0.73), or another rheology.law"
        )
        yield "rheology.mu_1", found, limit
        return
    greatest = EXPONENT_MAX * mu_upper(I_1, mu_1, mu_2, law.I_0, law.mu_infinity) ** 2
    if law.alpha_regularised > greatest:
        limit = f"<= {greatest:.3g} with rheology.mu_1 = {law.mu_1:g}"
        yield "rheology.alpha_regularised", f"{law.alpha_regularised:g}", limit
