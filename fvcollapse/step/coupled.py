"""Velocity and pressure of one step together: nonlinear sweeps over one banded Cholesky solve each.

    rho (u - u*)/dt + grad p - div(2 eta D) + friction = rho g,
    0 <= p  perpendicular to  div u - s >= 0,   s = 0 unless the grains dilate (`dilatancy`)

Each sweep freezes viscosity, wall friction and the set of cells in compression, and solves
(A + r B^T B) u = f + B^T (P + r s) for all active faces at once, then updates the multiplier
P -= r (B u - s) (augmented Lagrangian, B = div). With a direct factorisation r may be far above any
viscosity, so P is nearly exact after one sweep and no splitting error exists: a static state is
static for any time step. A cell whose P turns negative is released (P = 0, free to open) and taken
up again with P = 0 when it is being compressed; in the bilateral form every wet cell stays.
"""

import math
from typing import NamedTuple

import numpy as np

from .arrays import larger
from .banded import clear, factorise, solve_factorised
from .compiled import inner_jit, kernel_jit
from .coulomb_walls import back_wall_friction, bed_friction
from .gate import gate_friction
from .geometry import MASS_FLOOR, WET, last_face, repeat_columns
from .grain_response import (
    ResponseWork,
    add_extra_friction,
    add_source,
    allocate_response,
    relax_late,
    respond,
)
from .lateral_friction import face_pressures, sink_coefficients
from .rheology import with_shear_rate_min
from .strain import strain_rates
from .viscous import add_cells, add_nodes, divergence, viscosity_weights

FRICTION_TOLERANCE = 0.01  # change of the bed's friction between two sweeps


class Work(NamedTuple):
    """Scratch arrays of the sweeps on one grid shape."""

    e_centre: np.ndarray
    g_node: np.ndarray
    weight_centre: np.ndarray
    weight_node: np.ndarray
    k_bed: np.ndarray
    k_wall: np.ndarray
    wall_slip: np.ndarray
    k_gate: np.ndarray
    gate_slip: np.ndarray
    pressure_x: np.ndarray
    pressure_z: np.ndarray
    sink_x: np.ndarray
    sink_z: np.ndarray
    constrained: np.ndarray
    multiplier: np.ndarray
    response: ResponseWork


class Outcome(NamedTuple):
    """What the sweeps report.

    `change` of the last sweep (to `speed`, the largest one, m/s, or the scale of slow grains) and `residual` of the
    momentum balance are relative; `settled`: the
    velocity has converged to the tolerance and the friction of the bed to `FRICTION_TOLERANCE`.
    """

    sweeps: int
    change: float
    speed: float
    divergence: float
    residual: float
    info: int
    settled: bool


def allocate_work(nx, nz):
    """Scratch arrays for an nx by nz grid."""
    return Work(
        np.zeros((nx, nz)),
        np.zeros((nx + 1, nz + 1)),
        np.zeros((nx, nz)),
        np.zeros((nx + 1, nz + 1)),
        np.zeros(nx + 1),
        np.zeros(nz + 1),
        np.zeros(nz + 1),
        np.zeros(nz + 1),
        np.zeros(nz + 1),
        np.zeros((nx + 1, nz)),
        np.zeros((nx, nz + 1)),
        np.zeros((nx + 1, nz)),
        np.zeros((nx, nz + 1)),
        np.zeros((nx, nz), np.bool_),
        np.zeros((nx, nz)),
        allocate_response(nx, nz),
    )


@inner_jit()
def answer(response, work, pressure_filled, geometry, material, balance, dx, dz):
    """What the effects make of the strain rates in `work`; nothing is compiled where `response` is None."""
    if response is not None:
        respond(
            work.response,
            work.e_centre,
            work.g_node,
            pressure_filled,
            geometry,
            material,
            response,
            balance.penalty,
            balance.dt,
            dx,
            dz,
        )


@inner_jit()
def answer_beforehand(
    response, work, u, w, pressure_filled, bed_slip, geometry, material, balance, dx, dz
):
    """The source of dilating grains before the first sweep: it says which cells are being compressed."""
    if response is None:
        return
    if response.dilatancy.factor > 0.0:
        strain_rates(work.e_centre, work.g_node, u, w, bed_slip, geometry, dx, dz)
        relax_late(work.response, 0)
        answer(response, work, pressure_filled, geometry, material, balance, dx, dz)


