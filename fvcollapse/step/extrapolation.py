"""Velocity beyond the surface: continued outwards layer by layer, for the advection of surface and momentum."""

import numpy as np

from .arrays import add, total
from .compiled import inner_jit, kernel_jit
from .geometry import WET
from .stencils import minmod

LAYERS = 7  # the level-set band plus the reach of the advection stencils
TRUSTED_U = 0.05  # part of a full face mass below which u is continued from behind
TRUSTED_W = (
    1.0e-4  # the same for w, where div u = 0 determines it; not beside cells that are free to open
)
TRUSTED_FILM = (
    1.0e-4  # the same for u of a film on the bed behind the front: inertia and weight are its own
)
SOLENOIDAL_LAYERS = (
    2  # empty cells beyond the surface in which the continued velocity is made divergence-free
)
BORDER = -2  # mark of what is beyond the edges of the grid: neither known nor to be found


@inner_jit()
def smooth_continuation(field, known, i, k):
    """Continuation along the grid lines on which three known faces adjoin, averaged over these lines.

    The slope is continued with its own trend, but never steepened or reversed: shear that fades
    towards the surface keeps fading.

    Returns
    -------
    value : float
    count : int
        Number of such lines; 0 if there is none.
    """
    nx, nz = field.shape
    summed = 0.0
    count = 0
    for di, dk in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        a, b = i + 3 * di, k + 3 * dk
        if not (0 <= a < nx and 0 <= b < nz):
            continue
        if known[i + di, k + dk] == 1 and known[i + 2 * di, k + 2 * dk] == 1 and known[a, b] == 1:
            first = field[i + di, k + dk]
            slope = first - field[i + 2 * di, k + 2 * dk]
            before = field[i + 2 * di, k + 2 * dk] - field[a, b]
            summed += first + minmod(slope, 2.0 * slope - before)
            count += 1
    return (summed / count if count > 0 else 0.0), count


@kernel_jit()
def extrapolate(field, known, layers):
    """Fill the faces where `known` is 0, outwards: smoothly in the first layer, with the neighbours' mean beyond.

    The first layer moves the surface. Taking it constant would make a sheared, sloping surface
    systematically too slow and lose volume in proportion to the cell size.

    Parameters
    ----------
    field : 2-D float array
        One velocity component; faces beyond the last layer are set to zero.
    known : 2-D int array of the same shape
        1 where the value stands, 0 where it is to be found; overwritten with the layer number.
    """
    nx, nz = field.shape
    marks = np.full((nx + 2, nz + 2), BORDER, np.int8)  # small, and every neighbour is there
    front_i, front_k = np.empty(field.size, np.int64), np.empty(field.size, np.int64)
    for i in range(nx):
        for k in range(nz):
            marks[i + 1, k + 1] = known[i, k]
    end = 0
    for i in range(nx):
        for k in range(nz):
            if known[i, k] == 1:
                end = _queue_neighbours(front_i, front_k, end, marks, i, k)
    start = 0
    for layer in range(1, layers + 1):
        layer_end = end
        for j in range(start, layer_end):
            i, k = front_i[j], front_k[j]
            if layer == 1:
                value, lines = smooth_continuation(field, known, i, k)
                if lines > 0:
                    field[i, k] = value
                    continue
            field[i, k] = _mean_of_known(field, marks, i, k)
        for j in range(start, layer_end):
            marks[front_i[j] + 1, front_k[j] + 1] = layer + 1
        for j in range(start, layer_end):
            end = _queue_neighbours(front_i, front_k, end, marks, front_i[j], front_k[j])
        start = layer_end
    for i in range(nx):
        for k in range(nz):
            known[i, k] = max(marks[i + 1, k + 1], 0)
            if known[i, k] == 0:
                field[i, k] = 0.0


@inner_jit()
def _queue_neighbours(front_i, front_k, end, marks, i, k):
    """Append the unknown neighbours of (i, k) to the front, marked -1; return its new end."""
    for a in range(i, i + 3):
        for b in range(k, k + 3):
            if marks[a, b] == 0:
                marks[a, b] = -1
                front_i[end], front_k[end] = a - 1, b - 1
                end += 1
    return end


