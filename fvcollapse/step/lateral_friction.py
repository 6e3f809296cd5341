"""Friction of the channel's two lateral walls: -(2/w) mu_w [p]+ u/|u| in the momentum balance (equation 19).

Width-averaged Coulomb friction, both velocity components together. By default it enters the
implicit solve as a diagonal coefficient (2 mu_w / w) [p]+ / sqrt(|u|^2 + slip_min^2), refreshed in
every nonlinear sweep; the pressure is the exact volume integral of the cells, handed to the faces
by the lever rule.

The walls may bear K_w p instead of p (sigma_yy = K_w p), and their friction may weaken with the
depth y below the surface, mu_w (r + (1 - r) exp(-y/l)): grains that creep far below the surface
rotate and fluctuate, and rub less than sliding ones (Richard et al. 2008, Phys. Rev. Lett. 101,
248002; Artoni & Richard 2015, Phys. Rev. Lett. 115, 158001).

The split form |u| <- max(0, |u| - dt 2 mu_w [p]+ / (rho w)) is exact for a frozen pressure and is
the reference. It comes before the implicit solve, since after it div u would not vanish, and acts
on the velocity that gravity and the last pressure alone would give: on u* itself it would find
nothing to brake in a mass at rest, which would then slide. Only the friction impulse is handed on,
so that the solve adds gravity and pressure itself. At rest: where gravity less the pressure
gradient is below the capacity, the walls take all of it and u = 0, p unchanged is the exact
solution for any time step (but any such p stays: the split form does not choose among the static
states); above the capacity the grains carry the rest. Stress from sheared neighbours is not seen
until the next step: a mass stuck between the walls beside a flow creeps at no more than dt 2 mu_w p
/ (rho w). First order in dt.
"""

import math

import numpy as np

from .arrays import copy, subtract, total
from .compiled import inner_jit, kernel_jit
from .geometry import MASS_FLOOR, WET


def sink_constants(walls, channel_width):
    """(2 mu_w K_w / w in 1/m, 0 without a sink; ratio of the deep friction; depth of weakening in m)."""
    if walls is None or walls.closure == "friction_increase":
        return 0.0, 1.0, 1.0
    strength = 2.0 * (walls.mu_wall * walls.pressure_ratio) / channel_width
    if walls.closure == "sink":
        return strength, 1.0, 1.0
    return strength, walls.deep_ratio, walls.weakening_depth


@inner_jit()
def weakened(depth, deep_ratio, weakening_depth):
    """Friction at a depth (m) below the surface over that at the surface; exactly 1 with deep_ratio = 1."""
    return deep_ratio + (1.0 - deep_ratio) * math.exp(-depth / weakening_depth)


@kernel_jit()
def face_pressures(
    pressure_x, pressure_z, pressure_filled, geometry, deep_ratio, weakening_depth, dz
):
    """[p]+ times filled fraction, weakened with depth, handed to the faces by the lever rule; Pa."""
    nx = pressure_filled.shape[0]
    pressure_x[:] = 0.0
    pressure_z[:] = 0.0
    for i in range(nx):
        top = dz * total(geometry.filled[i]) if deep_ratio < 1.0 else 0.0
        for k in range(geometry.reach[i]):
            v = geometry.filled[i, k]
            p = pressure_filled[i, k]
            if v > WET and p > 0.0:
                if deep_ratio < 1.0:
                    depth = max(top - (k + 0.5 * v) * dz, 0.0)
                    p *= weakened(depth, deep_ratio, weakening_depth)
                share = geometry.lever_x[i, k] / v
                pressure_x[i, k] += (1.0 - share) * p * geometry.aperture[i, k]
                pressure_x[i + 1, k] += share * p * geometry.aperture[i + 1, k]
                share = geometry.lever_z[i, k] / v
                pressure_z[i, k] += (1.0 - share) * p
                pressure_z[i, k + 1] += share * p


@inner_jit()
def speed_at_xface(u, w, i, k):
    """|u| at x-face (i, k), with w averaged from the four neighbours; m/s."""
    nx = w.shape[0]
    left, right = max(i - 1, 0), min(i, nx - 1)
    w_mean = 0.25 * (w[left, k] + w[left, k + 1] + w[right, k] + w[right, k + 1])
    return math.sqrt(u[i, k] ** 2 + w_mean**2)


@inner_jit()
def speed_at_zface(u, w, i, k):
    """|u| at z-face (i, k), with u averaged from the four neighbours; m/s."""
    nz = u.shape[1]
    low, high = max(k - 1, 0), min(k, nz - 1)
    u_mean = 0.25 * (u[i, low] + u[i + 1, low] + u[i, high] + u[i + 1, high])
    return math.sqrt(u_mean**2 + w[i, k] ** 2)


