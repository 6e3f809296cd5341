"""How much of each cell and face the grains fill, from the level set at the nodes.

In every cell the surface is the polygon cut by linear interpolation along the four edges. The mass
of a cell is split between its two opposite faces by the lever rule (its centroid), so that the face
masses carry the exact mass and first moment. With the multiplier P = filled fraction * mean
pressure, the discrete gradient of P then balances gravity exactly for any plane level surface, at
any angle to the grid; and sum(P) is the exact volume integral of the pressure, which is what wall
friction needs.
"""

from typing import NamedTuple

import numpy as np

from .compiled import inner_jit, kernel_jit
from .saddle import is_saddle, saddle_moments

WET = 1.0e-8  # filled fraction below which a cell counts as empty; its weight is below round-off of its neighbours
MASS_FLOOR = 1.0e-4  # inertia of a nearly empty face, as a fraction of a full one; its weight keeps the true mass


class Geometry(NamedTuple):
    """Fluid fractions of one step; all dimensionless, as fractions of a full cell.

    filled (nx, nz); lever_x, lever_z (nx, nz): part of the cell's mass carried by its right / top
    face; mass_x (nx+1, nz), mass_z (nx, nz+1); aperture (nx+1, nz): open part of each x-face
    (gate); bed_cover (nx,), wall_cover (nz,), gate_cover (nz,): wetted part of each cell's stretch
    of the bed, of the back wall and of the closed gate; index_u, index_w: number of the unknown on
    each face, -1 where there is none; first, last: the columns [first, last) that are solved; all
    of them, but for the halo of a periodic stretch; interior (nx+1, nz+1): nodes whose four faces
    are all unknowns, the others lie on a wall, the gate or the surface; plane, lying (nx+1, nz+1):
    wetted part of the plane on which the grains shear at each node, and how much of it lies level
    (`shear_planes`); cut_row, cut_part (nx + 1,): where the surface
    crosses each upright grid line (`side_shear`); reach (nx + 1,): rows of
    the cells, faces and nodes of column i that can touch grains, so that the loops of the solve
    need not visit the air; packing (nx, nz): local density over density_bulk, 1 in an
    incompressible mass; face masses carry it.
    """

    filled: np.ndarray
    lever_x: np.ndarray
    lever_z: np.ndarray
    mass_x: np.ndarray
    mass_z: np.ndarray
    aperture: np.ndarray
    bed_cover: np.ndarray
    wall_cover: np.ndarray
    gate_cover: np.ndarray
    index_u: np.ndarray
    index_w: np.ndarray
    interior: np.ndarray
    plane: np.ndarray
    lying: np.ndarray
    cut_row: np.ndarray
    cut_part: np.ndarray
    reach: np.ndarray
    packing: np.ndarray
    first: int
    last: int


def allocate_geometry(nx, nz, halo=0):
    """Empty `Geometry` for an nx by nz grid, of which `halo` columns at each end repeat a periodic stretch."""
    return Geometry(
        np.zeros((nx, nz)),
        np.zeros((nx, nz)),
        np.zeros((nx, nz)),
        np.zeros((nx + 1, nz)),
        np.zeros((nx, nz + 1)),
        np.ones((nx + 1, nz)),
        np.zeros(nx),
        np.zeros(nz),
        np.zeros(nz),
        np.full((nx + 1, nz), -1, np.int64),
        np.full((nx, nz + 1), -1, np.int64),
        np.zeros((nx + 1, nz + 1), np.bool_),
        np.zeros((nx + 1, nz + 1)),
        np.ones((nx + 1, nz + 1)),
        np.full(nx + 1, -1, np.int64),
        np.zeros(nx + 1),
        np.zeros(nx + 1, np.int64),
        np.ones((nx, nz)),
        halo,
        nx - halo,
    )


@kernel_jit(error_model="numpy")
def polygon_moments(phi_00, phi_10, phi_11, phi_01):
    """Area and first moments of the part of the unit square where phi < 0.

    Parameters
    ----------
    phi_00, phi_10, phi_11, phi_01 : float
        Level set at the corners, anticlockwise from the lower left; only ratios matter.

    Returns
    -------
    area, moment_x, moment_z : float
        Integrals of 1, x and z over the polygon.
    """
    if phi_00 < 0.0 and phi_10 < 0.0 and phi_11 < 0.0 and phi_01 < 0.0:
        return 1.0, 0.5, 0.5
    if phi_00 >= 0.0 and phi_10 >= 0.0 and phi_11 >= 0.0 and phi_01 >= 0.0:
        return 0.0, 0.0, 0.0
    if is_saddle(phi_00, phi_10, phi_11, phi_01):
        return saddle_moments(phi_00, phi_10, phi_11, phi_01)
    phi = (phi_00, phi_10, phi_11, phi_01, phi_00)
    corner_x = (0.0, 1.0, 1.0, 0.0, 0.0)
    corner_z = (0.0, 0.0, 1.0, 1.0, 0.0)
    count = 0
    x_first = z_first = x_last = z_last = 0.0
    area = moment_x = moment_z = 0.0
    for edge in range(4):
        a = phi[edge]
        b = phi[edge + 1]
        for part in range(2):  # the corner itself, then the crossing of the edge that follows it
            if part == 0:
                if a >= 0.0:
                    continue
                x = corner_x[edge]
                z = corner_z[edge]
            else:
                if (a < 0.0) == (b < 0.0):
                    continue
                t = a / (a - b)
                x = corner_x[edge] + t * (corner_x[edge + 1] - corner_x[edge])
                z = corner_z[edge] + t * (corner_z[edge + 1] - corner_z[edge])
            if count == 0:
                x_first = x
                z_first = z
            elif count >= 2:
                twice = (x_last - x_first) * (z - z_first) - (x - x_first) * (z_last - z_first)
                area += 0.5 * twice
                moment_x += twice * (x_first + x_last + x) / 6.0
                moment_z += twice * (z_first + z_last + z) / 6.0
            x_last = x
            z_last = z
            count += 1
    return area, moment_x, moment_z