@kernel_jit()
def coefficients(work, u, w, pressure_filled, bed_slip, geometry, material, balance, dx, dz):
    """Viscosity and friction coefficients of the current velocity and pressure, into `work` and `bed_slip`."""
    strain_rates(work.e_centre, work.g_node, u, w, bed_slip, geometry, dx, dz)
    answer(balance.response, work, pressure_filled, geometry, material, balance, dx, dz)
    viscosity_weights(
        work.weight_centre,
        work.weight_node,
        work.e_centre,
        work.g_node,
        pressure_filled,
        geometry,
        material,
    )
    add_extra_friction(
        balance.response,
        work.weight_centre,
        work.weight_node,
        work.response.extra_friction,
        work.e_centre,
        work.g_node,
        pressure_filled,
        geometry,
        material,
    )
    bed_friction(
        work.k_bed,
        bed_slip,
        u,
        pressure_filled,
        work.weight_centre,
        work.e_centre,
        work.response.extra_friction,
        geometry,
        material,
        balance.gz,
        balance.density,
        balance.mu_bed,
        dz,
    )
    back_wall_friction(
        work.k_wall,
        work.wall_slip,
        w,
        pressure_filled,
        work.weight_centre,
        work.e_centre,
        work.response.extra_friction,
        geometry,
        material,
        balance.gx,
        balance.density,
        balance.mu_back_wall,
        dx,
    )
    if balance.mu_gate > 0.0:
        gate_friction(
            work.k_gate,
            work.gate_slip,
            w,
            pressure_filled,
            work.weight_centre,
            work.e_centre,
            work.response.extra_friction,
            geometry,
            material,
            balance,
            dx,
        )
    if balance.wall_strength > 0.0:
        face_pressures(
            work.pressure_x,
            work.pressure_z,
            pressure_filled,
            geometry,
            balance.wall_deep_ratio,
            balance.wall_weakening_depth,
            dz,
        )
        sink_coefficients(
            work.sink_x,
            work.sink_z,
            u,
            w,
            work.pressure_x,
            work.pressure_z,
            geometry,
            balance.wall_strength,
            balance.slip_min,
        )
    else:
        work.sink_x[:] = 0.0
        work.sink_z[:] = 0.0


@kernel_jit()
def add_diagonal(band, rhs, work, u_star, w_star, geometry, balance, dx, dz):
    """Inertia, weight and wall frictions: the diagonal of the band and the right-hand side."""
    inertia = balance.density / balance.dt
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            n = geometry.index_u[i, k]
            if n >= 0:
                mass = geometry.mass_x[i, k]
                m = inertia * max(mass, MASS_FLOOR)
                band[n, 0] += m + work.sink_x[i, k]
                if k == 0:
                    band[n, 0] += work.k_bed[i] / dz
                rhs[n] = m * u_star[i, k] + balance.density * balance.gx * mass
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            n = geometry.index_w[i, k]
            if n >= 0:
                mass = geometry.mass_z[i, k]
                m = inertia * max(mass, MASS_FLOOR)
                band[n, 0] += m + work.sink_z[i, k]
                if i == 0:
                    band[n, 0] += work.k_wall[k] / dx
                rhs[n] = m * w_star[i, k] + balance.density * balance.gz * mass
                if i == balance.gate_column - 1:
                    band[n, 0] += work.k_gate[k] / dx
                    rhs[n] += work.k_gate[k] / dx * balance.gate_speed


@inner_jit()
def add_pressure_force(rhs, pressure_filled, geometry, dx, dz):
    """Rhs += B^T P: minus the discrete pressure gradient."""
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            p = pressure_filled[i, k]
            if p != 0.0:
                if iu[i, k] >= 0:
                    rhs[iu[i, k]] -= p * aperture[i, k] / dx
                if iu[i + 1, k] >= 0:
                    rhs[iu[i + 1, k]] += p * aperture[i + 1, k] / dx
                if iw[i, k] >= 0:
                    rhs[iw[i, k]] -= p / dz
                if iw[i, k + 1] >= 0:
                    rhs[iw[i, k + 1]] += p / dz


@kernel_jit()
def assemble(band, rhs, ends, work, pressure_filled, u_star, w_star, geometry, balance, dx, dz):
    """Matrix and right-hand side of one sweep, from the coefficients in `work`; released cells lose their pressure."""
    clear(band, ends)
    add_diagonal(band, rhs, work, u_star, w_star, geometry, balance, dx, dz)
    add_cells(band, work.weight_centre, work.constrained, work.response.penalty, geometry, dx, dz)
    add_nodes(band, work.weight_node, geometry, dx, dz)
    for i in range(work.constrained.shape[0]):
        for k in range(work.constrained.shape[1]):
            if not work.constrained[i, k]:
                pressure_filled[i, k] = 0.0
    add_pressure_force(rhs, pressure_filled, geometry, dx, dz)
    add_source(balance.response, rhs, work.response, work.constrained, geometry, dx, dz)


