"""Friction of the channel's two lateral walls: -(2/w) mu_w [p]+ u/|u| in the momentum balance (equation 19).

Width-averaged Coulomb friction, both velocity components together. By default it enters the implicit solve as a
diagonal coefficient (2 mu_w / w) [p]+ / sqrt(|u|^2 + slip_min^2), refreshed in every nonlinear sweep; the pressure is
the exact volume integral of the cells, handed to the faces by the lever rule. The split form
|u| <- max(0, |u| - dt 2 mu_w [p]+ / (rho w)) is exact for a frozen pressure and is the reference; it is applied before
the projection, since after it div u would not vanish.
"""
import math

from numba import njit


@njit(cache=True)
def face_pressures(pressure_x, pressure_z, pressure_filled, geometry):
    """[p]+ times filled fraction, handed from the cells to their faces by the lever rule; Pa."""
    nx, nz = pressure_filled.shape
    pressure_x[:] = 0.0
    pressure_z[:] = 0.0
    for i in range(nx):
        for k in range(nz):
            v = geometry.filled[i, k]
            p = pressure_filled[i, k]
            if v > 1.0e-8 and p > 0.0:
                share = geometry.lever_x[i, k] / v
                pressure_x[i, k] += (1.0 - share) * p
                pressure_x[i + 1, k] += share * p
                share = geometry.lever_z[i, k] / v
                pressure_z[i, k] += (1.0 - share) * p
                pressure_z[i, k + 1] += share * p


@njit(cache=True)
def speed_at_xface(u, w, i, k):
    """|u| at x-face (i, k), with w averaged from the four neighbours; m/s."""
    nx = w.shape[0]
    left, right = max(i - 1, 0), min(i, nx - 1)
    w_mean = 0.25 * (w[left, k] + w[left, k + 1] + w[right, k] + w[right, k + 1])
    return math.sqrt(u[i, k] ** 2 + w_mean**2)


@njit(cache=True)
def speed_at_zface(u, w, i, k):
    """|u| at z-face (i, k), with u averaged from the four neighbours; m/s."""
    nz = u.shape[1]
    low, high = max(k - 1, 0), min(k, nz - 1)
    u_mean = 0.25 * (u[i, low] + u[i + 1, low] + u[i, high] + u[i + 1, high])
    return math.sqrt(u_mean**2 + w[i, k] ** 2)


@njit(cache=True)
def sink_coefficients(sink_x, sink_z, u, w, pressure_x, pressure_z, geometry, strength, slip_min):
    """Diagonal coefficients of the implicit sink on x- and z-faces, Pa s/m2; `strength` = 2 mu_w / w (1/m)."""
    nx, nz = w.shape[0], u.shape[1]
    for i in range(nx + 1):
        for k in range(nz):
            if geometry.index_u[i, k] >= 0:
                speed = speed_at_xface(u, w, i, k)
                sink_x[i, k] = strength * pressure_x[i, k] / math.sqrt(speed**2 + slip_min**2)
    for i in range(nx):
        for k in range(1, nz):
            if geometry.index_w[i, k] >= 0:
                speed = speed_at_zface(u, w, i, k)
                sink_z[i, k] = strength * pressure_z[i, k] / math.sqrt(speed**2 + slip_min**2)


@njit(cache=True)
def apply_split(u_new, w_new, u, w, pressure_x, pressure_z, geometry, impulse):
    """|u| <- max(0, |u| - impulse p / mass) in the direction of u, exact for frozen pressure.

    `impulse` = dt 2 mu_w / (rho w), m2 s/kg ... so that impulse * pressure / filled mass is a speed.
    """
    nx, nz = w.shape[0], u.shape[1]
    for i in range(nx + 1):
        for k in range(nz):
            u_new[i, k] = u[i, k]
            if geometry.index_u[i, k] >= 0 and geometry.mass_x[i, k] > 0.0:
                speed = speed_at_xface(u, w, i, k)
                if speed > 0.0:
                    u_new[i, k] *= max(0.0, 1.0 - impulse * pressure_x[i, k] / (geometry.mass_x[i, k] * speed))
    for i in range(nx):
        for k in range(nz + 1):
            w_new[i, k] = w[i, k]
            if geometry.index_w[i, k] >= 0 and geometry.mass_z[i, k] > 0.0:
                speed = speed_at_zface(u, w, i, k)
                if speed > 0.0:
                    w_new[i, k] *= max(0.0, 1.0 - impulse * pressure_z[i, k] / (geometry.mass_z[i, k] * speed))
