"""What of a node carries shear stress: the plane on which two rows, or two columns, of grains slide over each other.

The stress at a node holds back the grains above its plane by their full weight, however little of the cells above is
filled. Under a surface that lies along the rows the plane is the level line through the node: all of it is wet, and
its pressure is the weight that it carries. Under an upright surface it is the upright line. In between the two lines
count by the square of the surface's normal. Where all four cells are full, nothing of this differs from their means.

The mean of the four cells instead, for both, makes the grains of a row that is filled by f stronger by
(1 + f)^2 / (4 f): they ride on the row below, and a surface that crosses the rows at a small angle rests in steps.
"""

from .compiled import inner_jit, kernel_jit
from .geometry import wetted_edge


@kernel_jit(error_model="numpy")
def fill_planes(plane, lying, filled, level_set, reach):
    """Wetted part of the plane of every inner node, and the part of it that lies level.

    Parameters
    ----------
    plane : (nx + 1, nz + 1) array
        Result: wetted part, 0 to 1.
    lying : (nx + 1, nz + 1) array
        Result: share of the level line, 0 (upright surface) to 1; the upright line has the rest.
    filled : (nx, nz) array
        Filled part of each cell.
    level_set : (nx + 1, nz + 1) array
        m.
    reach : (nx + 1,) array
        Rows to visit.
    """
    plane[:] = 0.0
    lying[:] = 1.0
    for i in range(1, filled.shape[0]):
        for k in range(1, reach[i]):
            if sum_of_cells(filled, i, k) == 4.0:
                plane[i, k] = 1.0
                continue
            here = level_set[i, k]
            left, right = level_set[i - 1, k], level_set[i + 1, k]
            low, high = level_set[i, k - 1], level_set[i, k + 1]
            across, along = (right - left) ** 2, (high - low) ** 2
            share = along / (across + along) if across + along > 0.0 else 0.5
            level = 0.5 * (wetted_edge(left, here) + wetted_edge(here, right))
            upright = 0.5 * (wetted_edge(low, here) + wetted_edge(here, high))
            lying[i, k] = share
            plane[i, k] = share * level + (1.0 - share) * upright


@inner_jit()
def sum_of_cells(field, i, k):
    """Sum of the four cells around node (i, k)."""
    return field[i - 1, k - 1] + field[i, k - 1] + field[i - 1, k] + field[i, k]


@inner_jit(error_model="numpy")
def pressure_on_plane(pressure_filled, geometry, i, k):
    """Pressure on the plane of node (i, k) times its wetted part, Pa.

    Between two cells it is the force, per area, that the one hands to the other: with the shares of their mass that
    the face between them carries it is exact for grains at rest below any plane surface.
    """
    filled = geometry.filled
    if sum_of_cells(filled, i, k) == 4.0:
        return 0.25 * sum_of_cells(pressure_filled, i, k)
    share = geometry.lying[i, k]
    level = upright = 0.0
    for a in range(i - 1, i + 1):
        above, below = filled[a, k] - geometry.lever_z[a, k], geometry.lever_z[a, k - 1]
        level += _handed_on(pressure_filled[a, k], pressure_filled[a, k - 1], above, below)
    for b in range(k - 1, k + 1):
        right, left = filled[i, b] - geometry.lever_x[i, b], geometry.lever_x[i - 1, b]
        upright += _handed_on(pressure_filled[i, b], pressure_filled[i - 1, b], right, left)
    return 0.5 * (share * level + (1.0 - share) * upright)


@inner_jit(error_model="numpy")
def _handed_on(first, second, mass_first, mass_second):
    """Pressure on the face between two cells, from theirs and the masses that they hand to that face."""
    mass = mass_first + mass_second
    return (mass_second * first + mass_first * second) / mass if mass > 0.0 else 0.0
