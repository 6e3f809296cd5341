"""The free surface: phi_t + u . grad phi = 0 at the nodes, and phi kept a signed distance.

Advection: WENO5 in space, TVD-RK3 in time, in a band around the surface. Restoring the distance:
|grad phi| = 1 by Gauss-Seidel with second-order ENO differences whose stencil ends at the surface
itself, located to sub-cell accuracy by quadratic interpolation (Russo & Smereka 2000; Min & Gibou
2007). The velocity of the surface is first-order accurate, so the volume drifts;
`correct_volume` removes the drift where the surface moves. The walls and the bed are no surface:
phi continues straight through them.
"""

import math

import numpy as np

from .arrays import larger
from .compiled import inner_jit, kernel_jit
from .geometry import cell_moments
from .stencils import cubic, derivative_weno5, minmod

RESTORE_AFTER = (
    2.5  # cells travelled by the fastest point; half the band, so that it never runs out of it
)
RESTORE_EVERY = (
    10  # steps, once a tenth of that way is travelled: shear distorts phi even in a slow flow
)
SWEEPS = 12  # of the restoration: enough for the distance to cross the band
BAND = 5.0  # half width of the computed band in cells: WENO5 needs three, the restoration one more
SHIFT_MOST, LAST_SHIFT = (
    0.1,
    0.5,
)  # cells by which a volume correction moves the surface: the first, the second one
MOVING = 0.01  # of the largest speed: where the swift surface alone cannot give the volume back, all that moves does
RAMP = 0.01  # by which the second shift falls off from the back wall to the end of the domain
VOLUME_TOLERANCE = 1.0e-12  # of the volume, at which a correction ends
SECANT_TRIALS = 8  # of the search for that shift: four on average. Bisection follows, where a corner of the surface
SHIFT_TRIALS = 60  # is a node: half a cell then comes or goes within a ten-thousandth of a cell


def needs_restoring(travel, steps):
    """Whether the signed distance is due, after `travel` cells of the fastest point in `steps` steps."""
    return travel >= RESTORE_AFTER or (steps >= RESTORE_EVERY and travel >= 0.1 * RESTORE_AFTER)


@inner_jit()
def _mean_of_four(a, b, c, d):
    """Fourth-order value half way between b and c."""
    return (9.0 * (b + c) - a - d) / 16.0


@kernel_jit()
def node_velocity(u_node, w_node, u, w):
    """Velocity at the nodes, m/s, from the faces: fourth order, second beside the edges of the grid.

    Bed nodes are extrapolated, so that the mean of the two nodes of the first cell is that cell's
    own velocity: otherwise a film thinner than a cell would gain or lose volume.
    """
    nx, nz = w.shape[0], u.shape[1]
    for i in range(nx + 1):
        for k in range(nz + 1):
            if k == 0:
                u_node[i, k] = 1.5 * u[i, 0] - 0.5 * u[i, 1]
            elif 2 <= k <= nz - 2:
                u_node[i, k] = _mean_of_four(u[i, k - 2], u[i, k - 1], u[i, k], u[i, k + 1])
            else:
                u_node[i, k] = 0.5 * (u[i, k - 1] + u[i, min(k, nz - 1)])
            if 2 <= i <= nx - 2:
                w_node[i, k] = _mean_of_four(w[i - 2, k], w[i - 1, k], w[i, k], w[i + 1, k])
            else:
                w_node[i, k] = 0.5 * (w[max(i - 1, 0), k] + w[min(i, nx - 1), k])


@kernel_jit()
def node_speed(speed, u_node, w_node):
    """Speed at the nodes, m/s; return the largest."""
    fastest = 0.0
    for i in range(speed.shape[0]):
        for k in range(speed.shape[1]):
            u, w = u_node[i, k], w_node[i, k]
            speed[i, k] = math.hypot(u, w) if u != 0.0 or w != 0.0 else 0.0  # far off all is zero
            fastest = larger(fastest, speed[i, k])
    return fastest


@inner_jit()
def _between(field, x, z):
    """Value at (x, z), in node spacings: bicubic (Catmull-Rom), bilinear beside the edges of the grid."""
    i, k = int(x), int(z)
    p, q = x - i, z - k
    nx, nz = field.shape
    if 1 <= i <= nx - 3 and 1 <= k <= nz - 3:
        return cubic(
            cubic(
                field[i - 1, k - 1], field[i - 1, k], field[i - 1, k + 1], field[i - 1, k + 2], q
            ),
            cubic(field[i, k - 1], field[i, k], field[i, k + 1], field[i, k + 2], q),
            cubic(
                field[i + 1, k - 1], field[i + 1, k], field[i + 1, k + 1], field[i + 1, k + 2], q
            ),
            cubic(
                field[i + 2, k - 1], field[i + 2, k], field[i + 2, k + 1], field[i + 2, k + 2], q
            ),
            p,
        )
    low = (1.0 - q) * field[i, k] + q * field[i, k + 1]
    return (1.0 - p) * low + p * ((1.0 - q) * field[i + 1, k] + q * field[i + 1, k + 1])


