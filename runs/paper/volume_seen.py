"""What a side view makes of the volume of a pile: the change of the area under the profile that is seen.

Each function gives the change of that area over the area of the column, (n,), at the times of the profiles (of `cloud`:
of the fields). 0.1 is +10 %. Pure functions of arrays and results, SI units.
"""

import math

import numpy as np
from scipy.integrate import trapezoid

from fvcollapse.case.case import GRAVITY
from fvcollapse.measure.observation import seen_place
from fvcollapse.measure.pile import SPEED_STATIC, front_position, thickness

EDGE = 1.0e-3  # m; where the layer is thinner it has ended, for an error of the zero of the heights
AT_SURFACE = 0.3  # solid fraction at the foot of a cloud of grains


def column_area(case):
    """Area of the column before the gate opens, m2."""
    return case.geometry.height_0 * case.geometry.length_0


def area(x, heights, case):
    """Area under profiles (n, nx) whose grains are seen at x (nx,), over that of the column, (n,)."""
    return trapezoid(heights, x, axis=-1) / column_area(case)


def as_it_is(result):
    """Of the flow itself, by its own volume: profiles miss up to half a cell of a vertical face."""
    return np.interp(result.profiles.time, result.time, result.series["relative_volume"])


def changed(result, x, heights):
    """Of profiles that are seen: what they hold more than those of the flow, added to the change of the flow."""
    profiles, case = result.profiles, result.case
    more = area(x, heights, case) - area(profiles.x, profiles.thickness, case)
    return as_it_is(result) + more


def from_a_side(result, view):
    """Of the profile that a camera at the "wall" or above the "centre" sees (`transverse_profile`)."""
    case = result.case.replace(**{"effects.transverse_profile.view": view})
    return changed(result, seen_place(result.profiles.x, case), result.profiles.thickness)


def above(result, least):
    """Of what is at least as thick as `least` [m]; thinner parts are not seen."""
    h = result.profiles.thickness
    return changed(result, result.profiles.x, np.where(h >= least, h, 0.0))


def raised(result, zero):
    """Of heights that are read from a bed `zero` [m] too low, from the back wall to the 1 mm front."""
    x, case = result.profiles.x, result.case
    front = np.array([front_position(x, h, EDGE) for h in result.profiles.thickness])
    return as_it_is(result) + zero * (front - case.geometry.length_0) / column_area(case)


def blurred(result, exposure):
    """Of the highest that a surface stands during an exposure [s], from each time on."""
    time, h = result.profiles.time, result.profiles.thickness
    highest = h.copy()
    for n, start in enumerate(time):
        during = (time >= start) & (time <= start + exposure + 1e-9)
        highest[n] = h[during].max(axis=0)
    return changed(result, result.profiles.x, highest)


def surface_speed(field, case):
    """Speed of the uppermost grains of each column of cells (nx,), m/s; zero where there are none."""
    h = thickness(field["level_set"], field["dz"])
    h = 0.5 * (h[:-1] + h[1:])
    u, w = field["u"], field["w"]
    speed = np.hypot(0.5 * (u[:-1] + u[1:]), 0.5 * (w[:, :-1] + w[:, 1:]))
    top = np.clip((h / field["dz"] - 0.5).astype(int), 0, speed.shape[1] - 1)  # at least half full
    return np.where(h > 0.5 * field["dz"], speed[np.arange(len(h)), top], 0.0)


def cloud_height(scale, case):
    """Height above the surface up to which a cloud of grains hides what is behind it, m.

    Its solid fraction falls as 0.3 exp(-z/scale). Grains of the diameter d hide a line of sight of the length w where
    1.5 nu w/d = 1. What the cloud holds the pile has lost.

    Parameters
    ----------
    scale : (n,) array or float
        [m]
    case : Case
        With the width of the channel, which must be finite.
    """
    grains = case.rheology
    along = 1.5 * AT_SURFACE * case.geometry.channel_width / grains.grain_diameter
    lost = AT_SURFACE * grains.density_grain / grains.density_bulk
    return scale * (max(math.log(along), 0.0) - lost)


def cloud(result, share):
    """Of a cloud of grains above the moving surface, at the times of the fields.

    The grains leave the surface with vertical velocities whose standard deviation is `share` times its speed, and fall
    back: the cloud thins over the height (share u)^2/(g cos a).
    """
    case = result.case
    weight = GRAVITY * math.cos(math.radians(case.geometry.slope_angle_deg))
    found = []
    for index in range(len(result.field_times)):
        field = result.field(index)
        scale = (share * surface_speed(field, case)) ** 2 / weight
        found.append(cloud_height(scale, case).sum() * field["dx"] / column_area(case))
    return np.array(found)


def moving_length(field, case):
    """Length of the surface that moves, m."""
    return float((surface_speed(field, case) > SPEED_STATIC).sum() * field["dx"])
