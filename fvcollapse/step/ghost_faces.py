"""Velocity beyond the walls of the domain: two more faces on each side of a component, for its reconstruction."""

import numpy as np

from .compiled import inner_jit


@inner_jit()
def with_ghosts(field, slip, odd_x, odd_z, closed_end):
    """Copy of a velocity component with two more faces on each side.

    Back wall, bed and the wall of a closed far end mirror it: about zero the component normal to them (odd), u about
    the slip of the bed. Any other far end continues it linearly; the top repeats the last face.
    """
    nx, nz = field.shape
    padded = np.empty((nx + 4, nz + 4))
    for i in range(nx):
        for k in range(nz):
            padded[i + 2, k + 2] = field[i, k]
    for m in range(2):
        for k in range(nz):
            padded[1 - m, k + 2] = -field[1 + m, k] if odd_x else field[m, k]
            last, before = field[nx - 1, k], field[nx - 2, k]
            beyond = last + (m + 1) * (last - before)
            if closed_end:
                beyond = -field[nx - 2 - m, k] if odd_x else field[nx - 1 - m, k]
            padded[nx + 2 + m, k + 2] = beyond
    for m in range(2):
        for i in range(nx + 4):
            inner = padded[i, 3 + m] if odd_z else padded[i, 2 + m]
            about = 0.0 if odd_z else slip[min(max(i - 2, 0), nx - 1)]
            padded[i, 1 - m] = 2.0 * about - inner
            padded[i, nz + 2 + m] = padded[i, nz + 1]
    return padded
