"""Cholesky factorisation A = L D L^T of a symmetric banded matrix, within its envelope.

The unknowns are numbered column by column, so the band is as wide as the pile is high, and narrow
where the pile is thin: `ends` keeps every column of the band to its own height. Four pivots are
eliminated together from two columns at a time, so that a row once loaded serves eight products. Where the band is
`WIDE` its columns no longer fit into the fastest memory: a panel of sixteen pivots is then eliminated
from eight columns at a time, each read and written once.
"""

import numpy as np

from .compiled import inner_jit, kernel_jit
from .lanes import LANES, row_products, scale_rows, subtract_block, subtract_rows

PIVOTS = 4
PANEL = 16
WIDE = 128  # height of a column from which panels pay: 1.4 times as fast at 190, no faster at 95


def allocate_system(ends, buffer=None):
    """Band and right-hand side for unknowns whose columns end at `ends` (n,).

    Parameters
    ----------
    buffer : (m,) array, optional
        All zero; where the band is placed if it is long enough: new memory for every step costs
        more than its zeros. `solve_factorised` leaves it zero again.

    Returns
    -------
    band : (n + LANES, half bandwidth + 1 + padding) array
    rhs : (n + LANES,) array
        Both zero; what is behind the n unknowns stays so.
    """
    half_bandwidth = int(np.max(ends - np.arange(ends.size), initial=0))
    rows, width = ends.size + LANES, width_of(half_bandwidth)
    if buffer is None or buffer.size < rows * width:
        return new_system(ends.size, half_bandwidth)
    return buffer[: rows * width].reshape(rows, width), np.zeros(rows)


@kernel_jit()
def width_of(half_bandwidth):
    """Length of a column of the band with the zeros behind it, which earlier pivots and whole lanes read."""
    together = PANEL if half_bandwidth >= WIDE else PIVOTS
    return half_bandwidth + together + LANES


@kernel_jit()
def new_system(n, half_bandwidth):
    """Band and right-hand side of n unknowns in new memory, for kernels; see `allocate_system`."""
    rows = n + LANES
    return np.zeros((rows, width_of(half_bandwidth))), np.zeros(rows)


@inner_jit()
def system_in(memory, ends):
    """Memory, band and right-hand side as of `allocate_system`, for kernels; new memory where it does not suffice."""
    half_bandwidth = 0
    for n in range(ends.size):
        half_bandwidth = max(half_bandwidth, ends[n] - n)
    rows, width = ends.size + LANES, width_of(half_bandwidth)
    if memory.size < rows * width:
        memory = np.zeros(rows * width)
    return memory, memory[: rows * width].reshape(rows, width), np.zeros(rows)


@inner_jit()
def _clear_column(flat, j, width, ends):
    """Zero column j of the flat band within the envelope; there is nothing else outside of it."""
    flat[j * width : j * width + ends[j] - j + 1] = 0.0


@kernel_jit()
def clear(band, ends):
    """Zero within the envelope: a band that was factorised and not solved with."""
    flat, width = band.reshape(-1), band.shape[1]
    for j in range(ends.size):
        _clear_column(flat, j, width, ends)


@inner_jit()
def _eliminate_pivot(flat, at, width, count, last):
    """Take the pivot column at `at` out of the `count` columns after it; `last` is its height.

    Leaves 1/D in the place of D; returns whether D is positive.
    """
    if not flat[at] > 0.0:
        return False
    inverse = 1.0 / flat[at]
    flat[at] = inverse
    for c in range(1, count + 1):
        target = at + c * width
        factor = flat[at + c] * inverse
        subtract_rows(flat, (target,), flat, (at + c,), ((factor,),), last - c + 1)
    return True


@inner_jit()
def _eliminate_four(flat, a, width, height, begin, last):
    """Take the four pivot columns from `a` on, of this height, out of the columns from begin to last after it."""
    b, c, d = a + width - 1, a + 2 * width - 2, a + 3 * width - 3  # all counted from the row of a
    over_a, over_b, over_c, over_d = flat[a], flat[b + 1], flat[c + 2], flat[d + 3]
    for m in range(begin, last + 1, 2):
        first = (
            flat[a + m] * over_a,
            flat[b + m] * over_b,
            flat[c + m] * over_c,
            flat[d + m] * over_d,
        )
        target = a + m * width
        flat[target] -= (
            first[0] * flat[a + m]
            + first[1] * flat[b + m]
            + first[2] * flat[c + m]
            + first[3] * flat[d + m]
        )
        if m == height:
            break
        n = m + 1
        second = (
            flat[a + n] * over_a,
            flat[b + n] * over_b,
            flat[c + n] * over_c,
            flat[d + n] * over_d,
        )
        subtract_rows(
            flat,
            (target + 1, target + width),
            flat,
            (a + n, b + n, c + n, d + n),
            (first, second),
            height - m,
        )


@inner_jit()
def _eliminate_pivots(flat, a, width, height, last):
    """Take four pivot columns out of each other and of the columns to `last`; 0, or the pivot that is not positive."""
    for p in range(PIVOTS):
        if not _eliminate_pivot(flat, a + p * width, width, PIVOTS - 1 - p, height - p):
            return p + 1
    _eliminate_four(flat, a, width, height, PIVOTS, last)
    return 0


