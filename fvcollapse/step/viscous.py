"""div(2 eta D) as a symmetric form, and the penalty of div u, assembled into the band.

The dissipation sum(4 V eta e^2) over cells + sum(V eta g^2) over nodes is differentiated with
respect to the face velocities: each cell and each node adds a rank-one 4 x 4 block, so the matrix
is symmetric positive by construction and the stress-free surface is its natural boundary condition.
Everything is per unit volume: Pa/m per m/s.
"""

import math
from typing import NamedTuple

import numpy as np

from .compiled import inner_jit, kernel_jit
from .geometry import WET
from .rheology import ETA_FLOOR, effective_viscosities
from .shear_planes import pressure_on_plane
from .strain import mean_square, shear_rate_centre, shear_rate_from


class Points(NamedTuple):
    """Wet cells and interior nodes, one after the other, as arrays (n,).

    `fraction` is the filled fraction of a cell or the wetted part of the plane of a node, `rate` the shear rate, 1/s,
    `pressure` in Pa. The extra friction of the effects adds extra * push / rate to fraction times viscosity, Pa s:

    * at a cell `extra` is the number 1, `push` friction times fraction times pressure, Pa;
    * at a node `extra` is the mean over its cells of friction times filled fraction, and `push` the pressure on its
      plane over the mean filled fraction, Pa.
    """

    fraction: np.ndarray
    rate: np.ndarray
    pressure: np.ndarray
    extra: np.ndarray
    push: np.ndarray


@inner_jit()
def viscosity_weights(
    weight_centre,
    weight_node,
    e_centre,
    g_node,
    pressure_filled,
    geometry,
    material,
    adhesion,
    friction,
):
    """Effective viscosity, Pa s, times the filled fraction of wet cells or the wetted part of the planes of nodes.

    It is zero elsewhere. `adhesion` is p_c, Pa (`adhesion`); `friction` (nx, nz) is the extra friction of the effects,
    or None.

    The points are packed first, so that the viscosity is one long loop without branches.
    """
    size = weight_centre.size + weight_node.size
    points = Points(np.empty(size), np.empty(size), np.empty(size), np.empty(size), np.empty(size))
    n = _pack_centres(points, e_centre, g_node, pressure_filled, geometry, friction)
    n = _pack_nodes(points, n, e_centre, g_node, pressure_filled, geometry, adhesion, friction)
    weights = np.empty(n)
    effective_viscosities(weights, points.rate[:n], points.pressure[:n], material)
    for m in range(n):
        weights[m] *= points.fraction[m]
    if friction is not None:
        _add_friction(weights, points, material.shear_rate_min)
    weight_centre[:] = 0.0
    weight_node[:] = 0.0
    n = 0
    for i in range(weight_centre.shape[0]):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] > WET:
                weight_centre[i, k] = weights[n]
                n += 1
    for i in range(1, weight_centre.shape[0]):
        for k in range(1, geometry.reach[i]):
            if geometry.interior[i, k] and geometry.plane[i, k] > 0.0:
                weight_node[i, k] = weights[n]
                n += 1


@inner_jit()
def _pack_centres(points, e_centre, g_node, pressure_filled, geometry, friction):
    """Set the `Points` of the wet cells; return their number."""
    n = 0
    filled = geometry.filled
    for i in range(e_centre.shape[0]):
        for k in range(geometry.reach[i]):
            v = filled[i, k]
            if v > WET:
                points.fraction[n] = v
                points.rate[n] = shear_rate_centre(e_centre, g_node, i, k)
                points.pressure[n] = pressure_filled[i, k] / v
                if friction is not None:
                    points.extra[n] = 1.0
                    points.push[n] = max(pressure_filled[i, k], 0.0) * friction[i, k]
                n += 1
    return n


@inner_jit()
def _pack_nodes(points, n, e_centre, g_node, pressure_filled, geometry, adhesion, friction):
    """The same of the interior nodes, from place n on: those of its plane."""
    plane, interior = geometry.plane, geometry.interior
    for i in range(1, e_centre.shape[0]):
        for k in range(1, geometry.reach[i]):
            v = plane[i, k]
            if interior[i, k] and v > 0.0:
                e2 = mean_square(
                    e_centre[i - 1, k - 1], e_centre[i, k - 1], e_centre[i - 1, k], e_centre[i, k]
                )
                p = pressure_at_node(pressure_filled, geometry, i, k, adhesion)
                points.fraction[n] = v
                points.rate[n] = shear_rate_from(4.0 * e2, g_node[i, k] * g_node[i, k])
                points.pressure[n] = p / v
                if friction is not None:
                    filled, points.extra[n] = friction_at_node(friction, geometry, i, k)
                    points.push[n] = max(p, 0.0) / filled
                n += 1
    return n


@inner_jit()
def friction_at_node(friction, geometry, i, k):
    """Mean over the four cells of a node of their filled fractions, and of these times the extra friction."""
    filled = extra = 0.0
    for a in range(i - 1, i + 1):
        for b in range(k - 1, k + 1):
            filled += 0.25 * geometry.filled[a, b]
            extra += 0.25 * geometry.filled[a, b] * friction[a, b]
    return filled, extra


@inner_jit(error_model="numpy")
def _add_friction(weights, points, shear_rate_min):
    """Add the extra friction to viscosity times fraction (n,), Pa s: one loop of vector instructions."""
    for n in range(weights.size):
        rate = math.sqrt(points.rate[n] * points.rate[n] + shear_rate_min * shear_rate_min)
        added = points.extra[n] * (points.push[n] / rate)
        weights[n] = max(weights[n] + added, points.fraction[n] * ETA_FLOOR)


@inner_jit()
def pressure_at_node(pressure_filled, geometry, i, k, adhesion):
    """Pressure on the plane of a node times its wetted part, Pa; the part p_c of it acts on all of the plane."""
    p = pressure_on_plane(pressure_filled, geometry, i, k)
    if adhesion > 0.0:
        p += adhesion * (geometry.plane[i, k] - pressure_on_plane(geometry.filled, geometry, i, k))
    return p


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
    index_u, index_w, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    flat, width = band.reshape(-1), band.shape[1]
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            push = penalty[i, k] if constrained[i, k] else 0.0
            same, mixed = push + weight_centre[i, k], push - weight_centre[i, k]
            if same == 0.0:
                continue
            a_l, a_r = -aperture[i, k] / dx, aperture[i + 1, k] / dx
            a, b, low, high = index_u[i, k], index_u[i + 1, k], index_w[i, k], index_w[i, k + 1]
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
    index_u, index_w = geometry.index_u, geometry.index_w
    flat, width = band.reshape(-1), band.shape[1]
    for i in range(geometry.first, geometry.last):
        for k in range(1, geometry.reach[i]):
            g = weight_node[i, k]
            if g > 0.0:
                low, high, a, b = index_u[i, k - 1], index_u[i, k], index_w[i - 1, k], index_w[i, k]
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
