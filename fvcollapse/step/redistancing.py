"""Restoring the signed distance: |grad phi| = 1 by Gauss-Seidel sweeps.

Second-order ENO differences, whose stencil ends at the surface itself; it is located to sub-cell accuracy by
quadratic interpolation (Russo & Smereka 2000; Min & Gibou 2007). The walls and the bed are no surface: phi continues
straight through them.
"""

import math

import numpy as np

from .compiled import inner_jit, kernel_jit
from .level_set import BAND, close_bed, continue_beyond, padded
from .stencils import minmod

# Cells travelled by the fastest point; half the band, so that it never runs out of it. Each restoration moves the
# surface a little, so their number must not depend on the time step: with one at every tenth step, the runout of the
# same collapse on the same cells was 1.5 % longer with steps of 4 ms than of 0.3 ms.
RESTORE_AFTER = 2.5
SWEEPS = 12  # of the restoration: enough for the distance to cross the band


@inner_jit(error_model="numpy")
def crossing(phi_0, phi_1, curvature, h):
    """Distance from node 0 to the zero of the parabola through phi_0, phi_1 (opposite signs) with that curvature."""
    linear = h * phi_0 / (phi_0 - phi_1)
    if abs(curvature) * h * h < 1e-10 * abs(phi_0 - phi_1):
        return linear
    # phi(s) = phi_0 + s (phi_1 - phi_0)/h - curvature/2 s (h - s); two Newton steps from the linear
    # root
    s = linear
    for _ in range(4):
        f = phi_0 + s * (phi_1 - phi_0) / h - 0.5 * curvature * s * (h - s)
        slope = (phi_1 - phi_0) / h - 0.5 * curvature * (h - 2.0 * s)
        if slope == 0.0:
            return linear
        s -= f / slope
    return s if 0.0 < s < h else linear


@inner_jit(error_model="numpy")
def outward_slope(here, there, curvature, old_here, old_there, old_curvature, h):
    """ENO2 difference from a node towards its neighbour; returns (slope outwards, distance used).

    If the surface lies between, by the sign of the old values, the stencil ends on it.
    """
    if old_here * old_there < 0.0:
        s = max(crossing(old_here, old_there, old_curvature, h), 1e-6 * h)
        return (0.0 - here) / s - 0.5 * s * old_curvature, s
    return (there - here) / h - 0.5 * h * curvature, h


@kernel_jit(error_model="numpy")
def slopes(a2, a1, here, b1, b2, old_a2, old_a1, old_here, old_b1, old_b2, h):
    """Slopes outwards to both neighbours of a grid line and the shorter distance; a before, b beyond the node.

    Returns
    -------
    back, ahead, distance : float
    """
    bend = (a1 - 2.0 * here + b1) / (h * h)
    bend_a = minmod(bend, (here - 2.0 * a1 + a2) / (h * h))
    bend_b = minmod(bend, (here - 2.0 * b1 + b2) / (h * h))
    old_bend_a = old_bend_b = 0.0
    if old_here * old_a1 < 0.0 or old_here * old_b1 < 0.0:
        old_bend = (old_a1 - 2.0 * old_here + old_b1) / (h * h)
        old_bend_a = minmod(old_bend, (old_here - 2.0 * old_a1 + old_a2) / (h * h))
        old_bend_b = minmod(old_bend, (old_here - 2.0 * old_b1 + old_b2) / (h * h))
    back, s_a = outward_slope(here, a1, bend_a, old_here, old_a1, old_bend_a, h)
    ahead, s_b = outward_slope(here, b1, bend_b, old_here, old_b1, old_bend_b, h)
    return back, ahead, min(s_a, s_b)


@inner_jit(error_model="numpy")
def pull_between(a2, a1, here, b1, b2, sign, h):
    """Slope towards the surface on a grid line that it does not cross beside the node; 0 if phi only falls.

    As `slopes`, but dividing only what `minmod` takes.
    """
    bend = a1 - 2.0 * here + b1
    back = (a1 - here) / h - 0.5 * h * (minmod(bend, here - 2.0 * a1 + a2) / (h * h))
    ahead = (b1 - here) / h - 0.5 * h * (minmod(bend, here - 2.0 * b1 + b2) / (h * h))
    return max(max(-sign * ahead, 0.0), max(-sign * back, 0.0))