@kernel_jit()
def take_solution(u, w, solution, geometry):
    """Write the solution to the faces; return (largest change, largest speed), m/s."""
    nx = geometry.filled.shape[0]
    change = largest = 0.0
    for i in range(nx + 1):
        for k in range(geometry.reach[i]):
            n = geometry.index_u[i, k]
            if n >= 0:
                change = larger(change, abs(solution[n] - u[i, k]))
                largest = larger(largest, abs(solution[n]))
                u[i, k] = solution[n]
    for i in range(nx):
        for k in range(geometry.reach[i]):
            n = geometry.index_w[i, k]
            if n >= 0:
                change = larger(change, abs(solution[n] - w[i, k]))
                largest = larger(largest, abs(solution[n]))
                w[i, k] = solution[n]
    return change, largest


@inner_jit()
def start_constraints(constrained, source, u, w, pressure_filled, geometry, unilateral, dx, dz):
    """Cells in which div u = s is imposed first: all wet ones, or those under pressure or being compressed."""
    nx, nz = constrained.shape
    for i in range(nx):
        for k in range(nz):
            wet = geometry.filled[i, k] > WET
            if not wet:
                pressure_filled[i, k] = 0.0
            constrained[i, k] = wet and (
                not unilateral
                or pressure_filled[i, k] > 0.0
                or divergence(u, w, geometry.aperture, i, k, dx, dz) <= source[i, k]
            )


@inner_jit()
def update_multiplier(pressure_filled, work, u, w, geometry, balance, may_release, dx, dz):
    """P -= r (div u - s) where constrained, then release and take up cells; return the largest |div u - s|."""
    largest = 0.0
    multiplier, constrained = work.multiplier, work.constrained
    source, penalty = work.response.source, work.response.penalty
    multiplier[:] = 0.0
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] <= WET:
                continue
            div = divergence(u, w, geometry.aperture, i, k, dx, dz) - source[i, k]
            if constrained[i, k]:
                p = pressure_filled[i, k] - penalty[i, k] * div
                multiplier[i, k] = p
                if balance.unilateral and p < 0.0:
                    p = 0.0
                    if may_release:
                        constrained[i, k] = False
                else:
                    largest = max(largest, abs(div))
                pressure_filled[i, k] = p
            elif div < 0.0:
                constrained[i, k] = True
    if geometry.first > 0:  # at the ends of the halo shear rates, and so sources, are incomplete
        repeat_columns(multiplier, geometry.first, geometry.last)
        repeat_columns(constrained, geometry.first, geometry.last)
        repeat_columns(pressure_filled, geometry.first, geometry.last)
    return largest


@kernel_jit()
def momentum_residual(residual, work, u, w, u_star, w_star, geometry, balance, dx, dz):
    """Largest residual of the momentum balance, relative to the weight; independent of the factorisation."""
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    residual[:] = 0.0
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            e = (
                4.0
                * work.weight_centre[i, k]
                * 0.5
                * (
                    (aperture[i + 1, k] * u[i + 1, k] - aperture[i, k] * u[i, k]) / dx
                    - (w[i, k + 1] - w[i, k]) / dz
                )
            )
            p = work.multiplier[i, k]
            _add(residual, iu[i, k], (-0.5 * e + p) * aperture[i, k] / dx)
            _add(residual, iu[i + 1, k], (0.5 * e - p) * aperture[i + 1, k] / dx)
            _add(residual, iw[i, k], (0.5 * e + p) / dz)
            _add(residual, iw[i, k + 1], (-0.5 * e - p) / dz)
            if work.weight_node[i, k] > 0.0:
                g = work.weight_node[i, k] * (
                    (u[i, k] - u[i, k - 1]) / dz + (w[i, k] - w[i - 1, k]) / dx
                )
                _add(residual, iu[i, k - 1], -g / dz)
                _add(residual, iu[i, k], g / dz)
                _add(residual, iw[i - 1, k], -g / dx)
                _add(residual, iw[i, k], g / dx)
    inertia = balance.density / balance.dt
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            if iu[i, k] >= 0:
                mass = geometry.mass_x[i, k]
                friction = work.sink_x[i, k] + (work.k_bed[i] / dz if k == 0 else 0.0)
                residual[iu[i, k]] += (
                    inertia * max(mass, MASS_FLOOR) * (u[i, k] - u_star[i, k])
                    + friction * u[i, k]
                    - balance.density * balance.gx * mass
                )
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if iw[i, k] >= 0:
                mass = geometry.mass_z[i, k]
                friction = work.sink_z[i, k] + (work.k_wall[k] / dx if i == 0 else 0.0)
                residual[iw[i, k]] += (
                    inertia * max(mass, MASS_FLOOR) * (w[i, k] - w_star[i, k])
                    + friction * w[i, k]
                    - balance.density * balance.gz * mass
                )
                if i == balance.gate_column - 1:
                    residual[iw[i, k]] += work.k_gate[k] / dx * (w[i, k] - balance.gate_speed)
    weight = balance.density * math.sqrt(balance.gx**2 + balance.gz**2)
    largest = 0.0
    for n in range(residual.size):
        largest = larger(largest, abs(residual[n]))
    return largest / weight if weight > 0.0 else largest


