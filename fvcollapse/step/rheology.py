"""Viscosity of the granular mass: eta(shear rate, pressure), one function for every law.

Norm convention, used everywhere: shear_rate = sqrt(2 D:D) (twice the paper's norm of D), stress S =
2 eta D, so that in simple shear tau = eta du/dz. The plastic part of every law is regularised once,
as yield / sqrt(shear_rate^2 + shear_rate_min^2): a stressed but unyielded mass creeps at a rate
known in closed form instead of being rigid.

| law | tau(shear_rate, p) | source |
|---|---|---|
| mu_I | mu_1 p + cohesion + eta_I shear_rate | Martin et al. (2017), equations 3-7 |
| drucker_prager | mu_1 p + cohesion + viscosity shear_rate | the same, equations 1 and 8 |
| bingham | cohesion + viscosity shear_rate | equation 1 with mu = 0 |
| newtonian | viscosity shear_rate | |
| mu_I_regularised | mu(I) p, mu -> 0 logarithmically as I -> 0 | Barker & Gray (2017), equations 6.3-6.4 |
"""

import math
from typing import NamedTuple

from fvcollapse.case.well_posed import frictions, regularised

from .compiled import inner_jit, kernel_jit

MU_I, DRUCKER_PRAGER, BINGHAM, NEWTONIAN, MU_I_REGULARISED = range(5)
LAWS = {
    "mu_I": MU_I,
    "drucker_prager": DRUCKER_PRAGER,
    "bingham": BINGHAM,
    "newtonian": NEWTONIAN,
    "mu_I_regularised": MU_I_REGULARISED,
}
ETA_FLOOR = (
    1.0e-3  # Pa s; a flow without pressure keeps a little viscosity, far below that of any law here
)

NO_PRESSURE = 1.0e-30  # Pa; stands for p <= 0 where a law would divide zero by zero


class Material(NamedTuple):
    """Constants of the law, SI; `grain_scale` is k = d sqrt(rho_grain) of the inertial number."""

    law: int
    mu_1: float
    mu_2: float
    I_0: float
    viscosity: float
    cohesion: float
    grain_scale: float
    shear_rate_min: float
    I_1: float
    A_minus: float
    alpha: float
    mu_infinity: float


def material(case):
    """`Material` of a case; the older wall closure (equation 21) raises mu_1 and mu_2 here.

    Parameters
    ----------
    case : Case
        With `rheology`, `numerics`, and `effects.lateral_friction`.

    Returns
    -------
    Material
    """
    rheology, (mu_1, mu_2) = case.rheology, frictions(case)
    law = LAWS[rheology.law]
    I_1 = A_minus = 0.0
    if law == MU_I_REGULARISED:
        I_1, A_minus = regularised(case)
    return Material(
        law,
        mu_1,
        mu_2,
        rheology.I_0,
        rheology.viscosity,
        rheology.cohesion,
        rheology.grain_diameter * math.sqrt(rheology.density_grain),
        case.numerics.shear_rate_min,
        I_1,
        A_minus,
        rheology.alpha_regularised,
        rheology.mu_infinity,
    )


@kernel_jit()
def with_shear_rate_min(material, shear_rate_min):
    """The same material with another regularisation rate (1/s)."""
    return Material(
        material.law,
        material.mu_1,
        material.mu_2,
        material.I_0,
        material.viscosity,
        material.cohesion,
        material.grain_scale,
        shear_rate_min,
        material.I_1,
        material.A_minus,
        material.alpha,
        material.mu_infinity,
    )


@inner_jit()
def with_extra_friction(material, extra_friction):
    """The same mu_I or drucker_prager material with `extra_friction` added to its friction coefficient."""
    return Material(
        material.law,
        material.mu_1 + extra_friction,
        material.mu_2 + extra_friction,
        material.I_0,
        material.viscosity,
        material.cohesion,
        material.grain_scale,
        material.shear_rate_min,
        material.I_1,
        material.A_minus,
        material.alpha,
        material.mu_infinity,
    )


@inner_jit()
def inertial_number(shear_rate, pressure, grain_scale):
    """Inertial number I = shear_rate d sqrt(rho_grain) / sqrt(p), equation 3; inf without pressure."""
    if pressure <= 0.0:
        return math.inf if shear_rate > 0.0 else 0.0
    return shear_rate * grain_scale / math.sqrt(pressure)


