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

from .arrays import larger
from .assembly import assemble
from .banded import factorise, solve_factorised
from .coefficients import answer_beforehand, coefficients
from .compiled import inner_jit, kernel_jit
from .geometry import WET, repeat_columns
from .grain_response import relax_late
from .residual import momentum_residual
from .rheology import with_shear_rate_min
from .sliding_bed import bed_force, linearise
from .viscous import divergence

FRICTION_TOLERANCE = 0.01  # change of the bed's friction between two sweeps
# Part of a full mass from which a face counts for convergence. u of a face with less than 0.05 is overwritten after the
# solve, and holds up most sweeps. At 0.05 a third of the sweeps goes, but the 10 mm runout on 12 mm cells moves by up
# to 0.5 %; at 0.02 a sixth, and nothing moves by more than 0.3 %.
LEAST_MASS = 0.02


class Outcome(NamedTuple):
    """What the sweeps report.

    `change` of the last sweep (to `speed`, the largest one, m/s, or the scale of slow grains) and `residual` of the
    momentum balance are relative; change and speed are those of the faces with a `least_mass`. `settled`: the
    velocity has converged to the tolerance and the friction of the bed to `FRICTION_TOLERANCE`.
    """

    sweeps: int
    change: float
    speed: float
    divergence: float
    residual: float
    info: int
    settled: bool


@kernel_jit()
def take_solution(u, w, solution, geometry, least_mass):
    """Write the solution to the faces; return (largest change, largest speed) of those with this mass, m/s.

    Parameters
    ----------
    least_mass : float
        Part of a full face mass.
    """
    nx = geometry.filled.shape[0]
    change = largest = 0.0
    for i in range(nx + 1):
        for k in range(geometry.reach[i]):
            n = geometry.index_u[i, k]
            if n >= 0:
                if geometry.mass_x[i, k] >= least_mass:
                    change = larger(change, abs(solution[n] - u[i, k]))
                    largest = larger(largest, abs(solution[n]))
                u[i, k] = solution[n]
    for i in range(nx):
        for k in range(geometry.reach[i]):
            n = geometry.index_w[i, k]
            if n >= 0:
                if geometry.mass_z[i, k] >= least_mass:
                    change = larger(change, abs(solution[n] - w[i, k]))
                    largest = larger(largest, abs(solution[n]))
                w[i, k] = solution[n]
    return change, largest


@inner_jit()
def least_mass(response):
    """Part of a full mass from which a face counts for convergence.

    Where the grains dilate every face counts: their source follows the pressure, which must settle for the budget of
    the energy to close.
    """
    if response is None:
        return LEAST_MASS
    return 0.0 if response.dilatancy.factor > 0.0 else LEAST_MASS


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
        coefficients(
            work, u, w, pressure_filled, bed_slip, geometry, softened, balance, dx, dz, sweep > 0
        )
        previous = friction
        friction = bed_force(work, u, geometry)
        linearise(work, bed_slip, u, geometry, balance.speed_scale)
        assemble(band, rhs, work, pressure_filled, u_star, w_star, geometry, balance, dx, dz)
        info = factorise(band, ends)
        if info != 0:
            break
        solve_factorised(rhs, band, ends)
        slide_along(balance.response, bed_slip, rhs, u, geometry)
        change, largest = take_solution(u, w, rhs, geometry, least_mass(balance.response))
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
