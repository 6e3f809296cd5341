"""Strain rates on the staggered grid, and where they exist.

At cell centres e = (du/dx - dw/dz)/2 (the deviatoric half difference); at nodes g = du/dz + dw/dx.
The shear rate is sqrt(2 D:D) = sqrt(4 e^2 + g^2); at the centre the mean of the four *squares* g^2
is taken, since the mean of g itself cannot see a checkerboard of shear.
"""

import math

from numba import njit

from .geometry import WET


@njit(cache=True)
def node_is_interior(index_u, index_w, i, k):
    """Whether all four faces around node (i, k) are unknowns: else it lies on a wall, the gate or the surface."""
    nx, nz = index_w.shape[0], index_u.shape[1]
    if i < 1 or i > nx - 1 or k < 1 or k > nz - 1:
        return False
    return (
        index_u[i, k - 1] >= 0
        and index_u[i, k] >= 0
        and index_w[i - 1, k] >= 0
        and index_w[i, k] >= 0
    )


@njit(cache=True)
def strain_rates(e_centre, g_node, u, w, bed_slip, geometry, dx, dz):
    """Fill e at wet cells and g at interior and bed nodes; zero elsewhere. 1/s.

    At bed nodes g = 2 (u_0 - bed_slip)/dz: only what the grains themselves shear, not the slip.
    """
    nx, nz = e_centre.shape
    e_centre[:] = 0.0
    g_node[:] = 0.0
    for i in range(nx):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] > WET:
                e_centre[i, k] = 0.5 * (
                    (geometry.aperture[i + 1, k] * u[i + 1, k] - geometry.aperture[i, k] * u[i, k])
                    / dx
                    - (w[i, k + 1] - w[i, k]) / dz
                )
    for i in range(1, nx):
        if geometry.index_u[i, 0] >= 0:
            g_node[i, 0] = 2.0 * (u[i, 0] - bed_slip[i]) / dz
        for k in range(1, geometry.reach[i]):
            if node_is_interior(geometry.index_u, geometry.index_w, i, k):
                g_node[i, k] = (u[i, k] - u[i, k - 1]) / dz + (w[i, k] - w[i - 1, k]) / dx


@njit(cache=True)
def mean_square(a, b, c, d):
    """Mean of the squares of those of the four values that exist; an exact zero stands for none."""
    count = (a != 0.0) + (b != 0.0) + (c != 0.0) + (d != 0.0)
    return (a * a + b * b + c * c + d * d) / max(count, 1)


@njit(cache=True)
def shear_rate_centre(e_centre, g_node, i, k):
    """sqrt(4 e^2 + mean of g^2) at cell (i, k), 1/s."""
    g2 = mean_square(g_node[i, k], g_node[i + 1, k], g_node[i, k + 1], g_node[i + 1, k + 1])
    return math.sqrt(4.0 * e_centre[i, k] ** 2 + g2)


@njit(cache=True)
def shear_rate_node(e_centre, g_node, i, k):
    """sqrt(mean of 4 e^2 + g^2) at interior node (i, k), 1/s."""
    e2 = mean_square(e_centre[i - 1, k - 1], e_centre[i, k - 1], e_centre[i - 1, k], e_centre[i, k])
    return math.sqrt(4.0 * e2 + g_node[i, k] ** 2)
