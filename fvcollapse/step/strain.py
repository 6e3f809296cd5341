"""Strain rates on the staggered grid, and where they exist.

At cell centres e = (du/dx - dw/dz)/2 (the deviatoric half difference); at nodes g = du/dz + dw/dx.
The shear rate is sqrt(2 D:D) = sqrt(4 e^2 + g^2); at the centre the mean of the four *squares* g^2
is taken, since the mean of g itself cannot see a checkerboard of shear.
"""

import math

from .compiled import inner_jit, kernel_jit
from .geometry import WET


@kernel_jit()
def strain_rates(e_centre, g_node, u, w, bed_slip, geometry, dx, dz):
    """Fill e at wet cells and g at interior and bed nodes; zero elsewhere. 1/s.

    At bed nodes g = 2 (u_0 - bed_slip)/dz: only what the grains themselves shear, not the slip.
    """
    nx = e_centre.shape[0]
    per_x, per_z = 1.0 / dx, 1.0 / dz
    e_centre[:] = 0.0
    g_node[:] = 0.0
    filled, aperture, interior = geometry.filled, geometry.aperture, geometry.interior
    # no views of columns: counting their references costs more than a short column
    for i in range(nx):
        for k in range(geometry.reach[i]):
            if filled[i, k] > WET:
                e_centre[i, k] = 0.5 * (
                    (aperture[i + 1, k] * u[i + 1, k] - aperture[i, k] * u[i, k]) * per_x
                    - (w[i, k + 1] - w[i, k]) * per_z
                )
    for i in range(1, nx):
        if geometry.index_u[i, 0] >= 0:
            g_node[i, 0] = 2.0 * (u[i, 0] - bed_slip[i]) * per_z
        for k in range(1, geometry.reach[i]):
            if interior[i, k]:
                g_node[i, k] = (u[i, k] - u[i, k - 1]) * per_z + (w[i, k] - w[i - 1, k]) * per_x


@inner_jit()
def mean_square(a, b, c, d):
    """Mean of the squares of those of the four values that exist; an exact zero stands for none."""
    count = (a != 0.0) + (b != 0.0) + (c != 0.0) + (d != 0.0)
    return (a * a + b * b + c * c + d * d) / max(count, 1)


@inner_jit()
def shear_rate_from(stretch, shear):
    """sqrt(4 e^2 + g^2) from the two squares (1/s2), 1/s."""
    return math.sqrt(stretch + shear)


@inner_jit()
def shear_rate_centre(e_centre, g_node, i, k):
    """sqrt(4 e^2 + mean of g^2) at cell (i, k), 1/s."""
    g2 = mean_square(g_node[i, k], g_node[i + 1, k], g_node[i, k + 1], g_node[i + 1, k + 1])
    return shear_rate_from(4.0 * e_centre[i, k] ** 2, g2)
