"""Shape and motion of the pile at one instant: thickness, static–flowing interface, front, volume.

Profiles live at the node abscissae x_i = i dx, x = 0 is the back wall and z = 0 the bed; the thickness h is
measured normal to the bed. The pile is what h shows: grains that have left the bed (a splash) count in h
where they are.
"""

import math

import numpy as np

from fvcollapse.step.arrays import larger
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
def survey_motion(filled, u, w, ill_posed):
    """Largest speed at the centre of a cell with grains (m/s), flowing volume and ill-posed part of it (cells)."""
    largest = flowing = part = 0.0
    for i in range(filled.shape[0]):
        for k in range(filled.shape[1]):
            if filled[i, k] > 0.0:
                along, across = 0.5 * (u[i, k] + u[i + 1, k]), 0.5 * (w[i, k] + w[i, k + 1])
                speed = math.hypot(along, across)
                largest = larger(largest, speed)
                if speed > SPEED_STATIC:
                    flowing += filled[i, k]
                    part += ill_posed[i, k] * filled[i, k]
    return largest, flowing, part


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


def front_position(x, h, threshold):
    """First x from the back wall, connected to the pile, where h falls below `threshold` [m].

    Linear interpolation. When the back wall itself is bare, the pile is the connected part that
    holds the highest point. 0 if h is nowhere that thick, and the last abscissa if it never falls
    below.
    """
    thick = h >= threshold
    if not thick.any():
        return 0.0
    start = 0 if thick[0] else int(h.argmax())
    i = start + int(thick[start:].argmin())  # the first that is not
    if thick[i]:
        return float(x[-1])
    share = (h[i - 1] - threshold) / (h[i - 1] - h[i])
    return float(x[i - 1] + share * (x[i] - x[i - 1]))


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
    volume = np.zeros(len(x))
    np.cumsum(column_volume, out=volume[1:])
    if volume[-1] <= 0.0:
        return 0.0
    i = int(volume.searchsorted(fraction * volume[-1]))
    i = min(max(i, 1), len(column_volume))
    share = (fraction * volume[-1] - volume[i - 1]) / column_volume[i - 1]
    return float(x[i - 1] + share * (x[i] - x[i - 1]))


def detached_volume(x, h):
    """Fraction of the volume beyond the first X where h < 1 mm, h being piecewise linear."""
    area = 0.5 * (h[:-1] + h[1:]) * (x[1:] - x[:-1])
    total = area.sum()
    if total <= 0.0:
        return 0.0
    front = front_position(x, h, THICKNESS_DETACHED)
    i = min(int(x.searchsorted(front, side="right")) - 1, len(area) - 1)
    h_front = np.interp(front, x, h)
    beyond = 0.5 * (h_front + h[i + 1]) * (x[i + 1] - front) + area[i + 1 :].sum()
    return float(beyond / total)