@inner_jit()
def _add(vector, n, value):
    if n >= 0:
        vector[n] += value


@inner_jit()
def slide_along(response, bed_slip, solution, u, geometry):
    """What a sweep changes in the velocity of a face that slides on the bed is slip, not shear of the grains.

    Without this the next sweep takes it for shear. Grains that dilate would answer with a source, that with
    a change of the pressure and of the friction on the bed, and the sweeps would never settle: a dense
    block on a slope gained 20 % too much speed.
    """
    if response is None:
        return
    if response.dilatancy.factor <= 0.0:
        return
    for i in range(bed_slip.size):
        n = geometry.index_u[i, 0]
        if n >= 0 and bed_slip[i] != 0.0:
            slip = bed_slip[i] + solution[n] - u[i, 0]
            bed_slip[i] = min(max(slip, min(solution[n], 0.0)), max(solution[n], 0.0))


@inner_jit()
def bed_force(work, u, geometry):
    """Sum of |traction| over the bed faces, Pa; the sweeps must settle it, not only the velocity."""
    total = 0.0
    for i in range(geometry.first, last_face(geometry)):
        if geometry.index_u[i, 0] >= 0:
            total += work.k_bed[i] * abs(u[i, 0])
    return total


@kernel_jit()
def solve(
    u,
    w,
    pressure_filled,
    bed_slip,
    work,
    band,
    rhs,
    ends,
    u_star,
    w_star,
    geometry,
    material,
    balance,
    dx,
    dz,
):
    """Advance (u, w, P) from the predictor (u*, w*) by nonlinear sweeps; return an `Outcome`.

    Parameters
    ----------
    u, w, pressure_filled, bed_slip : arrays
        In: first guess; out: solution on the unknown faces and wet cells.
    band, rhs : (n + LANES, …), (n + LANES,) arrays
        Scratch, from `allocate_system`.
    ends : (n,) int64 array
        Envelope of the matrix, from `number_unknowns`.
    u_star, w_star : arrays
        Velocity after advection.
    """
    answered = work.response
    answered.source[:] = 0.0
    answered.penalty[:] = balance.penalty
    answer_beforehand(
        balance.response,
        work,
        u,
        w,
        pressure_filled,
        bed_slip,
        geometry,
        material,
        balance,
        dx,
        dz,
    )
    start_constraints(
        work.constrained,
        answered.source,
        u,
        w,
        pressure_filled,
        geometry,
        balance.unilateral,
        dx,
        dz,
    )
    change = largest = residual = div_max = math.inf
    sweeps = info = 0
    settled = False
    friction = math.inf
    film = (
        0.1 * balance.density * abs(balance.gz) * dz * geometry.filled.shape[0]
    )  # a tenth of a cell on the bed
    for sweep in range(balance.max_sweeps):
        rate = max(material.shear_rate_min, balance.rate_start * 0.1**sweep)
        softened = with_shear_rate_min(material, rate)
        relax_late(answered, sweep)
        coefficients(work, u, w, pressure_filled, bed_slip, geometry, softened, balance, dx, dz)
        previous = friction
        friction = bed_force(work, u, geometry)
        assemble(band, rhs, ends, work, pressure_filled, u_star, w_star, geometry, balance, dx, dz)
        info = factorise(band, ends)
        if info != 0:
            break
        solve_factorised(rhs, band, ends)
        slide_along(balance.response, bed_slip, rhs, u, geometry)
        change, largest = take_solution(u, w, rhs, geometry)
        div_max = update_multiplier(
            pressure_filled,
            work,
            u,
            w,
            geometry,
            balance,
            sweep < balance.max_sweeps // 2,
            dx,
            dz,
        )
        sweeps = sweep + 1
        change /= max(largest, balance.speed_scale)
        if not change < 1.0e6:
            break
        settled = (
            rate <= material.shear_rate_min
            and change < balance.tolerance
            and abs(friction - previous) <= FRICTION_TOLERANCE * (friction + film)
        )
        if sweep > 0 and settled:
            break
    residual = momentum_residual(rhs, work, u, w, u_star, w_star, geometry, balance, dx, dz)
    return Outcome(sweeps, change, largest, div_max, residual, info, settled)