@inner_jit()
def cell_moments(level_set, aperture, i, k):
    """Filled area of cell (i, k) and its first moments, with the gate's faces open by `aperture`; `polygon_moments`.

    At a gate the surface on its inner side continues straight through it, as through any wall, so
    that a column standing against it has no spurious corner there; and beyond a closed gate nothing
    is filled by the interpolation across it, or a thousandth of a cell would leak through and fall.
    Both hold in proportion to the closed part of the face: the volume does not jump as the gate passes.
    """
    left_low, left_high = level_set[i, k], level_set[i, k + 1]
    right_low, right_high = level_set[i + 1, k], level_set[i + 1, k + 1]
    shut = 1.0 - aperture[i + 1, k]
    if shut > 0.0 and i > 0:
        right_low += shut * min(2.0 * left_low - level_set[i - 1, k] - right_low, 0.0)
        right_high += shut * min(2.0 * left_high - level_set[i - 1, k + 1] - right_high, 0.0)
    shut = 1.0 - aperture[i, k]
    if shut > 0.0:
        left_low += shut * max(min(right_low, 0.0) - left_low, 0.0)
        left_high += shut * max(min(right_high, 0.0) - left_high, 0.0)
    return polygon_moments(left_low, right_low, right_high, left_high)


@kernel_jit()
def fill_cells(filled, lever_x, lever_z, level_set, aperture):
    """Filled fraction and lever shares of every cell (`cell_moments`)."""
    nx, nz = filled.shape
    for i in range(nx):
        for k in range(nz):
            area, mx, mz = cell_moments(level_set, aperture, i, k)
            filled[i, k] = area
            lever_x[i, k] = mx
            lever_z[i, k] = mz


@kernel_jit()
def fill_faces(mass_x, mass_z, filled, lever_x, lever_z, packing):
    """Face masses: what the two adjacent cells hand to each face by the lever rule."""
    nx, nz = filled.shape
    mass_x[:] = 0.0
    mass_z[:] = 0.0
    for i in range(nx):
        for k in range(nz):
            density = packing[i, k]
            mass_x[i, k] += density * (filled[i, k] - lever_x[i, k])
            mass_x[i + 1, k] += density * lever_x[i, k]
            mass_z[i, k] += density * (filled[i, k] - lever_z[i, k])
            mass_z[i, k + 1] += density * lever_z[i, k]


@kernel_jit(error_model="numpy")
def wetted_edge(phi_a, phi_b):
    """Part of an edge with end values phi_a, phi_b that lies in the grains (phi < 0)."""
    if phi_a < 0.0 and phi_b < 0.0:
        return 1.0
    if phi_a >= 0.0 and phi_b >= 0.0:
        return 0.0
    return min(phi_a, phi_b) / (min(phi_a, phi_b) - max(phi_a, phi_b))


@inner_jit()
def fill_walls(bed_cover, wall_cover, level_set):
    """Wetted part of each cell's stretch of the bed and of the back wall."""
    for i in range(bed_cover.size):
        bed_cover[i] = wetted_edge(level_set[i, 0], level_set[i + 1, 0])
    for k in range(wall_cover.size):
        wall_cover[k] = wetted_edge(level_set[0, k], level_set[0, k + 1])


@kernel_jit()
def fill_reach(reach, filled):
    """One row more than the highest wet cell of the two columns beside each x-face; 0 where both are dry."""
    nx, nz = filled.shape
    reach[:] = 0
    for i in range(nx):
        top = nz
        while top > 0 and filled[i, top - 1] <= WET:
            top -= 1
        if top > 0:
            reach[i] = max(reach[i], min(top + 1, nz))
            reach[i + 1] = min(top + 1, nz)


@kernel_jit()
def last_face(geometry):
    """End of the x-faces that belong to the solved columns (a periodic stretch counts its first face only)."""
    return geometry.last + (1 if geometry.first == 0 else 0)


@kernel_jit()
def repeat_columns(field, first, last):
    """Copy the periodic stretch [first, last) of a field into its halo, in place."""
    period = last - first
    for i in range(field.shape[0]):
        if i < first or i >= last:
            same = first + (i - first) % period
            for k in range(field.shape[1]):
                field[i, k] = field[same, k]


@inner_jit()
def repeat(geometry, field):
    """The halo of a periodic stretch repeats a field, in place."""
    if geometry.first > 0:
        repeat_columns(field, geometry.first, geometry.last)


def cell_fractions(level_set):
    """Filled fraction of each cell, (nx, nz), from the node level set, with no gate."""
    nx, nz = level_set.shape[0] - 1, level_set.shape[1] - 1
    filled, lever_x, lever_z = np.empty((nx, nz)), np.empty((nx, nz)), np.empty((nx, nz))
    fill_cells(filled, lever_x, lever_z, level_set, np.ones((nx + 1, nz)))
    return filled
