"""Velocity and pressure of one step in turn: rotational incremental projection, the reference.

    predictor    (rho M/dt + Visc + B^T W B + friction) u~ = rho M u*/dt + rho g M + B^T P
    projection   B (dt/(rho M)) B^T q = -B u~,   u = u~ + (dt/(rho M)) B^T q,   so that B u = 0
    correction   P <- P + q - W B u~,   W = chi V eta

with B = div on the faces, P = filled fraction * pressure and Visc the deviatoric part of div(2 eta
D). All three lines are repeated in every nonlinear sweep (coefficients and P refreshed), so that
neither a lagged yield stress nor a splitting error is left when the sweeps have converged. The
predictor keeps the isotropic part W B u~ of the viscous stress; it vanishes with B u = 0. Without
it the correction is unstable beside the stress-free surface, where Visc lets a dilation pass at no
cost: with L = B (dt/(rho M)) B^T and T = B (rho M/dt + Visc + friction)^-1 B^T <= L a sweep
multiplies the error of P by 1 - (1/L + W)/(1/T + W), which lies in [0, 1) for any W >= 0 and any
jump of eta; so no minimum over neighbours is needed. A larger chi converges faster (chi -> inf is
the coupled method).

The multiplier lives in the wet cells, thus q = 0 in the empty ones, and the face masses put p = 0
on the surface. Bilateral only: p < 0 may occur; every friction takes its positive part. Sparse
factorisations from scipy, not tuned for speed. Sources: Timmermans, Minev & van de Vosse (1996) and
Guermond & Shen (2004) for the rotational form.
"""

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from .assembly import add_diagonal
from .banded import allocate_system
from .coefficients import coefficients
from .coupled import Outcome, take_solution
from .geometry import MASS_FLOOR, WET, repeat_columns
from .lanes import LANES
from .residual import momentum_residual
from .rheology import with_shear_rate_min
from .viscous import add_cells, add_nodes

CHI = 4.0  # W / (V eta); 1, 2, 4, 10 and 50 were compared: the same flow, 4 and above with no capped step


def factorised(matrix):
    """Sparse factors of a symmetric positive definite matrix, ordered by minimum degree."""
    return splu(
        csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def symmetric_from_band(band):
    """Sparse matrix of a lower band, band[c, r - c] = A[r, c]."""
    column, offset = np.nonzero(band)
    row, value, below = column + offset, band[column, offset], offset > 0
    return csc_array(
        (
            np.concatenate([value, value[below]]),
            (np.concatenate([row, column[below]]), np.concatenate([column, row[below]])),
        ),
        shape=(len(band), len(band)),
    )


def divergence_matrix(geometry, n, dx, dz):
    """B (wet cells, n faces) in 1/m, and the mask (nx, nz) of its cells; each cell of a periodic stretch once."""
    wet = geometry.filled > WET
    wet[: geometry.first] = wet[geometry.last :] = False
    sides = (
        (geometry.index_u[:-1], -geometry.aperture[:-1] / dx),
        (geometry.index_u[1:], geometry.aperture[1:] / dx),
        (geometry.index_w[:, :-1], np.full(wet.shape, -1.0 / dz)),
        (geometry.index_w[:, 1:], np.full(wet.shape, 1.0 / dz)),
    )
    face = np.concatenate([index[wet] for index, _ in sides])
    value = np.concatenate([weight[wet] for _, weight in sides])
    cell = np.tile(np.arange(wet.sum()), len(sides))
    known = face >= 0
    return coo_array((value[known], (cell[known], face[known])), shape=(wet.sum(), n)).tocsr(), wet


def face_inertia(geometry, balance, n):
    """Inertia rho M/dt of the n faces, kg/m3/s, with the floor of the coupled method."""
    mass = np.empty(n)
    for index, fraction in (
        (geometry.index_u, geometry.mass_x),
        (geometry.index_w, geometry.mass_z),
    ):
        mass[index[index >= 0]] = np.maximum(fraction, MASS_FLOOR)[index >= 0]
    return balance.density / balance.dt * mass


def assemble_momentum(work, band, rhs, u_star, w_star, geometry, balance, dx, dz):
    """Sparse rho M/dt + Visc + friction; its right-hand side without the pressure goes to `rhs`."""
    band[:] = 0.0
    add_diagonal(band, rhs, work, u_star, w_star, geometry, balance, dx, dz)
    none = np.zeros_like(work.weight_centre)
    add_cells(band, work.weight_centre, work.constrained, none, geometry, dx, dz)
    add_nodes(band, work.weight_node, geometry, dx, dz)
    return symmetric_from_band(band[: rhs.size - LANES])


def solve(state, work, ends, u_star, w_star, geometry, material, balance, dx, dz):
    """Advance velocity and pressure of `state` from the predictor (u*, w*); return an `Outcome`.

    Parameters
    ----------
    state : Fields
        In: first guess, pressure of the last step; out: solution on the unknown faces and in the
        wet cells.
    work : Work
        Scratch of the coupled method.
    ends : (n,) int64 array
        Envelope of the matrix, from `number_unknowns`.
    u_star, w_star : arrays
        Velocity after advection.
    geometry : Geometry
    material : Material
    balance : Balance
        Its `unilateral` and `penalty` do not act here.
    """
    n = ends.size
    u, w, pressure = state.u, state.w, state.pressure_filled
    div, wet = divergence_matrix(geometry, n, dx, dz)
    inertia = face_inertia(geometry, balance, n)
    poisson = factorised(div @ div.multiply(1.0 / inertia).T)
    band, rhs = allocate_system(ends)
    pressure[geometry.filled <= WET] = 0.0
    work.constrained[:] = geometry.filled > WET
    for sweep in range(balance.max_sweeps):
        rate = max(material.shear_rate_min, balance.rate_start * 0.1**sweep)
        coefficients(
            work,
            u,
            w,
            pressure,
            state.bed_slip,
            geometry,
            with_shear_rate_min(material, rate),
            balance,
            dx,
            dz,
            False,
        )
        momentum = assemble_momentum(work, band, rhs, u_star, w_star, geometry, balance, dx, dz)
        bulk = CHI * work.weight_centre[wet]
        velocity = factorised(momentum + div.T @ div.multiply(bulk[:, None])).solve(
            rhs[:n] + div.T @ pressure[wet]
        )
        div_predicted = div @ velocity
        increment = poisson.solve(-div_predicted)
        velocity += (div.T @ increment) / inertia
        pressure[wet] += increment - bulk * div_predicted
        if geometry.first > 0:
            repeat_columns(pressure, geometry.first, geometry.last)
        change, largest = take_solution(u, w, velocity, geometry, 0.0)
        change /= max(largest, balance.speed_scale)
        converged = sweep > 0 and rate <= material.shear_rate_min and change < balance.tolerance
        if converged or not change < 1.0e6:
            break
    work.multiplier[:] = pressure
    residual = momentum_residual(rhs, work, u, w, u_star, w_star, geometry, balance, dx, dz)
    divergence = np.abs(div @ velocity).max()
    settled = change < balance.tolerance
    return Outcome(sweep + 1, change, largest, divergence, residual, 0, settled)
