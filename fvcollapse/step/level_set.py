"""The free surface: phi_t + u . grad phi = 0 at the nodes, and phi kept a signed distance.

Advection: WENO5 in space, TVD-RK3 in time, in a band around the surface. `redistancing` restores the distance; the
velocity of the surface is first-order accurate, so the volume drifts, and `grain_volume` removes the drift where the
surface moves. The walls and the bed are no surface: phi continues straight through them.
"""

import math

import numpy as np

from .arrays import larger
from .compiled import inner_jit, kernel_jit
from .stencils import cubic, derivative_weno5

GAP, FACING = (
    0.1,
    0.8,
)  # cells between grains and a wall that are none; fall of phi per cell of a face towards it
BAND = 5.0  # half width of the computed band in cells: WENO5 needs three, the restoration one more


@inner_jit()
def _mean_of_four(a, b, c, d):
    """Fourth-order value half way between b and c."""
    return (9.0 * (b + c) - a - d) / 16.0


@kernel_jit()
def node_velocity(u_node, w_node, u, w):
    """Velocity at the nodes, m/s, from the faces: fourth order, second beside the edges of the grid.

    Bed nodes are extrapolated, so that the mean of the two nodes of the first cell is that cell's
    own velocity: otherwise a film thinner than a cell would gain or lose volume.
    """
    nx, nz = w.shape[0], u.shape[1]
    for i in range(nx + 1):
        for k in range(nz + 1):
            if k == 0:
                u_node[i, k] = 1.5 * u[i, 0] - 0.5 * u[i, 1]
            elif 2 <= k <= nz - 2:
                u_node[i, k] = _mean_of_four(u[i, k - 2], u[i, k - 1], u[i, k], u[i, k + 1])
            else:
                u_node[i, k] = 0.5 * (u[i, k - 1] + u[i, min(k, nz - 1)])
            if 2 <= i <= nx - 2:
                w_node[i, k] = _mean_of_four(w[i - 2, k], w[i - 1, k], w[i, k], w[i + 1, k])
            else:
                w_node[i, k] = 0.5 * (w[max(i - 1, 0), k] + w[min(i, nx - 1), k])


@kernel_jit()
def node_speed(speed, u_node, w_node):
    """Speed at the nodes, m/s; return the largest."""
    fastest = 0.0
    for i in range(speed.shape[0]):
        for k in range(speed.shape[1]):
            u, w = u_node[i, k], w_node[i, k]
            speed[i, k] = math.hypot(u, w) if u != 0.0 or w != 0.0 else 0.0  # far off all is zero
            fastest = larger(fastest, speed[i, k])
    return fastest


@inner_jit()
def _between(field, x, z):
    """Value at (x, z), in node spacings: bicubic (Catmull-Rom), bilinear beside the edges of the grid."""
    i, k = int(x), int(z)
    p, q = x - i, z - k
    nx, nz = field.shape
    if 1 <= i <= nx - 3 and 1 <= k <= nz - 3:
        return cubic(
            cubic(
                field[i - 1, k - 1], field[i - 1, k], field[i - 1, k + 1], field[i - 1, k + 2], q
            ),
            cubic(field[i, k - 1], field[i, k], field[i, k + 1], field[i, k + 2], q),
            cubic(
                field[i + 1, k - 1], field[i + 1, k], field[i + 1, k + 1], field[i + 1, k + 2], q
            ),
            cubic(
                field[i + 2, k - 1], field[i + 2, k], field[i + 2, k + 1], field[i + 2, k + 2], q
            ),
            p,
        )
    low = (1.0 - q) * field[i, k] + q * field[i, k + 1]
    return (1.0 - p) * low + p * ((1.0 - q) * field[i + 1, k] + q * field[i + 1, k + 1])


@kernel_jit(error_model="numpy")
def carry_from_surface(u_out, w_out, u_node, w_node, phi, band, dx, dz):
    """Give every node of the band the velocity of its nearest surface point x - phi n.

    The surface moves as before to first order, but phi stays a distance much longer, since its contours no longer
    shear against each other.
    """
    nx, nz = phi.shape
    for i in range(nx):
        for k in range(nz):
            u_out[i, k], w_out[i, k] = u_node[i, k], w_node[i, k]
            if abs(phi[i, k]) > band:
                continue
            left, right = max(i - 1, 0), min(i + 1, nx - 1)
            low, high = max(k - 1, 0), min(k + 1, nz - 1)
            gx = (phi[right, k] - phi[left, k]) / ((right - left) * dx)
            gz = (phi[i, high] - phi[i, low]) / ((high - low) * dz)
            size = math.sqrt(gx * gx + gz * gz)
            if abs(size - 1.0) > 0.05:  # at a kink the nearest point is not where phi n leads
                continue
            x = min(max(i - phi[i, k] * gx / size / dx, 0.0), nx - 1.000001)
            z = min(max(k - phi[i, k] * gz / size / dz, 0.0), nz - 1.000001)
            u_out[i, k], w_out[i, k] = _between(u_node, x, z), _between(w_node, x, z)


