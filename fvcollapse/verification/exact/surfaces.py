"""Surfaces and the velocities that carry them."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np


def disc(x: Any, z: Any, x_centre: float, z_centre: float, radius: float) -> Any:
    """Signed distance to a circle, negative inside; m."""
    return np.hypot(x - x_centre, z - z_centre) - radius


def slotted_disc(x: Any, z: Any) -> Any:
    """Zalesak's disc in the unit square: radius 0.15 at (0.5, 0.75), slot 0.05 wide, 0.25 high.

    Signed distance. Zalesak (1979), J. Comput. Phys. 31, 335 (there in units of a hundredth).
    """
    x, z = x - 0.5, z - 0.75
    radius, half_width, top = 0.15, 0.025, 0.10
    bottom = -math.sqrt(radius**2 - half_width**2)
    corner = np.hypot(np.abs(x) - half_width, z - bottom)
    to_slot = np.maximum(np.abs(x) - half_width, z - top)  # negative in the slot, open downwards
    outside_slot = np.hypot(np.maximum(np.abs(x) - half_width, 0), np.maximum(z - top, 0))
    circle = np.hypot(x, z) - radius
    side = np.hypot(np.abs(x) - half_width, np.maximum(bottom - z, 0))
    roof = np.hypot(np.maximum(np.abs(x) - half_width, 0), z - top)
    in_slot = (to_slot < 0) & (z < top)
    inside = (circle < 0) & ~in_slot
    depth = np.minimum(-circle, np.where(z < bottom, corner, outside_slot))
    above_chord = np.where(np.abs(x) < half_width, z > bottom, True)
    away = np.where(
        in_slot & above_chord,
        np.minimum(side, roof),
        np.where((np.abs(x) < half_width) & (z < 0), corner, circle),
    )
    return np.where(inside, -depth, away)


def rotation(x: Any, z: Any, time: float) -> Any:
    """Solid-body rotation about the middle of the unit square, one turn per second; (u, w), m/s."""
    return 2 * math.pi * (0.5 - z), 2 * math.pi * (x - 0.5)


def single_vortex(period: float) -> Callable:
    """Velocity (x, z, time) -> (u, w) that stretches a disc into a spiral and back within `period`.

    Stream function sin^2(pi x) sin^2(pi z)/pi times cos(pi t/period); LeVeque (1996), SIAM J.
    Numer. Anal. 33, 627.
    """

    def velocity(x, z, time):
        swing = math.cos(math.pi * time / period)
        u = -(np.sin(math.pi * x) ** 2) * np.sin(2 * math.pi * z) * swing
        w = np.sin(math.pi * z) ** 2 * np.sin(2 * math.pi * x) * swing
        return u, w

    return velocity