@inner_jit(error_model="numpy")
def step_beside(new, old, a, b, sign, dx, dz):
    """Pseudo-time step times (|grad phi| - 1) at any node; the surface may lie between it and a neighbour."""
    left, right, s_x = slopes(
        new[a - 2, b],
        new[a - 1, b],
        new[a, b],
        new[a + 1, b],
        new[a + 2, b],
        old[a - 2, b],
        old[a - 1, b],
        old[a, b],
        old[a + 1, b],
        old[a + 2, b],
        dx,
    )
    down, up, s_z = slopes(
        new[a, b - 2],
        new[a, b - 1],
        new[a, b],
        new[a, b + 1],
        new[a, b + 2],
        old[a, b - 2],
        old[a, b - 1],
        old[a, b],
        old[a, b + 1],
        old[a, b + 2],
        dz,
    )
    # Godunov: away from the surface |phi| grows, so only directions towards it count
    gx = max(max(-sign * right, 0.0), max(-sign * left, 0.0))
    gz = max(max(-sign * up, 0.0), max(-sign * down, 0.0))
    return 0.45 * min(s_x, s_z) * (math.sqrt(gx * gx + gz * gz) - 1.0)


@inner_jit()
def mark_sides(side, old, limit):
    """Side (1 outside, -1 inside) of the nodes with |phi| <= limit, doubled beside the surface; else 0."""
    for a in range(3, old.shape[0] - 3):
        for b in range(3, old.shape[1] - 3):
            here = old[a, b]
            side[a, b] = 0
            if here == 0.0 or abs(here) > limit:
                continue
            crossed = min(
                min(here * old[a - 1, b], here * old[a + 1, b]),
                min(here * old[a, b - 1], here * old[a, b + 1]),
            )
            side[a, b] = (2 if crossed < 0.0 else 1) * (1 if here > 0.0 else -1)


@inner_jit(error_model="numpy")
def restore_once(new, old, side, forwards, upwards, dx, dz):
    """One Gauss-Seidel sweep, diagonal by diagonal.

    The nodes of a diagonal do not see each other, so the order is as good as column by column, and
    the processor need not wait for one before it starts the next.
    """
    nx, nz = old.shape[0] - 6, old.shape[1] - 6
    for diagonal in range(nx + nz - 1):
        for kk in range(max(diagonal - nx + 1, 0), min(diagonal + 1, nz)):
            ii = diagonal - kk
            a = 3 + (ii if forwards else nx - 1 - ii)
            b = 3 + (kk if upwards else nz - 1 - kk)
            if side[a, b] == 0:
                continue
            sign = 1.0 if side[a, b] > 0 else -1.0
            if abs(side[a, b]) == 1:
                gx = pull_between(
                    new[a - 2, b], new[a - 1, b], new[a, b], new[a + 1, b], new[a + 2, b], sign, dx
                )
                gz = pull_between(
                    new[a, b - 2], new[a, b - 1], new[a, b], new[a, b + 1], new[a, b + 2], sign, dz
                )
                step = 0.45 * min(dx, dz) * (math.sqrt(gx * gx + gz * gz) - 1.0)
            else:
                step = step_beside(new, old, a, b, sign, dx, dz)
            new[a, b] -= sign * step
            if new[a, b] * sign <= 0.0:
                new[a, b] = sign * 1e-14


@kernel_jit()
def reinitialise(phi, sweeps, dx, dz):
    """Make phi (in place) the signed distance to its own zero line, within the band.

    Parameters
    ----------
    phi : (nx + 1, nz + 1) array
        Level set, m.
    sweeps : int
        Gauss-Seidel sweeps, of alternating direction.
    """
    nx, nz = phi.shape
    old = np.empty((nx + 6, nz + 6))
    padded(old, phi)
    new = old.copy()
    side = np.empty(old.shape, np.int8)
    h = max(dx, dz)
    # the clamp below, shifted by the volume corrections since, must not leave nodes out
    mark_sides(side, old, BAND * h + 4.0 * h)
    for sweep in range(sweeps):
        restore_once(new, old, side, sweep % 2 == 0, sweep % 4 < 2, dx, dz)
        continue_beyond(new)
    limit = BAND * h + 2.0 * h
    for i in range(nx):
        for k in range(nz):
            phi[i, k] = min(max(new[i + 3, k + 3], -limit), limit)
    close_bed(phi)