@inner_jit(error_model="numpy")
def _mean_of_known(field, marks, i, k):
    """Mean of the known neighbours of (i, k), those across a side counted twice."""
    summed = 0.0
    count = 0
    for a in range(3):
        for b in range(3):
            if marks[i + a, k + b] > 0:
                weight = 2 if a == 1 or b == 1 else 1
                summed += weight * field[i + a - 1, k + b - 1]
                count += weight
    return summed / count


@inner_jit()
def _is_film(geometry, i):
    """Whether what lies on the bed at x-face i fills hardly any of its cell, and goes on for two faces behind."""
    behind = min(geometry.mass_x[i - 1, 0], geometry.mass_x[i - 2, 0])
    return total(geometry.mass_x[i]) < TRUSTED_U and behind >= TRUSTED_FILM


@kernel_jit()
def mark_known(known_u, known_w, geometry, constrained, film_thickness, dz, closed_end):
    """Mark with 1 the faces whose own velocity is trusted: walls, closed gate, and unknowns with enough grains.

    A tip thinner than `film_thickness` (m) is no continuum; it is carried along by the flow behind it
    instead of being stretched further. Not so a thin place with thicker flow ahead: continued from
    both sides, its velocity would feed on itself. There a film (`_is_film`; not the tip of a mass that
    spreads backwards) keeps its own velocity too: what gravity and bed make of it. Continued from the
    flow ahead into which it runs, it fed that flow with speed (up to 200 m/s, at the tail of a mass that slides
    away on a slippery bed); out of reach of the continuation it stood still on any slope.

    `closed_end`: whether a wall closes the far end.
    """
    nx, nz = geometry.filled.shape
    thick = nx
    while thick > 0 and total(geometry.mass_x[thick]) * dz < film_thickness:
        thick -= 1
    for i in range(nx + 1):
        film = i > thick + 1
        left_behind = 1 < i < thick and _is_film(geometry, i)
        for k in range(nz):
            solid = i == 0 or closed_end and i == nx or geometry.aperture[i, k] == 0.0
            least = TRUSTED_FILM if left_behind and k == 0 else TRUSTED_U
            enough = geometry.mass_x[i, k] >= least
            wet = geometry.index_u[i, k] >= 0 and enough
            known_u[i, k] = 1 if solid or (wet and not film) else 0
        if i > 0:
            for k in range(nz + 1):
                closed = k > 0 and constrained[i - 1, k - 1] or k < nz and constrained[i - 1, k]
                enough = geometry.mass_z[i - 1, k] >= (TRUSTED_W if closed else TRUSTED_U)
                wet = geometry.index_w[i - 1, k] >= 0 and enough
                known_w[i - 1, k] = 1 if k == 0 or (wet and not film) else 0


@kernel_jit()
def close_divergence(u, w, known_u, known_w, filled, layers, dx, dz):
    """Make the continued velocity solenoidal in the first empty cells beyond the surface, layer by layer.

    The outer faces of each empty cell (known later than the others) share the correction that
    closes its divergence.
    """
    nx, nz = filled.shape
    add_u, add_w = np.zeros_like(u), np.zeros_like(w)
    for layer in range(2, layers + 2):
        add_u[:] = 0.0
        add_w[:] = 0.0
        for i in range(nx):
            for k in range(nz):
                if filled[i, k] > WET:
                    continue
                top = max(
                    max(known_u[i, k], known_u[i + 1, k]), max(known_w[i, k], known_w[i, k + 1])
                )
                low = min(
                    min(known_u[i, k], known_u[i + 1, k]), min(known_w[i, k], known_w[i, k + 1])
                )
                if top != layer or low == 0:
                    continue
                left, right = known_u[i, k] == layer, known_u[i + 1, k] == layer
                below, above = known_w[i, k] == layer, known_w[i, k + 1] == layer
                div = (u[i + 1, k] - u[i, k]) / dx + (w[i, k + 1] - w[i, k]) / dz
                share = div / ((left + right) / dx**2 + (below + above) / dz**2)
                add_u[i, k] += left * share / dx
                add_u[i + 1, k] -= right * share / dx
                add_w[i, k] += below * share / dz
                add_w[i, k + 1] -= above * share / dz
        add(u, add_u)
        add(w, add_w)
