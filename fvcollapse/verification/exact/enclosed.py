"""Boxes and channels full of a Newtonian fluid; tables of the lid-driven cavity."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.case import GRAVITY

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def taylor_green(
    x: np.ndarray,
    z: np.ndarray,
    time: float,
    viscosity_kinematic: float,
    wave_number: float,
    speed: float,
) -> Any:
    """Vortices in a free-slip box: u = U sin kx cos kz F, w = -U cos kx sin kz F, F = exp(-2 nu k^2 t).

    The advection is the gradient of -(U F)^2 (cos 2kx + cos 2kz)/4 and only adds to the pressure;
    the viscous force is -2 nu k^2 u. Taylor & Green (1937), Proc. R. Soc. A 158, 499. (u, w), m/s.
    """
    k = wave_number
    fade = speed * np.exp(-2 * viscosity_kinematic * k**2 * time)
    return (
        fade * np.sin(k * x) * np.cos(k * z),
        -fade * np.cos(k * x) * np.sin(k * z),
    )


def taylor_green_pressure(
    x: np.ndarray,
    z: np.ndarray,
    time: float,
    viscosity_kinematic: float,
    wave_number: float,
    speed: float,
) -> np.ndarray:
    """Its pressure over the density, whose gradient balances the advection: (U F)^2 (cos 2kx + cos 2kz)/4, m2/s2.

    Beside the hydrostatic one, and but for a constant.
    """
    k = wave_number
    fade = speed * np.exp(-2 * viscosity_kinematic * k**2 * time)
    return 0.25 * fade**2 * (np.cos(2 * k * x) + np.cos(2 * k * z))


def poiseuille(case: "Case", z: Any) -> Any:
    """Between two walls that hold the fluid, driven along the bed: u = g sin(a)/(2 nu) z (H - z)."""
    law = case.rheology
    drive = GRAVITY * math.sin(math.radians(case.geometry.slope_angle_deg))
    return drive * law.density_bulk / (2 * law.viscosity) * z * (case.geometry.height_0 - z)


def couette_start_up(
    case: "Case", z: np.ndarray, time: float, speed: float, terms: int = 200
) -> np.ndarray:
    """Bed set in motion at t = 0 below a lid at rest.

    u = U (1 - z/H) - sum_n 2U/(n pi) sin(n pi z/H) exp(-nu (n pi/H)^2 t).
    """
    law, depth = case.rheology, case.geometry.height_0
    n = np.arange(1, terms + 1) * math.pi
    fade = np.exp(-law.viscosity / law.density_bulk * (n / depth) ** 2 * time)
    return speed * (1 - z / depth - np.sin(np.outer(z / depth, n)) @ (2 / n * fade))


# Lid-driven cavity, Re = 100: velocity along the moving wall on the line through the middle normal
# to it, against the distance from the opposite wall; and the velocity normal to it along the
# parallel line through the middle; in units of the wall's speed and the side.
# Ghia, Ghia & Shin (1982), J. Comput. Phys. 48, 387, tables I and II (129 x 129 grid).
GHIA_U = np.array(
    [
        (0.0547, -0.03717), (0.0625, -0.04192), (0.0703, -0.04775), (0.1016, -0.06434),
        (0.1719, -0.10150), (0.2813, -0.15662), (0.4531, -0.21090), (0.5000, -0.20581),
        (0.6172, -0.13641), (0.7344, 0.00332), (0.8516, 0.23151), (0.9531, 0.68717),
        (0.9609, 0.73722), (0.9688, 0.78871), (0.9766, 0.84123),
    ]
)  # fmt: skip
GHIA_V = np.array(
    [
        (0.0625, 0.09233), (0.0703, 0.10091), (0.0781, 0.10890), (0.0938, 0.12317),
        (0.1563, 0.16077), (0.2266, 0.17507), (0.2344, 0.17527), (0.5000, 0.05454),
        (0.8047, -0.24533), (0.8594, -0.22445), (0.9063, -0.16914), (0.9453, -0.10313), (0.9531, -0.08864),
        (0.9609, -0.07391), (0.9688, -0.05906),
    ]
)  # fmt: skip
# Marchi, Suero & Araki (2009), J. Braz. Soc. Mech. Sci. Eng. 31, 186 (1024 x 1024, extrapolated), at
# 1/16, 2/16, ..., 15/16.
MARCHI_U = np.array(
    [
        -0.041974991, -0.077125399, -0.109816214, -0.141930064, -0.172712391, -0.198470859,
        -0.212962392, -0.209149142, -0.182080595, -0.131256301, -0.060245594, 0.027874448,
        0.140425325, 0.310557090, 0.597466694,
    ]
)  # fmt: skip
MARCHI_V = np.array(
    [
        0.094807616, 0.149243000, 0.174342933, 0.179243328, 0.169132064, 0.145730201,
        0.108775865, 0.057536559, -0.007748504, -0.084066715, -0.163010143, -0.227827313,
        -0.253768577, -0.218690812, -0.123318170,
    ]
)  # fmt: skip