@inner_jit()
def close_bed(phi):
    """Wet the bed under every wet node of the first row.

    A front whose foot is held back by the bed rolls over; left to itself the level set would
    enclose a film of air there, thinner than a cell, because no velocity normal to the bed can ever
    close it.
    """
    for i in range(phi.shape[0]):
        phi[i, 0] = min(phi[i, 0], phi[i, 1])


@inner_jit()
def close_end(phi, h):
    """Wet the nodes of a wall at the far end that a face of the grains has reached.

    The velocity normal to the wall vanishes there and never closes the gap before it: left to itself the level set
    would keep a free face along the wall, below the surface too. `h` is the cell size, m.
    """
    last = phi.shape[0] - 1
    for k in range(phi.shape[1]):
        here, beside = phi[last, k], phi[last - 1, k]
        if beside < 0.0 and here < GAP * h and here - beside > FACING * h:
            phi[last, k] = beside


@inner_jit()
def padded(extended, phi):
    """Copy phi with three ghost layers, continued linearly."""
    nx, nz = phi.shape
    for i in range(nx):
        for k in range(nz):
            extended[i + 3, k + 3] = phi[i, k]
    continue_beyond(extended)


@inner_jit()
def continue_beyond(extended):
    """Fill the three ghost layers around a field linearly."""
    nx, nz = extended.shape[0] - 6, extended.shape[1] - 6
    for m in range(1, 4):
        for k in range(3, nz + 3):
            extended[3 - m, k] = (m + 1) * extended[3, k] - m * extended[4, k]
            extended[nx + 2 + m, k] = (m + 1) * extended[nx + 2, k] - m * extended[nx + 1, k]
    for m in range(1, 4):
        for i in range(nx + 6):
            extended[i, 3 - m] = (m + 1) * extended[i, 3] - m * extended[i, 4]
            extended[i, nz + 2 + m] = (m + 1) * extended[i, nz + 2] - m * extended[i, nz + 1]


@inner_jit(error_model="numpy")
def advection_rate(rate, extended, u_node, w_node, band, dx, dz):
    """Rate = -u . grad phi by WENO5 at the nodes with |phi| < band; zero elsewhere."""
    nx, nz = rate.shape
    for i in range(nx):
        for k in range(nz):
            rate[i, k] = 0.0
            a, b = i + 3, k + 3
            if abs(extended[a, b]) > band:
                continue
            u, w = u_node[i, k], w_node[i, k]
            if u > 0.0:
                rate[i, k] -= (
                    u
                    / dx
                    * derivative_weno5(
                        extended[a - 2, b] - extended[a - 3, b],
                        extended[a - 1, b] - extended[a - 2, b],
                        extended[a, b] - extended[a - 1, b],
                        extended[a + 1, b] - extended[a, b],
                        extended[a + 2, b] - extended[a + 1, b],
                    )
                )
            elif u < 0.0:
                rate[i, k] -= (
                    u
                    / dx
                    * derivative_weno5(
                        extended[a + 3, b] - extended[a + 2, b],
                        extended[a + 2, b] - extended[a + 1, b],
                        extended[a + 1, b] - extended[a, b],
                        extended[a, b] - extended[a - 1, b],
                        extended[a - 1, b] - extended[a - 2, b],
                    )
                )
            if w > 0.0:
                rate[i, k] -= (
                    w
                    / dz
                    * derivative_weno5(
                        extended[a, b - 2] - extended[a, b - 3],
                        extended[a, b - 1] - extended[a, b - 2],
                        extended[a, b] - extended[a, b - 1],
                        extended[a, b + 1] - extended[a, b],
                        extended[a, b + 2] - extended[a, b + 1],
                    )
                )
            elif w < 0.0:
                rate[i, k] -= (
                    w
                    / dz
                    * derivative_weno5(
                        extended[a, b + 3] - extended[a, b + 2],
                        extended[a, b + 2] - extended[a, b + 1],
                        extended[a, b + 1] - extended[a, b],
                        extended[a, b] - extended[a, b - 1],
                        extended[a, b - 1] - extended[a, b - 2],
                    )
                )


@kernel_jit()
def advect(phi, u_node, w_node, dt, dx, dz):
    """Advance phi (in place) by dt with the frozen node velocity, TVD-RK3."""
    nx, nz = phi.shape
    extended = np.empty((nx + 6, nz + 6))
    rate = np.empty((nx, nz))
    old = phi.copy()
    band = BAND * max(dx, dz)
    for stage in range(3):
        padded(extended, phi)
        advection_rate(rate, extended, u_node, w_node, band, dx, dz)
        keep = (0.0, 0.75, 1.0 / 3.0)[stage]
        for i in range(nx):
            for k in range(nz):
                phi[i, k] = keep * old[i, k] + (1.0 - keep) * (phi[i, k] + dt * rate[i, k])
    close_bed(phi)
