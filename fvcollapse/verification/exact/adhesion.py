"""Adhesive grains on a slope, below a ceiling and behind a vertical cut; p_c is `effects.cohesion.adhesion`, Pa."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.verification.exact.layer import gravity_normal, slope_ratio

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def strength(case: "Case") -> float:
    """Strength mu_1 p_c of grains without pressure, Pa."""
    return case.rheology.mu_1 * case.effects.cohesion.adhesion


def adhesive_thickness(case: "Case") -> float:
    """Thickness mu_1 p_c/(rho g cos(a) (tan(a) - mu_1)) of the layer that a slope just does not move, m."""
    weight = case.rheology.density_bulk * gravity_normal(case)
    return strength(case) / (weight * (slope_ratio(case) - case.rheology.mu_1))


def adhesive_layer(case: "Case", z: Any) -> Any:
    """Velocity at z, m/s, of a drucker_prager layer: a plug of the above thickness on a sheared layer."""
    law = case.rheology
    sheared = case.geometry.height_0 - adhesive_thickness(case)
    drive = law.density_bulk * gravity_normal(case) * (slope_ratio(case) - law.mu_1)
    z = np.minimum(z, sheared)
    return drive / law.viscosity * (sheared * z - 0.5 * z**2)


def hanging_acceleration(case: "Case", depth: float) -> float:
    """Acceleration of a layer that hangs from a level ceiling, m/s2: none up to rho g H = p_c, then less by p_c."""
    held = case.effects.cohesion.adhesion / (case.rheology.density_bulk * depth)
    return max(GRAVITY - held, 0.0)


def cut_height(case: "Case", number: float) -> float:
    """Height of a vertical cut in a cohesive ground, number c/(rho g) tan(45 deg + phi/2), m.

    In plane strain the law is that of Mohr and Coulomb with sin(phi) = mu_1 and c cos(phi) = mu_1 p_c. The number is 2
    for a slice at the foot that carries all of the weight above it, 4 for a plane wedge, an upper bound; 3.78 for
    phi = 0 (Pastor, Thai & Francescato 2000, Int. J. Numer. Anal. Methods Geomech. 24, 921).
    """
    mu = case.rheology.mu_1
    weight = case.rheology.density_bulk * GRAVITY
    return (
        number
        * strength(case)
        / math.sqrt(1.0 - mu**2)
        * math.sqrt((1.0 + mu) / (1.0 - mu))
        / weight
    )
