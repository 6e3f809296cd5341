"""Momentum advection: u_t + u . grad u = 0 over one step, the predictor of the implicit solve.

Upwind WENO3 in space, two-stage TVD Runge-Kutta in time, with the advecting velocity frozen at the
start of the step. Beyond the surface the extrapolated velocity is used. At the bed the ghost value
mirrors u about the slip velocity.
"""

import numpy as np
from numba import njit

from .stencils import derivative_weno3


@njit(cache=True)
def _take(field, i, k, nx, nz):
    return field[min(max(i, 0), nx - 1), min(max(k, 0), nz - 1)]


@njit(cache=True)
def _rate_u(rate, field, u, w, bed_slip, phi, reach, dx, dz):
    nx, nz = field.shape
    for i in range(1, nx):
        for k in range(nz):
            rate[i, k] = 0.0
            if phi[i, k] > reach:
                continue
            right = min(i, nx - 2)
            across = 0.25 * (w[i - 1, k] + w[i - 1, k + 1] + w[right, k] + w[right, k + 1])
            m2 = field[i - 2, k] if i >= 2 else -field[1, k]
            along = derivative_weno3(
                m2,
                field[i - 1, k],
                field[i, k],
                _take(field, i + 1, k, nx, nz),
                _take(field, i + 2, k, nx, nz),
                u[i, k],
                dx,
            )
            below = field[i, k - 1] if k >= 1 else 2.0 * bed_slip[i] - field[i, 0]
            below_2 = field[i, k - 2] if k >= 2 else (2.0 * bed_slip[i] - field[i, 1 - k])
            normal = derivative_weno3(
                below_2,
                below,
                field[i, k],
                _take(field, i, k + 1, nx, nz),
                _take(field, i, k + 2, nx, nz),
                across,
                dz,
            )
            rate[i, k] = -u[i, k] * along - across * normal


@njit(cache=True)
def _rate_w(rate, field, u, w, phi, reach, dx, dz):
    nx, nz = field.shape
    for i in range(nx):
        for k in range(1, nz):
            rate[i, k] = 0.0
            if phi[i, k] > reach:
                continue
            high = min(k, nz - 2)
            across = 0.25 * (u[i, k - 1] + u[i + 1, k - 1] + u[i, high] + u[i + 1, high])
            along = derivative_weno3(
                _take(field, i - 2, k, nx, nz),
                _take(field, i - 1, k, nx, nz),
                field[i, k],
                _take(field, i + 1, k, nx, nz),
                _take(field, i + 2, k, nx, nz),
                across,
                dx,
            )
            below_2 = field[i, k - 2] if k >= 2 else -field[i, 1]
            normal = derivative_weno3(
                below_2,
                field[i, k - 1],
                field[i, k],
                _take(field, i, k + 1, nx, nz),
                _take(field, i, k + 2, nx, nz),
                w[i, k],
                dz,
            )
            rate[i, k] = -across * along - w[i, k] * normal


@njit(cache=True)
def advect_momentum(u_star, w_star, u, w, bed_slip, phi, reach, dt, dx, dz):
    """(u*, w*) = velocity after pure advection over dt, at faces with level set below `reach`; unchanged elsewhere.

    Parameters
    ----------
    u_star, w_star : arrays like u, w
        Result, m/s.
    u, w : (nx+1, nz), (nx, nz+1) arrays
        Velocity, continued beyond the surface.
    bed_slip : (nx+1,) array
        Slip velocity of the bed, m/s.
    phi : (nx+1, nz+1) array
        Level set at the nodes, m (its lower left node decides for a face).
    """
    rate_u, rate_w = np.zeros_like(u), np.zeros_like(w)
    _rate_u(rate_u, u, u, w, bed_slip, phi, reach, dx, dz)
    _rate_w(rate_w, w, u, w, phi, reach, dx, dz)
    u_star[:] = u + dt * rate_u
    w_star[:] = w + dt * rate_w
    _rate_u(rate_u, u_star, u, w, bed_slip, phi, reach, dx, dz)
    _rate_w(rate_w, w_star, u, w, phi, reach, dx, dz)
    u_star[:] = 0.5 * (u + u_star + dt * rate_u)
    w_star[:] = 0.5 * (w + w_star + dt * rate_w)
