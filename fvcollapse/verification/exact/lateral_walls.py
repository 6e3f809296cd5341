"""Steady uniform flow between two lateral walls."""

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import quad

from fvcollapse.verification.exact.layer import (
    gravity_normal,
    inertial_number_at,
    slope_ratio,
    wall_ratio,
)

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def flowing_depth(case: "Case") -> float:
    """h_f = w (T - mu_1)/mu_w, where the walls carry the excess drive; Taberlet et al. (2003)."""
    return (slope_ratio(case) - case.rheology.mu_1) / wall_ratio(case)


def chute_drucker_prager(case: "Case", z: np.ndarray) -> np.ndarray:
    """Flow between lateral walls: eta du/dz = rho g cos a ((T - mu_1) y - (mu_w/w) y^2), y = H - z.

    Momentum above depth y: tau = rho g cos a (T y - (mu_w/w) y^2). At rest below h_f, if the layer
    is that deep.
    """
    law = case.rheology
    y, bottom = _depths(case, z)
    excess = slope_ratio(case) - law.mu_1

    def integral(depth):
        return excess * depth**2 / 2 - wall_ratio(case) * depth**3 / 3

    factor = law.density_bulk * gravity_normal(case) / law.viscosity
    return factor * (integral(bottom) - integral(np.minimum(y, bottom)))


def chute_mu_I(case: "Case", z: np.ndarray) -> np.ndarray:
    """mu(I(y)) = T - (mu_w/w) y; u = integral of (I/d) sqrt(phi g cos a y) from the depth of rest.

    Jop, Forterre & Pouliquen (2005), J. Fluid Mech. 541, 167, width-averaged.
    """
    law = case.rheology
    y, bottom = _depths(case, z)
    scale = (
        math.sqrt(law.density_bulk / law.density_grain * gravity_normal(case)) / law.grain_diameter
    )

    def shear(depth):
        mu = slope_ratio(case) - wall_ratio(case) * depth
        return scale * inertial_number_at(mu, law) * math.sqrt(depth)

    return np.array([quad(shear, min(depth, bottom), bottom, epsabs=1e-12)[0] for depth in y])


def _depths(case, z):
    """Depths y = H - z >= 0 of the points, and the depth of rest: h_f or the bed."""
    depth = case.geometry.height_0
    return np.maximum(depth - np.asarray(z, float), 0.0), min(flowing_depth(case), depth)
