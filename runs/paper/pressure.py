"""The pressure of a result against the hydrostatic one and against equation 22, cell by cell.

(22): p = rho g [cos a - sin a dh/dX - 2 |sin a| (dU/dX) / |dU/dZ|] (h - Z), its last term in the
flowing part only. A stored pressure is the mean over the grains of its cell, so h - Z is taken at
the middle of the grains there.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.signal import savgol_filter

from fvcollapse.case.case import GRAVITY
from fvcollapse.measure.pile import SPEED_STATIC, thickness

SHEAR_LEAST = 1.0  # 1/s; where |dU/dZ| is smaller the last term of (22) has no meaning
THICK = 0.010  # m; thinner columns hold one or two cells and say nothing of a profile


class Columns(NamedTuple):
    """A result at one time by cells (nx, nz): SI units, z and depth at the middle of the grains."""

    x: np.ndarray  # (nx,)
    h: np.ndarray  # (nx,)
    depth: np.ndarray
    weight: np.ndarray  # volume of grains in the cell, m2
    speed: np.ndarray
    computed: np.ndarray
    hydrostatic: np.ndarray
    equation_22: np.ndarray
    valid: np.ndarray  # flowing, thick enough, sheared: where all three are compared


def columns(field, case):
    """`Columns` of a stored field."""
    dx, dz, phi, u, w = (field[name] for name in ("dx", "dz", "level_set", "u", "w"))
    h_node = thickness(phi, dz)
    h = 0.5 * (h_node[:-1] + h_node[1:])
    nx, nz = field["pressure"].shape
    low = dz * np.arange(nz)[None, :]
    high = np.minimum(low + dz, h[:, None])
    filled = np.maximum(high - low, 0.0)
    depth = np.where(filled > 0.0, h[:, None] - 0.5 * (low + high), 0.0)
    u_centre = 0.5 * (u[:-1] + u[1:])
    speed = np.hypot(u_centre, 0.5 * (w[:, :-1] + w[:, 1:]))
    along, across = np.diff(u, axis=0) / dx, np.gradient(u_centre, dz, axis=1)
    alpha = math.radians(case.geometry.slope_angle_deg)
    weight = case.rheology.density_bulk * GRAVITY * depth
    # over five columns: a difference of neighbours would be mostly the grid's
    slope = savgol_filter(h, 5, 1, deriv=1, delta=dx)[:, None]
    flowing = (speed > SPEED_STATIC) & (filled > 0.5 * dz) & (h[:, None] >= THICK)
    sheared = np.abs(across) >= SHEAR_LEAST
    ratio = np.where(sheared & flowing, along / np.where(sheared, np.abs(across), 1.0), 0.0)
    rise = math.cos(alpha) - math.sin(alpha) * slope - 2.0 * abs(math.sin(alpha)) * ratio
    return Columns(
        dx * (np.arange(nx) + 0.5),
        h,
        depth,
        filled * dx,
        speed,
        field["pressure"],
        weight * math.cos(alpha),
        weight * rise,
        flowing & sheared,
    )


def misfit(columns, model):
    """Volume-weighted rms of (model - computed) over the valid cells, over the rms computed there."""
    weight = np.where(columns.valid, columns.weight, 0.0)
    gap = getattr(columns, model) - columns.computed
    scale = (weight * columns.computed**2).sum()
    return math.sqrt((weight * gap**2).sum() / scale) if scale > 0.0 else math.nan


def flowing_share_valid(columns):
    """Part of the flowing volume in which (22) is compared."""
    flowing = columns.weight * (columns.speed > SPEED_STATIC)
    return float((flowing * columns.valid).sum() / max(flowing.sum(), 1e-30))
