"""Growth of a small disturbance of a uniform flow."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.verification.exact.layer import (
    inertial_number_at,
    pressure_hydrostatic,
    slope_ratio,
)

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def growth_rate(
    wave: Any, shear_rate: Any, tau: Any, exponent: Any, stress_slope: Any, density: float
) -> Any:
    """Growth rate, 1/s, of a plane disturbance of a simple shear, for short waves.

    With the wave vector at angle theta to the flow, x = sin 2 theta, n = d ln tau / d ln shear_rate
    and t = d tau / d p, the momentum balance along and across the wave crests gives

        rate = k^2 tau / (rho shear_rate) ((1 - n)(1 - x^2) - 1 + t x) / (1 - t x),

    where the shear of the basic flow, which turns the wave, is left out (rate >> shear_rate). It is
    positive for some x exactly where `fvcollapse.step.ill_posedness` says so.

    Parameters
    ----------
    wave : (float, float)
        Wave vector, 1/m.
    shear_rate, tau, density : float
        1/s, Pa, kg/m3.
    """
    square = wave[0] ** 2 + wave[1] ** 2
    x = 2.0 * wave[0] * wave[1] / square
    bracket = (1.0 - exponent) * (1.0 - x * x) - 1.0 + stress_slope * x
    return square * tau / (density * shear_rate) * bracket / (1.0 - stress_slope * x)


def growth_rate_bagnold(case: "Case", wave: Any, z: Any, depth: float) -> Any:
    """Growth rate of a plane disturbance at height z of a Bagnold flow; and the shear rate there; 1/s."""
    law = case.rheology
    mu = slope_ratio(case)
    inertial = inertial_number_at(mu, law)
    pressure = pressure_hydrostatic(case, np.array([z]), depth)[0]
    shear_rate = inertial * math.sqrt(pressure / law.density_grain) / law.grain_diameter
    exponent = inertial * (law.mu_2 - law.mu_1) * law.I_0 / (inertial + law.I_0) ** 2 / mu
    stress_slope = mu * (1.0 - 0.5 * exponent)
    rate = growth_rate(wave, shear_rate, mu * pressure, exponent, stress_slope, law.density_bulk)
    return rate, shear_rate
