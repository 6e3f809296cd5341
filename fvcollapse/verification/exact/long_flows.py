"""Collapses in the limit of a long, shallow flow."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.verification.exact.layer import gravity_normal

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def huppert_front(area: float, viscosity_kinematic: float, time: Any) -> Any:
    """Front of a viscous current on a level bed that holds it: x_N = 1.411 (g q^3/(3 nu))^(1/5) t^(1/5).

    q is the area in x > 0. Asymptote for t -> infinity, whatever the start. Huppert (1982), J. Fluid
    Mech. 121, 43.
    """
    return 1.411 * (GRAVITY * area**3 / (3 * viscosity_kinematic) * time) ** 0.2


def huppert_depth(area: float, front: Any, x: Any) -> Any:
    """Its depth: h = (q/x_N) (1 - (x/x_N)^2)^(1/3) / B, B = integral over [0, 1] = 0.8413.

    The shape solves h_t = g/(3 nu) (h^3 h_x)_x; B = sqrt(pi)/2 Gamma(4/3)/Gamma(11/6).
    """
    mean = 0.5 * math.sqrt(math.pi) * math.gamma(4 / 3) / math.gamma(11 / 6)
    return area / front / mean * np.maximum(1 - (np.asarray(x) / front) ** 2, 0.0) ** (1 / 3)


def dam_break_depth(case: "Case", x: Any, time: float) -> Any:
    """Depth of an inviscid, frictionless layer released at x = length_0; shallow-water theory.

    In the frame that falls with g sin a the bed is level: h = (2 c - s)^2/(9 g cos a) for -c < s <
    2 c, with s = (x - length_0 - g sin(a) t^2/2)/t and c = sqrt(g cos(a) H). Valid until the
    disturbance from the back wall arrives. Ritter (1892), Z. VDI 36, 947; Mangeney, Heinrich &
    Roche (2000), Pure Appl. Geophys. 157, 1081.
    """
    normal = gravity_normal(case)
    c = math.sqrt(normal * case.geometry.height_0)
    along = GRAVITY * math.sin(math.radians(case.geometry.slope_angle_deg))
    s = (np.asarray(x) - case.geometry.length_0 - 0.5 * along * time**2) / time
    return (2 * c - np.clip(s, -c, 2 * c)) ** 2 / (9 * normal)
