"""Uniform flow in time: starting, stopping from the bed upwards, sliding as a block."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import solve_banded

from fvcollapse.verification.exact.layer import (
    gravity_normal,
    parabola,
    slope_ratio,
    wall_ratio,
)

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def incline_start_up(case: "Case", z: Any, time: float, terms: int = 200) -> Any:
    """Drucker-Prager layer (T > mu_1) from rest: the steady parabola less decaying modes.

    u_t = A + nu u_zz with A = g cos a (T - mu_1), nu = eta/rho, u(0) = 0, u_z(H) = 0, since du/dz >
    0 throughout: u = A/nu (H z - z^2/2) - sum_n 2A/(nu H k_n^3) sin(k_n z) exp(-nu k_n^2 t), k_n =
    (2n + 1) pi/(2H).
    """
    law, depth = case.rheology, case.geometry.height_0
    drive = gravity_normal(case) * (slope_ratio(case) - law.mu_1)
    nu = law.viscosity / law.density_bulk
    k = (2 * np.arange(terms) + 1) * math.pi / (2 * depth)
    modes = 2 * drive / (nu * depth * k**3) * np.exp(-nu * k**2 * time)
    return parabola(case, z, drive / nu) - np.sin(np.outer(z, k)) @ modes


def stopping_inviscid(case: "Case", u_0: Callable, z: Any, time: Any) -> Any:
    """Layer below yield (T < mu_1) without viscosity: u = max(0, u_0(z) - S t), u_0 rising with z.

    Where the layer moves tau = mu_1 p, so every depth loses S = g cos a (mu_1 - T + 2 (mu_w/w) y)
    per unit time; the static-flowing interface rises as S t = u_0. Bouchut, Ionescu & Mangeney
    (2016), Commun. Math. Sci. 14, 2101.
    """
    y = case.geometry.height_0 - np.asarray(z)
    loss = case.rheology.mu_1 - slope_ratio(case) + 2 * wall_ratio(case) * y
    return np.maximum(0.0, u_0 - gravity_normal(case) * loss * time)


def stopping_viscous(
    case: "Case", u_0: Callable, z: Any, time: Any, cells: int = 400, steps: int = 800
) -> Any:
    """Drucker-Prager layer below yield that stops from the bed upwards; u_0(z) rising, flat at H.

    Where the layer moves tau = mu_1 p + eta u_z, so u_t = -S + nu u_zz with S = g cos a (mu_1 - T + 2
    (mu_w/w) y), u_z(H) = 0; it ends at a height b(t) where u = u_z = 0, and below it rests: the
    obstacle problem min(u_t + S - nu u_zz, u) = 0. Lusso, Bouchut, Ern & Mangeney (2017), Appl. Sci.
    7, 386, without lateral walls, whose friction is one more force that opposes u. There is
    no closed form: finite differences on `cells` cells, in `steps` implicit steps (extrapolated from
    first order in time), the resting cells being found anew in every step; converged to 2e-6 u_0.
    """
    coarse = _obstacle(case, u_0, time, cells, steps)
    fine = _obstacle(case, u_0, time, cells, 2 * steps)
    centres = (np.arange(cells) + 0.5) * case.geometry.height_0 / cells
    return np.interp(z, centres, np.maximum(2 * fine - coarse, 0.0))


def _obstacle(case, u_0, time, cells, steps):
    law, h, dt = case.rheology, case.geometry.height_0 / cells, time / steps
    centres = (np.arange(cells) + 0.5) * h
    y = case.geometry.height_0 - centres
    rate = law.mu_1 - slope_ratio(case) + 2 * wall_ratio(case) * y
    loss = gravity_normal(case) * rate * dt
    diffusion = law.viscosity / law.density_bulk * dt / h**2
    band = np.zeros((3, cells))
    band[0, 1:] = band[2, :-1] = -diffusion
    band[1] = 1.0 + 2.0 * diffusion
    band[1, 0] += diffusion  # the bed is half a cell below the first centre
    band[1, -1] -= diffusion
    u = u_0(centres)
    resting = 0
    for _ in range(steps):
        while resting < cells:
            right = (u - loss)[resting:]
            solution = solve_banded((1, 1), _above(band, resting, diffusion), right)
            if solution[0] >= 0.0:
                break
            resting += 1
        u = np.zeros(cells)
        u[resting:] = solution if resting < cells else 0.0
    return u


def _above(band, resting, diffusion):
    """The equations of the cells from `resting` on, with u = 0 in the cell below."""
    part = band[:, resting:].copy()
    if resting:
        part[1, 0] = 1.0 + 2.0 * diffusion - (diffusion if part.shape[1] == 1 else 0.0)
    return part


def block_acceleration(case: "Case", depth: float | None = None) -> float:
    """A rigid block that slides down: g cos a (T - mu_b - (mu_w/w) H), m/s2."""
    depth = case.geometry.height_0 if depth is None else depth
    loss = case.boundary.mu_bed + wall_ratio(case) * depth
    return gravity_normal(case) * (slope_ratio(case) - loss)


def block_speed(case: "Case", u_0: float, time: Any) -> Any:
    """A rigid block, braked (acceleration < 0): stops at u_0/|a| and stays, max(0, u_0 + a t)."""
    return max(0.0, u_0 + block_acceleration(case) * time)
