"""The chute between lateral walls with the regularisation that the solver has: what the grid alone gets wrong.

The yield stress mu_1 p is reached as mu_1 p gd/sqrt(gd^2 + gd_min^2), and the friction of the walls as
mu_w p u/sqrt(u^2 + u_min^2) with u_min = gd_min H/10. Then nothing is rigid, and the balance

    d tau/dy = rho g sin a - (2/w) mu_w p u/sqrt(u^2 + u_min^2),    du/dy = -gd(tau, p),

y the depth, tau(0) = 0, u(H) = 0, is an initial value problem for the right velocity of the surface:
a larger one leaves a larger one at the bed.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from fvcollapse.verification.exact.layer import gravity_normal, slope_ratio, wall_ratio

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


ACCURACY = 1e-8


def shear_stress(case: "Case", shear_rate: Any, pressure: Any) -> Any:
    """Tau of the regularised Drucker-Prager or mu(I) law, Pa."""
    law, rate_min = case.rheology, case.numerics.shear_rate_min
    tau = law.mu_1 * pressure * shear_rate / math.hypot(shear_rate, rate_min)
    if law.law == "drucker_prager":
        return tau + law.viscosity * shear_rate
    scale = law.I_0 * math.sqrt(pressure / law.density_grain) / law.grain_diameter
    return tau + (law.mu_2 - law.mu_1) * pressure * shear_rate / (shear_rate + scale)


def shear_rate_at(case: "Case", tau: Any, pressure: Any) -> Any:
    """Its inverse, 1/s; odd in tau."""
    if tau == 0.0 or pressure <= 0.0:
        return 0.0
    high = case.numerics.shear_rate_min
    while shear_stress(case, high, pressure) < abs(tau):
        high *= 4.0
        if high > 1e9:
            return math.copysign(high, tau)  # beyond mu_2: only a wrong guess gets there
    found = brentq(
        lambda rate: shear_stress(case, rate, pressure) - abs(tau),
        0.0,
        high,
        xtol=1e-300,
        rtol=1e-13,
    )
    return math.copysign(found, tau)


def chute_regularised(case: "Case") -> Callable:
    """The function u(z) of the regularised chute, m/s; to 1e-7 of the velocity of the surface."""
    depth = case.geometry.height_0

    def at_bed(surface):
        return _descent(case, surface).y[0, -1]

    low, high = 0.0, 1e-3
    while at_bed(high) < 0.0:
        low, high = high, 4.0 * high
    surface = brentq(at_bed, low, high, xtol=1e-300, rtol=1e-12)
    profile = _descent(case, surface).sol

    def velocity(z):
        return np.maximum(profile(np.clip(depth - np.asarray(z, float), 0.0, depth))[0], 0.0)

    return velocity


def _descent(case, surface):
    """Integrate from the surface down; ends where the velocity falls below zero."""
    weight = case.rheology.density_bulk * gravity_normal(case)
    slip_min = 0.1 * case.numerics.shear_rate_min * case.geometry.height_0

    def slope(y, state):
        u, tau = state
        walls = 2.0 * wall_ratio(case) * y * u / math.hypot(u, slip_min)
        return -shear_rate_at(case, tau, weight * y), weight * (slope_ratio(case) - walls)

    def below_zero(y, state):
        return state[0] + 1e-3 * slip_min

    below_zero.terminal = True
    return solve_ivp(
        slope,
        (0.0, case.geometry.height_0),
        (surface, 0.0),
        method="LSODA",
        rtol=ACCURACY,
        atol=(1e-3 * ACCURACY * slip_min, ACCURACY * weight * case.geometry.height_0),
        events=below_zero,
        dense_output=True,
    )
