"""Numbering of the unknown faces, and the envelope of the matrix that couples them."""

import numpy as np

from .compiled import inner_jit, kernel_jit
from .geometry import WET, repeat_columns


@kernel_jit()
def number_unknowns(geometry, open_end):
    """Number the faces that touch a wet cell; return the last unknown with which each couples, directly or by fill-in.

    Column by column, for a pile is longer than high; a periodic stretch row by row, for its last
    column meets the first. A face between a filled and an empty cell is an unknown too: otherwise a
    free vertical face would be a wall. The columns outside [first, last) repeat a periodic stretch
    and share its numbers.
    """
    index_u, index_w, reach = geometry.index_u, geometry.index_w, geometry.reach
    first, last = geometry.first, geometry.last
    _mark_unknowns(
        index_u, index_w, geometry.filled, geometry.aperture, reach, open_end, first, last
    )
    n = 0
    if first > 0:
        for k in range(index_u.shape[1]):
            for i in range(first, last):
                n = _number(index_u, i, k, n)
                n = _number(index_w, i, k, n)
        repeat_columns(index_u, first, last)
        repeat_columns(index_w, first, last)
    else:
        for i in range(reach.size):
            for k in range(reach[i]):
                n = _number(index_u, i, k, n)
                if i < index_w.shape[0]:
                    n = _number(index_w, i, k, n)
    _mark_interior(geometry.interior, index_u, index_w, reach)
    return _envelope(index_u, index_w, reach, first, last, n)


@inner_jit()
def _mark_interior(interior, index_u, index_w, reach):
    """Nodes around which all four faces are unknowns."""
    interior[:] = False
    for i in range(1, index_w.shape[0]):
        inside, here, left, right = interior[i], index_u[i], index_w[i - 1], index_w[i]
        for k in range(1, reach[i]):
            inside[k] = min(min(here[k - 1], here[k]), min(left[k], right[k])) >= 0


@inner_jit()
def _mark_unknowns(index_u, index_w, filled, aperture, reach, open_end, first, last):
    """Index 0 on the faces that are unknowns (of a periodic stretch, within [first, last)), -1 elsewhere."""
    nx = filled.shape[0]
    index_u[:] = -1
    index_w[:] = -1
    faces = nx + 1 if first == 0 else last
    for i in range(first, faces):
        for k in range(reach[i]):
            left = i > 0 and filled[i - 1, k] > WET
            right = i < nx and filled[i, k] > WET
            if i > 0 and (i < nx or open_end) and (left or right) and aperture[i, k] > 0.0:
                index_u[i, k] = 0
            if i < nx and k > 0 and (filled[i, k] > WET or filled[i, k - 1] > WET):
                index_w[i, k] = 0


@inner_jit()
def _number(index, i, k, n):
    """Give a marked face the number n; return the next number."""
    if index[i, k] < 0:
        return n
    index[i, k] = n
    return n + 1


@inner_jit()
def _envelope(index_u, index_w, reach, first, last, count):
    """Last unknown that each unknown can meet in the factorised matrix: cells and nodes couple four at a time."""
    ends = np.arange(count)
    for i in range(first, last):
        for k in range(reach[i]):
            _join(ends, index_u[i, k], index_u[i + 1, k], index_w[i, k], index_w[i, k + 1])
            if i > 0 and k > 0:
                _join(ends, index_u[i, k - 1], index_u[i, k], index_w[i - 1, k], index_w[i, k])
    for n in range(1, count):
        ends[n] = max(ends[n], ends[n - 1])
    return ends


@inner_jit()
def _join(ends, a, b, c, d):
    high = max(max(a, b), max(c, d))
    for n in (a, b, c, d):
        if n >= 0:
            ends[n] = max(ends[n], high)