@kernel_jit()
def mu_of_upper_branch(inertial, mu_1, mu_2, I_0, mu_infinity):
    """(mu_1 I_0 + mu_2 I + mu_inf I^2) / (I_0 + I), Barker & Gray (2017), equation 6.3."""
    return (mu_1 * I_0 + mu_2 * inertial + mu_infinity * inertial * inertial) / (I_0 + inertial)


@kernel_jit()
def mu_regularised(inertial, material):
    """Partially regularised mu(I): sqrt(alpha / ln(A/I)) below I_1, the upper branch above."""
    if inertial <= 0.0:
        return 0.0
    if inertial < material.I_1:
        return math.sqrt(material.alpha / math.log(material.A_minus / inertial))
    return mu_of_upper_branch(
        inertial, material.mu_1, material.mu_2, material.I_0, material.mu_infinity
    )


@inner_jit(error_model="numpy")
def viscosity_mu_I(shear_rate, pressure, material):
    """`effective_viscosity` of the law mu_I, without branches."""
    p = max(pressure, NO_PRESSURE)
    least = material.shear_rate_min
    friction = (material.mu_1 * p + material.cohesion) / math.sqrt(
        shear_rate * shear_rate + least * least
    )
    faster = material.I_0 * math.sqrt(p) / material.grain_scale
    return max(friction + (material.mu_2 - material.mu_1) * p / (shear_rate + faster), ETA_FLOOR)


@kernel_jit(error_model="numpy")
def effective_viscosity(shear_rate, pressure, material):
    """Eta = tau / shear_rate in Pa s.

    Parameters
    ----------
    shear_rate : float
        sqrt(2 D:D), 1/s, >= 0.
    pressure : float
        Pa; its positive part acts.
    material : Material

    Returns
    -------
    float
        Pa s, between `ETA_FLOOR` and yield / shear_rate_min + viscous part.
    """
    if material.law == MU_I:
        return viscosity_mu_I(shear_rate, pressure, material)
    p = max(pressure, 0.0)
    plastic = 1.0 / math.sqrt(
        shear_rate * shear_rate + material.shear_rate_min * material.shear_rate_min
    )
    if material.law == DRUCKER_PRAGER:
        eta = (material.mu_1 * p + material.cohesion) * plastic + material.viscosity
    elif material.law == BINGHAM:
        eta = material.cohesion * plastic + material.viscosity
    elif material.law == NEWTONIAN:
        eta = material.viscosity
    else:
        mu = (
            mu_regularised(inertial_number(shear_rate, p, material.grain_scale), material)
            if p > 0.0
            else 0.0
        )
        eta = (mu * p + material.cohesion) * plastic
    return max(eta, ETA_FLOOR)


@inner_jit(error_model="numpy")
def effective_viscosities(eta, rate, pressure, material):
    """`effective_viscosity` at many points: eta, rate, pressure (n,). The arrays must not overlap."""
    if material.law == MU_I:  # its own loop, which the compiler turns into vector instructions
        for n in range(eta.size):
            eta[n] = viscosity_mu_I(rate[n], pressure[n], material)
    else:
        for n in range(eta.size):
            eta[n] = effective_viscosity(rate[n], pressure[n], material)


@inner_jit()
def shear_rate_at_stress(stress, pressure, upper, material):
    """Shear rate in [0, upper] at which eta * shear_rate = stress, 1/s.

    The law is monotone; regula falsi with the Illinois rule, to 1e-9 of the stress. The first point
    parts the steep, regularised end of the law from the rest.
    """
    low, high = 0.0, upper
    below, above = -stress, upper * effective_viscosity(upper, pressure, material) - stress
    if above <= 0.0:
        return upper
    side = 0
    middle = min(10.0 * material.shear_rate_min, 0.5 * upper)
    for _ in range(100):
        gap = middle * effective_viscosity(middle, pressure, material) - stress
        if abs(gap) <= 1e-9 * stress or high - low <= 1e-12 * upper:
            break
        if gap < 0.0:
            low, below = middle, gap
            if side < 0:
                above *= 0.5
            side = -1
        else:
            high, above = middle, gap
            if side > 0:
                below *= 0.5
            side = 1
        middle = (low * above - high * below) / (above - below)
    return middle