@inner_jit()
def _eliminate_panel(flat, a, width, height, factors):
    """Take a panel of pivot columns out of all that its envelope meets; 0, or the pivot that is not positive.

    `factors` (PANEL LANES,) is scratch.
    """
    for q in range(0, PANEL, PIVOTS):
        info = _eliminate_pivots(flat, a + q * width, width, height - q, PANEL - 1 - q)
        if info != 0:
            return q + info
    c = PANEL
    while c + LANES <= height + 1:
        scale_rows(factors, flat, a + c, width - 1, a, width, PANEL)
        subtract_block(flat, a + c * width, width - 1, a + c, PANEL, factors, height + 1 - c)
        c += LANES
    for q in range(0, PANEL, PIVOTS):
        _eliminate_four(flat, a + q * width, width, height - q, c - q, height - q)
    return 0


@kernel_jit()
def factorise(band, ends):
    """Factorise in place; return 0, or j > 0 if pivot j (counted from 1) is not positive.

    Parameters
    ----------
    band : (n + LANES, half bandwidth + 1 + padding) array
        Lower band, band[c, r - c] = A[r, c], zero elsewhere. On return column c holds 1/D[c] and
        D[c] L[r, c].
    ends : (n,) int64 array
        Last row of the envelope of each column; must not decrease.
    """
    n, width = ends.size, band.shape[1]
    if band.shape[0] < n + LANES:
        raise IndexError  # the lanes would write beyond the end
    flat = band.reshape(-1)
    whole = n - n % PIVOTS
    factors = np.zeros(PANEL * LANES)
    j = 0
    while j < whole:
        together = PIVOTS
        if j + PANEL <= whole and ends[j] - j >= WIDE:  # as `width_of` has it
            together = PANEL
        height = ends[j + together - 1] - j
        if together == PANEL:
            info = _eliminate_panel(flat, j * width, width, height, factors)
        else:
            info = _eliminate_pivots(flat, j * width, width, height, height)
        if info != 0:
            return j + info
        j += together
    for j in range(whole, n):
        if not _eliminate_pivot(flat, j * width, width, ends[j] - j, ends[j] - j):
            return j + 1
    return 0


@kernel_jit()
def solve_factorised(rhs, band, ends):
    """Overwrite the first n of `rhs` (n + LANES,) with the solution, from the band left by `factorise`.

    The band is zero afterwards: each column is cleared where it is read for the last time, while it is in the
    fastest memory. To clear the band on its own cost more than to assemble the matrix into it.
    """
    n, width = ends.size, band.shape[1]
    if band.shape[0] < n + LANES or rhs.size < n + LANES:
        raise IndexError
    flat = band.reshape(-1)
    whole = n - n % PIVOTS
    for j in range(0, whole, PIVOTS):
        _forward_four(rhs, flat, j, j * width, width, ends[j + PIVOTS - 1] - j - PIVOTS + 1)
    for j in range(whole, n):
        rhs[j] *= flat[j * width]
        for m in range(1, ends[j] - j + 1):
            rhs[j + m] -= flat[j * width + m] * rhs[j]
    for j in range(n - 1, whole - 1, -1):
        for m in range(1, ends[j] - j + 1):
            rhs[j] -= flat[j * width + m] * rhs[j + m] * flat[j * width]
        _clear_column(flat, j, width, ends)
    for j in range(whole - PIVOTS, -1, -PIVOTS):
        _backward_four(rhs, flat, j, j * width, width, ends[j + PIVOTS - 1] - j - PIVOTS + 1)
        for c in range(j, j + PIVOTS):
            _clear_column(flat, c, width, ends)


@inner_jit()
def _forward_four(rhs, flat, j, a, width, count):
    """Four unknowns from j on, and their part of the `count` rows below them."""
    b, c, d = a + width - 1, a + 2 * width - 2, a + 3 * width - 3
    x0 = rhs[j] * flat[a]
    x1 = (rhs[j + 1] - flat[a + 1] * x0) * flat[b + 1]
    x2 = (rhs[j + 2] - flat[a + 2] * x0 - flat[b + 2] * x1) * flat[c + 2]
    x3 = (rhs[j + 3] - flat[a + 3] * x0 - flat[b + 3] * x1 - flat[c + 3] * x2) * flat[d + 3]
    rhs[j], rhs[j + 1], rhs[j + 2], rhs[j + 3] = x0, x1, x2, x3
    places = (a + PIVOTS, b + PIVOTS, c + PIVOTS, d + PIVOTS)
    subtract_rows(rhs, (j + PIVOTS,), flat, places, ((x0, x1, x2, x3),), count)


@inner_jit()
def _backward_four(rhs, flat, j, a, width, count):
    """Four unknowns from j on, from the `count` rows below them."""
    b, c, d = a + width - 1, a + 2 * width - 2, a + 3 * width - 3
    places = (a + PIVOTS, b + PIVOTS, c + PIVOTS, d + PIVOTS)
    s0, s1, s2, s3 = row_products(rhs, j + PIVOTS, flat, places, count)
    x3 = rhs[j + 3] - s3 * flat[d + 3]
    x2 = rhs[j + 2] - (s2 + flat[c + 3] * x3) * flat[c + 2]
    x1 = rhs[j + 1] - (s1 + flat[b + 2] * x2 + flat[b + 3] * x3) * flat[b + 1]
    x0 = rhs[j] - (s0 + flat[a + 1] * x1 + flat[a + 2] * x2 + flat[a + 3] * x3) * flat[a]
    rhs[j], rhs[j + 1], rhs[j + 2], rhs[j + 3] = x0, x1, x2, x3
