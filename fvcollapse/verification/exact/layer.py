"""The uniform layer, in which most solutions live: its forces and its pressure.

A layer of depth H on a bed inclined by a moves with u(z) along the bed, w = 0, and across the layer

    p = rho g cos(a) (H - z),
    rho u_t = rho g sin(a) + d tau/dz - (2/w) mu_w p u/|u|,     tau(H) = 0.

Steady and without lateral walls tau = T p with T = tan(a): the layer has the same stress ratio
everywhere. Every function takes the case that the solver runs; z is the height above the bed, m,
and u is in m/s.
"""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.case import GRAVITY

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def slope_ratio(case: "Case") -> float:
    """T = tan(slope), the stress ratio of a steady uniform layer."""
    return math.tan(math.radians(case.geometry.slope_angle_deg))


def gravity_normal(case: "Case") -> float:
    """Gravity normal to the bed, g cos(slope), m/s2."""
    return GRAVITY * math.cos(math.radians(case.geometry.slope_angle_deg))


def wall_ratio(case: "Case") -> float:
    """mu_w / w, 1/m: the walls carry the part (mu_w / w) y of the weight above depth y, or none."""
    walls = case.effects.lateral_friction
    return 0.0 if walls is None else walls.mu_wall / case.geometry.channel_width


def pressure_hydrostatic(case: "Case", z: Any, depth: Any = None) -> Any:
    """Hydrostatic p = rho g cos(a) (H - z), Pa; zero above the surface."""
    depth = case.geometry.height_0 if depth is None else depth
    return case.rheology.density_bulk * gravity_normal(case) * np.maximum(depth - np.asarray(z), 0)


def pressure_tilted_box(case: "Case", x: Any) -> Any:
    """Bed pressure under a level surface: rho g (H cos a + (x - L/2) sin a), Pa."""
    slope = math.radians(case.geometry.slope_angle_deg)
    depth = case.geometry.height_0 * math.cos(slope) + (
        x - 0.5 * case.geometry.length_0
    ) * math.sin(slope)
    return case.rheology.density_bulk * GRAVITY * depth


def inertial_number_at(mu: Any, law: Any) -> Any:
    """I at which mu(I) = mu, for mu_1 <= mu < mu_2."""
    return law.I_0 * (mu - law.mu_1) / (law.mu_2 - mu)


def parabola(case: "Case", z: Any, curvature: Any) -> Any:
    """Velocity of constant curvature, at rest on the bed and free of stress at the surface, m/s."""
    return curvature * (case.geometry.height_0 * z - 0.5 * z**2)
