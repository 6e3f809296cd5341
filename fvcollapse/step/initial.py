"""The mass before the gate moves: signed distance of the column to its free surface."""

import math

import numpy as np

from .erodible_bed import join_layer, layer_thickness
from .grid import Grid, gate_column, spacing
from .state import State

HALO = 10  # columns repeated at each end of a periodic stretch: the reach of one step of WENO5 with Runge-Kutta
ON_SURFACE = 1.0e-12  # distance in cells below which a node counts as on the surface
MARGIN = 8  # empty cells kept between the surface and the end of the grid


def initial_grid(case):
    """Grid that holds the column and the first stretch of its run."""
    dx, dz = spacing(case)
    length, height = _extent(case)
    nz = math.ceil((height + layer_thickness(case)) / dz) + MARGIN
    nx = max(gate_column(case), math.ceil(length / dx)) + 2 * MARGIN
    if case.boundary.ends == "periodic":
        return Grid(gate_column(case) + 2 * HALO, nz, dx, dz)
    if case.boundary.domain_length is not None:
        nx = max(gate_column(case), round(case.boundary.domain_length / dx))
    return Grid(nx, nz, dx, dz)


def initial_level_set(case, grid):
    """Signed distance to the free surface at the nodes, (nx + 1, nz + 1), m, negative in the grains.

    The back wall and the bed are no surface: the column continues through them. On an erodible
    layer the column begins at the surface of the layer. A node on the surface above grains is wet (by
    `ON_SURFACE`): were it dry, half a cell would be missing from the first volume where the corner of the
    column is a node, until the surface moves. A node on an upright face is dry: the front stands there.
    """
    distance = _distance(case, grid)
    distance[:, 0] = np.minimum(distance[:, 0], distance[:, 1])  # as `level_set.close_bed` does
    touch = ON_SURFACE * min(grid.dx, grid.dz)
    on_top = np.abs(distance[:, 1:]) < touch
    on_top &= distance[:, :-1] < -touch
    distance[:, 1:][on_top] = -touch
    return distance


def _distance(case, grid):
    layer = layer_thickness(case)
    x, z = np.meshgrid(grid.x_nodes, grid.z_nodes - layer, indexing="ij")
    geometry = case.geometry
    if case.boundary.ends == "periodic":
        return z - geometry.height_0
    if geometry.polygon is not None:
        return _polygon_distance(x, z, np.asarray(geometry.polygon, float))
    beyond = x - geometry.length_0
    slope = math.radians(geometry.slope_angle_deg)
    if geometry.surface == "horizontal":
        above = (z - geometry.height_0) * math.cos(slope) - (
            x - 0.5 * geometry.length_0
        ) * math.sin(slope)
    else:
        above = z - geometry.height_0
    corner = np.hypot(np.maximum(beyond, 0.0), np.maximum(above, 0.0))
    column = np.where((beyond > 0.0) & (above > 0.0), corner, np.maximum(beyond, above))
    return join_layer(column, above, beyond, z) if layer > 0.0 else column


def initial_state(case, grid):
    """State at rest with the initial level set and no pressure yet."""
    nx, nz = grid.nx, grid.nz
    return State(
        initial_level_set(case, grid),
        np.zeros((nx + 1, nz)),
        np.zeros((nx, nz + 1)),
        np.zeros((nx, nz)),
        np.zeros(nx + 1),
    )


def _extent(case):
    geometry = case.geometry
    if geometry.polygon is not None:
        return tuple(np.max(np.asarray(geometry.polygon, float), axis=0))
    rise = 0.0
    if geometry.surface == "horizontal":
        rise = 0.5 * geometry.length_0 * abs(math.tan(math.radians(geometry.slope_angle_deg)))
    return geometry.length_0, geometry.height_0 + rise


def _polygon_distance(x, z, vertices):
    """Signed distance to the edges of a polygon that do not lie on the back wall or the bed."""
    distance = np.full(x.shape, np.inf)
    inside = np.zeros(x.shape, bool)
    scale = np.max(vertices)
    x_in, z_in = x + 1e-9 * scale, z + 1e-9 * scale  # nodes on the walls count as inside
    for (x_a, z_a), (x_b, z_b) in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        crosses = (z_a > z_in) != (z_b > z_in)
        if z_a != z_b:
            inside ^= crosses & (x_in < x_a + (z_in - z_a) * (x_b - x_a) / (z_b - z_a))
        if (x_a == 0.0 and x_b == 0.0) or (z_a == 0.0 and z_b == 0.0):
            continue
        t = ((x - x_a) * (x_b - x_a) + (z - z_a) * (z_b - z_a)) / (
            (x_b - x_a) ** 2 + (z_b - z_a) ** 2
        )
        t = np.clip(t, 0.0, 1.0)
        distance = np.minimum(
            distance, np.hypot(x - x_a - t * (x_b - x_a), z - z_a - t * (z_b - z_a))
        )
    return np.where(inside, -distance, distance)
