"""div(2 eta D) as a symmetric form, and the penalty of div u, assembled into the band.

The dissipation sum(4 V eta e^2) over cells + sum(V eta g^2) over nodes is differentiated with
respect to the face velocities: each cell and each node adds a rank-one 4 x 4 block, so the matrix
is symmetric positive by construction and the stress-free surface is its natural boundary condition.
Everything is per unit volume: Pa/m per m/s.
"""

from numba import njit

from .geometry import WET
from .rheology import effective_viscosity
from .strain import node_is_interior, shear_rate_centre, shear_rate_node


@njit(cache=True)
def viscosity_weights(
    weight_centre, weight_node, e_centre, g_node, pressure_filled, geometry, material
):
    """Filled fraction times effective viscosity at wet cells and interior nodes, zero elsewhere. Pa s."""
    nx = weight_centre.shape[0]
    filled = geometry.filled
    weight_centre[:] = 0.0
    weight_node[:] = 0.0
    for i in range(nx):
        for k in range(geometry.reach[i]):
            v = filled[i, k]
            if v > WET:
                rate = shear_rate_centre(e_centre, g_node, i, k)
                weight_centre[i, k] = v * effective_viscosity(
                    rate, pressure_filled[i, k] / v, material
                )
    for i in range(1, nx):
        for k in range(1, geometry.reach[i]):
            if node_is_interior(geometry.index_u, geometry.index_w, i, k):
                v = 0.25 * (
                    filled[i - 1, k - 1] + filled[i, k - 1] + filled[i - 1, k] + filled[i, k]
                )
                p = 0.25 * (
                    pressure_filled[i - 1, k - 1]
                    + pressure_filled[i, k - 1]
                    + pressure_filled[i - 1, k]
                    + pressure_filled[i, k]
                )
                rate = shear_rate_node(e_centre, g_node, i, k)
                weight_node[i, k] = v * effective_viscosity(rate, p / v, material)


@njit(cache=True)
def add_rank_one(band, weight, n_0, c_0, n_1, c_1, n_2, c_2, n_3, c_3):
    """Band += weight * c c^T on the unknowns n_j >= 0 (lower triangle)."""
    numbers = (n_0, n_1, n_2, n_3)
    values = (c_0, c_1, c_2, c_3)
    for a in range(4):
        row = numbers[a]
        if row < 0:
            continue
        for b in range(4):
            column = numbers[b]
            if 0 <= column <= row:
                band[column, row - column] += weight * values[a] * values[b]


@njit(cache=True)
def add_viscous(band, weight_centre, weight_node, geometry, dx, dz):
    """Add the viscous blocks of all cells and nodes."""
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if weight_centre[i, k] > 0.0:
                add_rank_one(
                    band,
                    weight_centre[i, k],
                    iu[i, k],
                    -aperture[i, k] / dx,
                    iu[i + 1, k],
                    aperture[i + 1, k] / dx,
                    iw[i, k],
                    1.0 / dz,
                    iw[i, k + 1],
                    -1.0 / dz,
                )
            if weight_node[i, k] > 0.0:
                add_rank_one(
                    band,
                    weight_node[i, k],
                    iu[i, k - 1],
                    -1.0 / dz,
                    iu[i, k],
                    1.0 / dz,
                    iw[i - 1, k],
                    -1.0 / dx,
                    iw[i, k],
                    1.0 / dx,
                )


@njit(cache=True)
def add_incompressibility(band, penalty, constrained, geometry, dx, dz):
    """Add penalty * div^T div of the constrained cells (augmented Lagrangian)."""
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if constrained[i, k]:
                add_rank_one(
                    band,
                    penalty,
                    iu[i, k],
                    -aperture[i, k] / dx,
                    iu[i + 1, k],
                    aperture[i + 1, k] / dx,
                    iw[i, k],
                    -1.0 / dz,
                    iw[i, k + 1],
                    1.0 / dz,
                )


@njit(cache=True)
def divergence(u, w, aperture, i, k, dx, dz):
    """Div u of cell (i, k) through the open part of its faces, 1/s."""
    return (aperture[i + 1, k] * u[i + 1, k] - aperture[i, k] * u[i, k]) / dx + (
        w[i, k + 1] - w[i, k]
    ) / dz
