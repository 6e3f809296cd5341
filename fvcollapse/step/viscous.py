"""div(2 eta D) as a symmetric form, and the penalty of div u, assembled into the band.

The dissipation sum(4 V eta e^2) over cells + sum(V eta g^2) over nodes is differentiated with
respect to the face velocities: each cell and each node adds a rank-one 4 x 4 block, so the matrix
is symmetric positive by construction and the stress-free surface is its natural boundary condition.
Everything is per unit volume: Pa/m per m/s.
"""

import numpy as np

from .compiled import inner_jit, kernel_jit
from .geometry import WET
from .rheology import effective_viscosities
from .strain import mean_square, shear_rate_from


@inner_jit()
def viscosity_weights(
    weight_centre, weight_node, e_centre, g_node, pressure_filled, geometry, material
):
    """Filled fraction times effective viscosity at wet cells and interior nodes, zero elsewhere. Pa s.

    The points are packed first, so that the viscosity is one long loop without branches.
    """
    points = weight_centre.size + weight_node.size
    fraction, rate, pressure, eta = (
        np.empty(points),
        np.empty(points),
        np.empty(points),
        np.empty(points),
    )
    n = _pack_centres(fraction, rate, pressure, e_centre, g_node, pressure_filled, geometry)
    n = _pack_nodes(fraction, rate, pressure, n, e_centre, g_node, pressure_filled, geometry)
    effective_viscosities(eta[:n], rate[:n], pressure[:n], material)
    weight_centre[:] = 0.0
    weight_node[:] = 0.0
    n = 0
    for i in range(weight_centre.shape[0]):
        filled, weight = geometry.filled[i], weight_centre[i]
        for k in range(geometry.reach[i]):
            if filled[k] > WET:
                weight[k] = fraction[n] * eta[n]
                n += 1
    for i in range(1, weight_centre.shape[0]):
        interior, weight = geometry.interior[i], weight_node[i]
        for k in range(1, geometry.reach[i]):
            if interior[k]:
                weight[k] = fraction[n] * eta[n]
                n += 1


@inner_jit()
def _pack_centres(fraction, rate, pressure, e_centre, g_node, pressure_filled, geometry):
    """Filled fraction, shear rate and pressure of the wet cells; return their number."""
    n = 0
    for i in range(e_centre.shape[0]):
        filled, e, p = geometry.filled[i], e_centre[i], pressure_filled[i]
        left, right = g_node[i], g_node[i + 1]
        for k in range(geometry.reach[i]):
            v = filled[k]
            if v > WET:
                fraction[n] = v
                rate[n] = shear_rate_from(
                    4.0 * e[k] * e[k], mean_square(left[k], right[k], left[k + 1], right[k + 1])
                )
                pressure[n] = p[k] / v
                n += 1
    return n


@inner_jit()
def _pack_nodes(fraction, rate, pressure, n, e_centre, g_node, pressure_filled, geometry):
    """The same of the interior nodes, from place n on: means of the four cells around each."""
    for i in range(1, e_centre.shape[0]):
        interior, g = geometry.interior[i], g_node[i]
        filled_l, filled_r = geometry.filled[i - 1], geometry.filled[i]
        e_l, e_r = e_centre[i - 1], e_centre[i]
        p_l, p_r = pressure_filled[i - 1], pressure_filled[i]
        for k in range(1, geometry.reach[i]):
            if interior[k]:
                v = 0.25 * (filled_l[k - 1] + filled_r[k - 1] + filled_l[k] + filled_r[k])
                p = 0.25 * (p_l[k - 1] + p_r[k - 1] + p_l[k] + p_r[k])
                e2 = mean_square(e_l[k - 1], e_r[k - 1], e_l[k], e_r[k])
                fraction[n] = v
                rate[n] = shear_rate_from(4.0 * e2, g[k] * g[k])
                pressure[n] = p / v
                n += 1
    return n


