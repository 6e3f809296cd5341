"""The volume of the grains, and the correction that holds it where the surface moves."""

import numpy as np

from .arrays import copy, largest
from .compiled import inner_jit, kernel_jit
from .geometry import cell_moments

SHIFT_MOST, LAST_SHIFT = (
    0.1,
    0.5,
)  # cells by which the first and the second correction may move the surface
MOVING = 0.01  # of the largest speed: where the swift surface alone cannot give the volume back, all that moves does
RAMP = 0.01  # by which the second shift falls off from the back wall to the end of the domain
VOLUME_TOLERANCE = 1.0e-12  # of the volume, at which a correction ends
SECANT_TRIALS = 8  # of the search for the shift, four on average; bisection follows
SHIFT_TRIALS = (
    60  # half a cell may come or go within a ten-thousandth of a cell, where a corner passes a node
)


@inner_jit()
def rows_below(reach, level_set, aperture, height):
    """Rows of each column of cells, counted from the bed, up to the last with a corner lower than `height`.

    All rows behind a gate, where the surface of the column continues (`cell_moments`).
    """
    for i in range(reach.size):
        k = level_set.shape[1] - 1
        reach[i] = k
        if aperture[i + 1].min() < 1.0:
            continue
        while k >= 0 and level_set[i, k] >= height and level_set[i + 1, k] >= height:
            k -= 1
        reach[i] = min(k + 1, level_set.shape[1] - 1)


@kernel_jit()
def volume(level_set, aperture, packing, reach):
    """Filled area in cells (multiply by dx dz for m2), each cell weighted by its `packing` (nx, nz).

    It is the sum of `Geometry.filled`, with the faces of the gate open by `aperture` (nx + 1, nz): the volume that
    the solve moves and that the series report.

    `reach` (nx,): rows of each column to visit; what is above is empty.
    """
    total = 0.0
    for i in range(level_set.shape[0] - 1):
        for k in range(reach[i]):
            total += packing[i, k] * cell_moments(level_set, aperture, i, k)[0]
    return total


@inner_jit()
def hold_volume(phi, aperture, speed, packing, target, h):
    """Correct the filled area to `target` (cells) in proportion to the speed; return the volume added, cells.

    The shift is limited (`SHIFT_MOST` cells). Where grains without pressure fly apart, the velocity diverges and
    the shift of the swift surface does not suffice. All that moves (`MOVING`) then gives the volume back. Where a
    face of the surface lies in a row of nodes, they all get wet at the same shift and the volume jumps over the
    target. This second shift falls off along the bed (`RAMP`), so that they get wet one after the other.

    Parameters
    ----------
    phi : (nx + 1, nz + 1) array
        Level set after its motion, m; corrected in place.
    aperture : (nx + 1, nz) array
        Open part of each x-face at the end of the step.
    speed : (nx + 1, nz + 1) array
        Speed at the nodes, m/s.
    packing : (nx, nz) array
        Local density, relative to that of the target.
    target : float
        Filled area weighted by the packing, cells.
    h : float
        Cell size, m.
    """
    fastest = largest(speed)
    if fastest == 0.0:
        return 0.0
    moved, mobility = phi.copy(), np.empty_like(speed)
    for i in range(phi.shape[0]):
        for k in range(phi.shape[1]):
            mobility[i, k] = speed[i, k] / fastest
    added, missing = correct_volume(phi, aperture, mobility, packing, target, SHIFT_MOST * h)
    if abs(missing) > VOLUME_TOLERANCE * target:
        copy(phi, moved)
        for i in range(phi.shape[0]):
            share = 1.0 - RAMP * i / (phi.shape[0] - 1)
            for k in range(phi.shape[1]):
                mobility[i, k] = share * min(mobility[i, k] / MOVING, 1.0)
        added, _ = correct_volume(phi, aperture, mobility, packing, target, LAST_SHIFT * h)
    return added


@kernel_jit()
def correct_volume(phi, aperture, mobility, packing, target, most):
    """Shift phi by q * mobility (in place) until the filled area is `target`; return added and missing, cells.

    Both are weighted by the packing, and so are the mass of the grains where that differs from 1.

    Parameters
    ----------
    aperture : (nx + 1, nz) array
        Open part of each x-face at the end of the step.
    mobility : (nx + 1, nz + 1) array
        Local share of the correction, in [0, 1]: where nothing moves nothing is corrected.
    packing : (nx, nz) array
        Local density, relative to that of the target.
    most : float
        Largest shift, m.
    """
    reach = np.empty(packing.shape[0], np.int64)
    rows_below(reach, phi, aperture, most)
    before = volume(phi, aperture, packing, reach)
    missing = target - before
    if abs(missing) <= VOLUME_TOLERANCE * target:
        return 0.0, 0.0
    original = phi.copy()
    low, high = -most, most
    q_old, gap_old = 0.0, missing
    q = 1e-3 * most if missing > 0.0 else -1e-3 * most
    gap = missing
    for trial in range(SHIFT_TRIALS):
        for i in range(phi.shape[0]):
            for k in range(phi.shape[1]):
                phi[i, k] = original[i, k] - q * mobility[i, k]
        gap = target - volume(phi, aperture, packing, reach)
        if abs(gap) <= VOLUME_TOLERANCE * target or gap == gap_old:
            break
        if gap > 0.0:
            low = q
        else:
            high = q
        if not low < high:
            break
        q_next = q - gap * (q - q_old) / (gap - gap_old)
        q_old, gap_old = q, gap
        q = min(max(q_next, -most), most)
        if trial >= SECANT_TRIALS or (not low < q < high and abs(q) < most):
            q = 0.5 * (low + high)
    return missing - gap, gap
