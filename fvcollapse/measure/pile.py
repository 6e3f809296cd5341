"""Shape and motion of the pile at one instant: thickness, static–flowing interface, front, volume.

Profiles live at the node abscissae x_i = i dx, x = 0 is the back wall and z = 0 the bed; the thickness h is
measured normal to the bed. The pile is what h shows: grains that have left the bed (a splash) count in h
where they are.
"""

import math

import numpy as np

from fvcollapse.step.arrays import larger, total
from fvcollapse.step.compiled import kernel_jit

SPEED_STATIC = 0.01  # m/s; slower grains count as static in the static–flowing interface
THICKNESS_DETACHED = 1.0e-3  # m; grains beyond the first thinner place are detached from the pile


def thickness(level_set, dz):
    """Length h of each vertical node line inside the grains, (nx + 1,), m.

    Parameters
    ----------
    level_set : (nx + 1, nz + 1) array
        Signed distance at the nodes [m], negative in the grains, linear between nodes.
    dz : float
        Node spacing normal to the bed [m].
    """
    cells = np.zeros(len(level_set))
    cells_inside(cells, np.ascontiguousarray(level_set, float))
    return dz * cells


@kernel_jit(error_model="numpy")
def cells_inside(cells, level_set):
    """Add to `cells` (nx + 1,) how many cell edges of each vertical node line lie in the grains."""
    for i in range(cells.size):
        for k in range(level_set.shape[1] - 1):
            low, high = level_set[i, k], level_set[i, k + 1]
            if low < 0.0 or high < 0.0:
                cells[i] += (max(-low, 0.0) + max(-high, 0.0)) / (abs(low) + abs(high))


def speed_xface(state):
    """Speed on the x-faces, (nx + 1, nz), m/s: u there, w averaged from the four z-faces around."""
    w_row = 0.5 * (state.w[:, :-1] + state.w[:, 1:])
    w_xface = np.vstack([w_row[:1], 0.5 * (w_row[:-1] + w_row[1:]), w_row[-1:]])
    return np.hypot(state.u, w_xface)


@kernel_jit()
def fastest_cell(filled, u, w):
    """Largest speed at the centre of a cell with grains, m/s."""
    fastest = 0.0
    for i in range(filled.shape[0]):
        for k in range(filled.shape[1]):
            if filled[i, k] > 0.0:
                along, across = 0.5 * (u[i, k] + u[i + 1, k]), 0.5 * (w[i, k] + w[i, k + 1])
                fastest = larger(fastest, math.hypot(along, across))
    return fastest


def ill_posed_share(state, quantities):
    """Share of the flowing volume that is ill-posed; 0 where nothing flows."""
    filled, u, w = quantities["filled_fraction"], state.u, state.w
    speed = np.hypot(0.5 * (u[:-1] + u[1:]), 0.5 * (w[:, :-1] + w[:, 1:]))
    flowing = np.where(speed > SPEED_STATIC, filled, 0.0)
    volume = flowing.sum()
    return float(flowing[quantities["ill_posed"]].sum() / volume) if volume > 0.0 else 0.0


def static_height(state, grid):
    """Height of the static–flowing interface above the bed, (nx + 1,), m.

    The lowest height above which every grain of the column is faster than `SPEED_STATIC`: 0 =
    moving down to the bed, h = at rest. The speed is linear between the bed (where it is the slip
    velocity) and the x-face centres.
    """
    h = thickness(state.level_set, grid.dz)
    z = np.concatenate([[0.0], grid.dz * (np.arange(grid.nz) + 0.5), [grid.dz * grid.nz]])
    face = speed_xface(state)
    speed = np.column_stack([np.abs(state.bed_slip), face, face[:, -1]])
    slow = (speed <= SPEED_STATIC) & (z < np.maximum(h, 1.0e-12)[:, None])
    top = np.where(slow.any(axis=1), len(z) - 1 - np.argmax(slow[:, ::-1], axis=1), -1)
    row = np.arange(len(h))
    above = np.minimum(top + 1, len(z) - 1)
    rise = speed[row, above] - speed[row, top]
    share = np.where(
        rise > 0.0, (SPEED_STATIC - speed[row, top]) / np.where(rise > 0.0, rise, 1.0), np.inf
    )
    height = z[top] + np.minimum(share, 1.0) * (z[above] - z[top])
    height = np.where(speed[row, above] <= SPEED_STATIC, h, height)  # slow to the surface: at rest
    return np.where(top < 0, 0.0, np.minimum(height, h))


@kernel_jit()
def front_position(x, h, threshold):
    """First x from the back wall, connected to the pile, where h falls below `threshold` [m].

    Linear interpolation. When the back wall itself is bare, the pile is the connected part that
    holds the highest point. 0 if h is nowhere that thick, and the last abscissa if it never falls
    below.
    """
    start = 0
    if not h[0] >= threshold:
        for n in range(h.size):
            if h[n] > h[start]:
                start = n
        if not h[start] >= threshold:
            return 0.0
    i = start
    while i < h.size and h[i] >= threshold:
        i += 1
    if i == h.size:
        return float(x[-1])
    share = (h[i - 1] - threshold) / (h[i - 1] - h[i])
    return float(x[i - 1] + share * (x[i] - x[i - 1]))


@kernel_jit()
def x_at_volume(x, column_volume, fraction):
    """Abscissa behind which `fraction` of the volume lies, columns being uniform inside [m].

    Parameters
    ----------
    x : (nx + 1,) array
        Node abscissae [m].
    column_volume : (nx,) array
        Volume per unit width of each column of cells [m2].
    fraction : float
        0.99 for x_99.
    """
    wanted = fraction * total(column_volume)
    if wanted <= 0.0:
        return 0.0
    behind = 0.0
    for i in range(column_volume.size):
        if behind + column_volume[i] >= wanted and column_volume[i] > 0.0:
            return float(x[i] + (wanted - behind) / column_volume[i] * (x[i + 1] - x[i]))
        behind += column_volume[i]
    return float(x[-1])


@kernel_jit()
def detached_volume(x, h):
    """Fraction of the volume beyond the first X where h < 1 mm, h being piecewise linear."""
    front = front_position(x, h, THICKNESS_DETACHED)
    area = beyond = 0.0
    for i in range(x.size - 1):
        width = x[i + 1] - x[i]
        area += 0.5 * (h[i] + h[i + 1]) * width
        outside = min(max(x[i + 1] - front, 0.0), width)
        at_front = h[i + 1] + outside / width * (h[i] - h[i + 1])
        beyond += 0.5 * (at_front + h[i + 1]) * outside
    return beyond / area if area > 0.0 else 0.0
