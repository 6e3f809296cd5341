"""Steady uniform flow of a layer on a bed that holds it, or carries it; creep below yield."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.verification.exact.layer import (
    gravity_normal,
    inertial_number_at,
    parabola,
    slope_ratio,
)

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def bagnold(case: "Case", z: Any) -> Any:
    """Bagnold flow of mu(I): u = (2/3) (I_a/d) sqrt(phi g cos a) (H^1.5 - (H - z)^1.5).

    mu(I) = T everywhere, so I = I_a = I_0 (T - mu_1)/(mu_2 - T) is constant, and du/dz = I
    sqrt(p/rho_s)/d with phi = rho/rho_s is integrated from the bed. Exists for mu_1 < T < mu_2. GDR
    MiDi (2004), Eur. Phys. J. E 14, 341.
    """
    depth, law = case.geometry.height_0, case.rheology
    inertial = inertial_number_at(slope_ratio(case), law)
    solid_fraction = law.density_bulk / law.density_grain
    factor = (
        2 / 3 * inertial / law.grain_diameter * math.sqrt(solid_fraction * gravity_normal(case))
    )
    return factor * (depth**1.5 - np.maximum(depth - z, 0.0) ** 1.5)


def incline_drucker_prager(case: "Case", z: Any) -> Any:
    """Inclined layer above yield: u = (rho g cos a/eta) (T - mu_1) (H z - z^2/2).

    tau = mu_1 p + eta du/dz = T p is integrated from the bed; zero for T <= mu_1. mu_1 = 0: the
    Nusselt film.
    """
    law = case.rheology
    excess = max(slope_ratio(case) - law.mu_1, 0.0)
    return parabola(case, z, law.density_bulk * gravity_normal(case) * excess / law.viscosity)


def film_newtonian(case: "Case", z: Any) -> Any:
    """Nusselt film, one half of a plane Poiseuille flow: u = (rho g sin a/eta) (H z - z^2/2)."""
    law = case.rheology
    return parabola(
        case, z, law.density_bulk * gravity_normal(case) * slope_ratio(case) / law.viscosity
    )


def film_bingham(case: "Case", z: Any) -> Any:
    """Sheared below, a plug of thickness tau_y/(rho g sin a) on top: half a plane Poiseuille flow.

    eta du/dz = rho g sin a (H - z) - tau_y where that is positive; Bird, Dai & Yarusso (1983), Rev.
    Chem. Eng. 1.
    """
    law = case.rheology
    drive = law.density_bulk * gravity_normal(case) * slope_ratio(case)
    sheared = case.geometry.height_0 - law.cohesion / drive
    height = np.minimum(z, max(sheared, 0.0))
    return drive / law.viscosity * (sheared * height - 0.5 * height**2)


def film_imposed_bed_stress(case: "Case", z: Any) -> Any:
    """Newtonian film on a sliding bed: u - u(0) = (mu_b rho g cos a/eta) (H z - z^2/2).

    The bed gives tau(0) = mu_b p(0) whatever the speed; tau(H) = 0. The film gains g cos(a) (T -
    mu_b) as a whole, so with mu_b = T it slides steadily: a Couette flow with imposed wall stress.
    """
    law = case.rheology
    curvature = law.density_bulk * gravity_normal(case) * case.boundary.mu_bed / law.viscosity
    return parabola(case, z, curvature)


def creep(case: "Case", z: Any) -> Any:
    """Creep of a layer below yield on a bed that holds it: u = z gd, gd = gd_min r/sqrt(1 - r^2).

    r = T/mu_1: mu_1 p gd/sqrt(gd^2 + gd_min^2) = T p has the same gd at every depth. An upper bound
    for the laws that add a viscous part.
    """
    ratio = slope_ratio(case) / case.rheology.mu_1
    return z * case.numerics.shear_rate_min * ratio / math.sqrt(1 - ratio**2)