@kernel_jit()
def sink_coefficients(sink_x, sink_z, u, w, pressure_x, pressure_z, geometry, strength, slip_min):
    """Diagonal coefficients of the implicit sink on x- and z-faces, Pa s/m2; `strength` = 2 mu_w / w (1/m)."""
    nx = w.shape[0]
    for i in range(nx + 1):
        for k in range(geometry.reach[i]):
            if geometry.index_u[i, k] >= 0:
                speed = speed_at_xface(u, w, i, k)
                sink_x[i, k] = strength * pressure_x[i, k] / math.sqrt(speed**2 + slip_min**2)
    for i in range(nx):
        for k in range(1, geometry.reach[i]):
            if geometry.index_w[i, k] >= 0:
                speed = speed_at_zface(u, w, i, k)
                sink_z[i, k] = strength * pressure_z[i, k] / math.sqrt(speed**2 + slip_min**2)


@inner_jit()
def _wet_pressure(pressure_filled, geometry, i, k):
    """Filled fraction times pressure of a cell, 0 in an empty one; Pa."""
    return pressure_filled[i, k] if geometry.filled[i, k] > WET else 0.0


@kernel_jit()
def predict_velocity(u_new, w_new, u, w, pressure_filled, geometry, balance, least_mass, dx, dz):
    """u_new = u + dt (g - grad p / rho) at the unknown faces, unchanged elsewhere; p of the last step."""
    nx, nz = pressure_filled.shape
    scale_x, scale_z = 1.0 / (balance.density * dx), 1.0 / (balance.density * dz)
    copy(u_new, u)
    copy(w_new, w)
    for i in range(1, nx + 1):
        for k in range(nz):
            if geometry.index_u[i, k] >= 0:
                ahead = _wet_pressure(pressure_filled, geometry, i, k) if i < nx else 0.0
                jump = _wet_pressure(pressure_filled, geometry, i - 1, k) - ahead
                jump *= geometry.aperture[i, k]
                mass = geometry.mass_x[i, k]
                u_new[i, k] += (
                    balance.dt * (balance.gx * mass + jump * scale_x) / max(mass, least_mass)
                )
    for i in range(nx):
        for k in range(1, nz):
            if geometry.index_w[i, k] >= 0:
                mass = geometry.mass_z[i, k]
                jump = _wet_pressure(pressure_filled, geometry, i, k - 1)
                jump -= _wet_pressure(pressure_filled, geometry, i, k)
                w_new[i, k] += (
                    balance.dt * (balance.gz * mass + jump * scale_z) / max(mass, least_mass)
                )


@kernel_jit()
def apply_split(u_new, w_new, u, w, pressure_x, pressure_z, geometry, impulse, least_mass):
    """|u| <- max(0, |u| - impulse p) in the direction of u; exact for a frozen pressure, never reverses.

    Parameters
    ----------
    u_new, w_new : arrays like u, w
        Result, m/s.
    u, w : arrays
        Velocity before the friction.
    pressure_x, pressure_z : arrays
        From `face_pressures`, Pa.
    impulse : float
        dt 2 mu_w / (rho w), m/s per Pa.
    least_mass : float
        Floor of the face masses, as in the inertia of the solve.
    """
    nx, nz = w.shape[0], u.shape[1]
    copy(u_new, u)
    copy(w_new, w)
    for i in range(nx + 1):
        for k in range(nz):
            if geometry.index_u[i, k] >= 0:
                loss = impulse * pressure_x[i, k] / max(geometry.mass_x[i, k], least_mass)
                speed = speed_at_xface(u, w, i, k)
                u_new[i, k] *= 1.0 - loss / speed if loss < speed else 0.0
    for i in range(nx):
        for k in range(nz + 1):
            if geometry.index_w[i, k] >= 0:
                loss = impulse * pressure_z[i, k] / max(geometry.mass_z[i, k], least_mass)
                speed = speed_at_zface(u, w, i, k)
                w_new[i, k] *= 1.0 - loss / speed if loss < speed else 0.0


@inner_jit()
def before_solve(flow, impulse, u_star, w_star, balance):
    """Put the friction of the split form into the lateral part of `impulse`; the solve then has no sink of its own.

    Parameters
    ----------
    flow : Flow
    impulse : Impulse
        Changed in place.
    u_star, w_star : arrays
        Velocity after advection, m/s.
    balance : Balance
    """
    work, geometry, fields = flow.work, flow.geometry, flow.fields
    dx, dz = flow.constants.dx, flow.constants.dz
    free_u, free_w = np.empty_like(u_star), np.empty_like(w_star)
    predict_velocity(
        free_u,
        free_w,
        u_star,
        w_star,
        fields.pressure_filled,
        geometry,
        balance,
        MASS_FLOOR,
        dx,
        dz,
    )
    face_pressures(
        work.pressure_x,
        work.pressure_z,
        fields.pressure_filled,
        geometry,
        balance.wall_deep_ratio,
        balance.wall_weakening_depth,
        dz,
    )
    apply_split(
        impulse.lateral_u,
        impulse.lateral_w,
        free_u,
        free_w,
        work.pressure_x,
        work.pressure_z,
        geometry,
        balance.dt * balance.wall_strength / balance.density,
        MASS_FLOOR,
    )
    subtract(impulse.lateral_u, free_u)
    subtract(impulse.lateral_w, free_w)
    work.sink_x[:] = 0.0
    work.sink_z[:] = 0.0
