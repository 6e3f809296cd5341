"""Manufactured solutions: a flow is prescribed, and the force that drives it follows."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.verification.exact.layer import wall_ratio

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def viscosity(case: "Case", shear_rate: Any, pressure: Any) -> Any:
    """Eta, Pa s: constant, or mu_1 p/sqrt(gd^2 + gd_min^2) + viscosity of the Drucker-Prager law."""
    law, rate_min = case.rheology, case.numerics.shear_rate_min
    if law.law == "newtonian":
        return law.viscosity + 0.0 * shear_rate
    return law.mu_1 * pressure / np.sqrt(shear_rate**2 + rate_min**2) + law.viscosity


def manufactured_force(case: "Case", flow: Callable, x: Any, z: Any, time: float) -> Any:
    """Acceleration that makes `flow` a solution: u_t + div(u u + (p I - 2 eta D)/rho) - g, and what the walls take.

    Lateral walls, if the case has them, brake with (2 mu_w/w) p u/sqrt(|u|^2 + u_min^2)/rho, where
    u_min = gd_min H/10 is the regularisation of the solver.

    Parameters
    ----------
    flow : callable
        (x, z, time) -> u, w, p, u_x, u_z, w_x, analytic, with w_z = -u_x. Derivatives are taken by
        complex steps, which are exact to round-off (Squire & Trapp 1998, SIAM Rev. 40, 110).

    Returns
    -------
    (f_x, f_z) : arrays
        m/s2, beside gravity.
    """

    def flux(x, z):
        u, w, p, u_x, u_z, w_x = flow(x, z, time)
        eta = (
            viscosity(case, np.sqrt(4 * u_x**2 + (u_z + w_x) ** 2), p) / case.rheology.density_bulk
        )
        p = p / case.rheology.density_bulk
        shear = u * w - eta * (u_z + w_x)
        return u * u + p - 2 * eta * u_x, shear, w * w + p + 2 * eta * u_x

    step = 1e-30
    along, across = flux(x + 1j * step, z + 0j), flux(x + 0j, z + 1j * step)
    later = flow(x, z, time + 1j * step)
    slope = math.radians(case.geometry.slope_angle_deg)
    u, w, p = flow(x, z, time)[:3]
    slip_min = 0.1 * case.numerics.shear_rate_min * case.geometry.height_0
    brake = 2.0 * wall_ratio(case) * p / np.sqrt(u**2 + w**2 + slip_min**2)
    brake /= case.rheology.density_bulk
    return (
        (later[0].imag + along[0].imag + across[1].imag) / step
        - GRAVITY * math.sin(slope)
        + brake * u,
        (later[1].imag + along[1].imag + across[2].imag) / step
        + GRAVITY * math.cos(slope)
        + brake * w,
    )


def manufactured_box(x: Any, z: Any, time: float = 0.0) -> Any:
    """Flow in the unit box with free slip: stream function 0.1 sin kx sin 2kz, k = pi, and p > 0.

    Shear and extension are both present (the Taylor-Green flow has no shear). Returns u, w, p, u_x,
    u_z, w_x.
    """
    k, a = math.pi, 0.1
    sin_x, cos_x, sin_z, cos_z = np.sin(k * x), np.cos(k * x), np.sin(2 * k * z), np.cos(2 * k * z)
    return (
        2 * k * a * sin_x * cos_z,
        -k * a * cos_x * sin_z,
        3000.0 * (1.0 + 0.5 * cos_x * np.cos(k * z)),
        2 * k**2 * a * cos_x * cos_z,
        -4 * k**2 * a * sin_x * sin_z,
        k**2 * a * sin_x * sin_z,
    )


def manufactured_gyres(x: Any, z: Any, time: float = 0.0) -> Any:
    """Two gyres that swing in the unit box with free slip, once in 2 pi/3 s; at most about 1 m/s.

    Stream function 0.3 (cos(3t) sin kx + sin(3t) sin 2kx) sin kz, k = pi. Its two parts have
    different vorticities per stream function, so the advection is no gradient and the pressure
    cannot balance it, unlike that of the Taylor-Green flow. Returns u, w, p, u_x, u_z, w_x; the
    pressure is for a density of 1000 kg/m3.
    """
    k, a = math.pi, 0.3
    one, two = a * np.cos(3.0 * time), a * np.sin(3.0 * time)
    s = one * np.sin(k * x) + two * np.sin(2 * k * x)
    s_x = k * (one * np.cos(k * x) + 2 * two * np.cos(2 * k * x))
    s_xx = -(k**2) * (one * np.sin(k * x) + 4 * two * np.sin(2 * k * x))
    sin_z, cos_z = np.sin(k * z), np.cos(k * z)
    return (
        k * s * cos_z,
        -s_x * sin_z,
        1000.0 * (GRAVITY * (1.0 - z) + 0.5 * np.cos(k * x) * cos_z),
        k * s_x * cos_z,
        -(k**2) * s * sin_z,
        -s_xx * sin_z,
    )


def manufactured_surface(x: Any) -> Any:
    """Height of a curved free surface in the unit box, m; level at both walls."""
    return 0.6 + 0.1 * np.cos(math.pi * x)


def manufactured_below_surface(x: Any, z: Any, time: float = 0.0) -> Any:
    """Flow in the unit box below a curved free surface at rest, free slip on bed and walls.

    Stream function a sin(kx) (z y)^3 with the depth y below the surface: velocity, strain rate and
    pressure vanish on the surface, so that it bears no stress and does not move. Returns u, w, p,
    u_x, u_z, w_x.
    """
    k, a = math.pi, 15.0
    y, y_x, y_xx = (
        manufactured_surface(x) - z,
        -0.1 * k * np.sin(k * x),
        -0.1 * k**2 * np.cos(k * x),
    )
    s, s_x, s_xx = np.sin(k * x), k * np.cos(k * x), -(k**2) * np.sin(k * x)
    m, m_x, m_z, m_xx, m_xz, m_zz = z * y, z * y_x, y - z, z * y_xx, y_x, -2.0
    cube_x, cube_z = 3 * m**2 * m_x, 3 * m**2 * m_z
    cube_xx = 6 * m * m_x**2 + 3 * m**2 * m_xx
    cube_xz = 6 * m * m_x * m_z + 3 * m**2 * m_xz
    cube_zz = 6 * m * m_z**2 + 3 * m**2 * m_zz
    return (
        a * s * cube_z,
        -a * (s_x * m**3 + s * cube_x),
        10000.0 * y * (1.0 + 0.3 * np.cos(k * x)),
        a * (s_x * cube_z + s * cube_xz),
        a * s * cube_zz,
        -a * (s_xx * m**3 + 2 * s_x * cube_x + s * cube_xx),
    )