@kernel_jit(error_model="numpy")
def carry_from_surface(u_out, w_out, u_node, w_node, phi, band, dx, dz):
    """Give every node of the band the velocity of its nearest surface point x - phi n.

    The surface moves as before to first order, but phi stays a distance much longer, since its contours no longer
    shear against each other.
    """
    nx, nz = phi.shape
    for i in range(nx):
        for k in range(nz):
            u_out[i, k], w_out[i, k] = u_node[i, k], w_node[i, k]
            if abs(phi[i, k]) > band:
                continue
            left, right = max(i - 1, 0), min(i + 1, nx - 1)
            low, high = max(k - 1, 0), min(k + 1, nz - 1)
            gx = (phi[right, k] - phi[left, k]) / ((right - left) * dx)
            gz = (phi[i, high] - phi[i, low]) / ((high - low) * dz)
            size = math.sqrt(gx * gx + gz * gz)
            if abs(size - 1.0) > 0.05:  # at a kink the nearest point is not where phi n leads
                continue
            x = min(max(i - phi[i, k] * gx / size / dx, 0.0), nx - 1.000001)
            z = min(max(k - phi[i, k] * gz / size / dz, 0.0), nz - 1.000001)
            u_out[i, k], w_out[i, k] = _between(u_node, x, z), _between(w_node, x, z)


@inner_jit()
def close_bed(phi):
    """Wet the bed under every wet node of the first row.

    A front whose foot is held back by the bed rolls over; left to itself the level set would
    enclose a film of air there, thinner than a cell, because no velocity normal to the bed can ever
    close it.
    """
    for i in range(phi.shape[0]):
        phi[i, 0] = min(phi[i, 0], phi[i, 1])


@inner_jit()
def padded(extended, phi):
    """Copy phi with three ghost layers, continued linearly."""
    nx, nz = phi.shape
    for i in range(nx):
        for k in range(nz):
            extended[i + 3, k + 3] = phi[i, k]
    continue_beyond(extended)


@inner_jit()
def continue_beyond(extended):
    """Fill the three ghost layers around a field linearly."""
    nx, nz = extended.shape[0] - 6, extended.shape[1] - 6
    for m in range(1, 4):
        for k in range(3, nz + 3):
            extended[3 - m, k] = (m + 1) * extended[3, k] - m * extended[4, k]
            extended[nx + 2 + m, k] = (m + 1) * extended[nx + 2, k] - m * extended[nx + 1, k]
    for m in range(1, 4):
        for i in range(nx + 6):
            extended[i, 3 - m] = (m + 1) * extended[i, 3] - m * extended[i, 4]
            extended[i, nz + 2 + m] = (m + 1) * extended[i, nz + 2] - m * extended[i, nz + 1]


@inner_jit(error_model="numpy")
def advection_rate(rate, extended, u_node, w_node, band, dx, dz):
    """Rate = -u . grad phi by WENO5 at the nodes with |phi| < band; zero elsewhere."""
    nx, nz = rate.shape
    for i in range(nx):
        for k in range(nz):
            rate[i, k] = 0.0
            a, b = i + 3, k + 3
            if abs(extended[a, b]) > band:
                continue
            u, w = u_node[i, k], w_node[i, k]
            if u > 0.0:
                rate[i, k] -= (
                    u
                    / dx
                    * derivative_weno5(
                        extended[a - 2, b] - extended[a - 3, b],
                        extended[a - 1, b] - extended[a - 2, b],
                        extended[a, b] - extended[a - 1, b],
                        extended[a + 1, b] - extended[a, b],
                        extended[a + 2, b] - extended[a + 1, b],
                    )
                )
            elif u < 0.0:
                rate[i, k] -= (
                    u
                    / dx
                    * derivative_weno5(
                        extended[a + 3, b] - extended[a + 2, b],
                        extended[a + 2, b] - extended[a + 1, b],
                        extended[a + 1, b] - extended[a, b],
                        extended[a, b] - extended[a - 1, b],
                        extended[a - 1, b] - extended[a - 2, b],
                    )
                )
            if w > 0.0:
                rate[i, k] -= (
                    w
                    / dz
                    * derivative_weno5(
                        extended[a, b - 2] - extended[a, b - 3],
                        extended[a, b - 1] - extended[a, b - 2],
                        extended[a, b] - extended[a, b - 1],
                        extended[a, b + 1] - extended[a, b],
                        extended[a, b + 2] - extended[a, b + 1],
                    )
                )
            elif w < 0.0:
                rate[i, k] -= (
                    w
                    / dz
                    * derivative_weno5(
                        extended[a, b + 3] - extended[a, b + 2],
                        extended[a, b + 2] - extended[a, b + 1],
                        extended[a, b + 1] - extended[a, b],
                        extended[a, b] - extended[a, b - 1],
                        extended[a, b - 1] - extended[a, b - 2],
                    )
                )


@kernel_jit()
def advect(phi, u_node, w_node, dt, dx, dz):
    """Advance phi (in place) by dt with the frozen node velocity, TVD-RK3."""
    nx, nz = phi.shape
    extended = np.empty((nx + 6, nz + 6))
    rate = np.empty((nx, nz))
    old = phi.copy()
    band = BAND * max(dx, dz)
    for stage in range(3):
        padded(extended, phi)
        advection_rate(rate, extended, u_node, w_node, band, dx, dz)
        keep = (0.0, 0.75, 1.0 / 3.0)[stage]
        for i in range(nx):
            for k in range(nz):
                phi[i, k] = keep * old[i, k] + (1.0 - keep) * (phi[i, k] + dt * rate[i, k])
    close_bed(phi)


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
    fastest = speed.max()
    if fastest == 0.0:
        return 0.0
    moved = phi.copy()
    shift = SHIFT_MOST * h
    added, missing = correct_volume(phi, aperture, speed / fastest, packing, target, shift)
    if abs(missing) > VOLUME_TOLERANCE * target:
        phi[:] = moved
        mobility = np.minimum(speed / (MOVING * fastest), 1.0)
        mobility *= np.linspace(1.0, 1.0 - RAMP, phi.shape[0])[:, None]
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