@inner_jit()
def add_own(flat, width, a, value):
    """Add value to the diagonal of the unknown a, where it exists, in the flat band."""
    if a >= 0:
        flat[a * width] += value


@inner_jit()
def add_pair(flat, width, a, b, value):
    """Add value at the places (a, b) and (b, a) of the matrix, where both unknowns exist.

    The band holds one of the two; in a periodic stretch one column long a and b are the same.
    """
    if a >= 0 and b >= 0:
        flat[min(a, b) * width + abs(a - b)] += value if a != b else 2.0 * value


@kernel_jit()
def add_cells(band, weight_centre, constrained, penalty, geometry, dx, dz):
    """Add the blocks of the cells: viscous, and penalty * div^T div where `constrained` (augmented Lagrangian).

    `penalty` (nx, nz) is in Pa s. With a = (-open_left/dx, open_right/dx) and b = (-1/dz, 1/dz),
    div = (a, b) and the normal strain 2 e = (a, -b): two rank-one blocks that differ in the sign of
    the mixed terms.
    """
    per_z = 1.0 / dz
    flat, width = band.reshape(-1), band.shape[1]
    for i in range(geometry.first, geometry.last):
        weight, imposed, hardness = weight_centre[i], constrained[i], penalty[i]
        left, right, across = geometry.index_u[i], geometry.index_u[i + 1], geometry.index_w[i]
        open_left, open_right = geometry.aperture[i], geometry.aperture[i + 1]
        for k in range(geometry.reach[i]):
            push = hardness[k] if imposed[k] else 0.0
            same, mixed = push + weight[k], push - weight[k]
            if same == 0.0:
                continue
            a_l, a_r = -open_left[k] / dx, open_right[k] / dx
            a, b, low, high = left[k], right[k], across[k], across[k + 1]
            add_own(flat, width, a, same * a_l * a_l)
            add_own(flat, width, b, same * a_r * a_r)
            add_pair(flat, width, a, b, same * a_l * a_r)
            along = same * per_z * per_z
            add_own(flat, width, low, along)
            add_own(flat, width, high, along)
            add_pair(flat, width, low, high, -along)
            crossed = mixed * per_z
            add_pair(flat, width, a, low, -crossed * a_l)
            add_pair(flat, width, a, high, crossed * a_l)
            add_pair(flat, width, b, low, -crossed * a_r)
            add_pair(flat, width, b, high, crossed * a_r)


@kernel_jit()
def add_nodes(band, weight_node, geometry, dx, dz):
    """Add the viscous blocks of the interior nodes, the squares of du/dz + dw/dx."""
    xx, zz, xz = 1.0 / (dx * dx), 1.0 / (dz * dz), 1.0 / (dx * dz)
    flat, width = band.reshape(-1), band.shape[1]
    for i in range(geometry.first, geometry.last):
        weight, here = weight_node[i], geometry.index_u[i]
        before, after = geometry.index_w[i - 1], geometry.index_w[i]
        for k in range(1, geometry.reach[i]):
            g = weight[k]
            if g > 0.0:
                low, high, a, b = here[k - 1], here[k], before[k], after[k]
                add_own(flat, width, low, g * zz)
                add_own(flat, width, high, g * zz)
                add_own(flat, width, a, g * xx)
                add_own(flat, width, b, g * xx)
                add_pair(flat, width, low, high, -g * zz)
                add_pair(flat, width, a, b, -g * xx)
                add_pair(flat, width, low, a, g * xz)
                add_pair(flat, width, low, b, -g * xz)
                add_pair(flat, width, high, a, -g * xz)
                add_pair(flat, width, high, b, g * xz)


@kernel_jit()
def divergence(u, w, aperture, i, k, dx, dz):
    """Div u of cell (i, k) through the open part of its faces, 1/s."""
    return (aperture[i + 1, k] * u[i + 1, k] - aperture[i, k] * u[i, k]) / dx + (
        w[i, k + 1] - w[i, k]
    ) / dz
