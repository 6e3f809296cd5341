"""Where the energy goes: the work of every resistance during one step, and what the discretisation takes.

The momentum balance of the step, multiplied by its own velocity u and dt, is an identity between the
gain of kinetic energy from u* to u, the work of gravity, the work against each resistance (not
negative) and the loss m (u - u*)^2 / 2 of the first-order time step. Two more losses lie outside it:
the kinetic energy that advection, and the continuation of the velocity beyond the surface, lose
between the end of the last solve and u*, and the potential energy by which the motion and
correction of the surface miss the work of gravity. These two may be gains. All in J/m, per unit
width.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .coupled import MASS_FLOOR


class Work(NamedTuple):
    """Work done against each resistance, J/m.

    bulk: viscous (frictional) stress inside the grains, the sheared half cell at a wall included;
    bed, back_wall: slip along them; lateral: the channel's side walls.
    """

    bulk: float
    bed: float
    back_wall: float
    lateral: float


class Loss(NamedTuple):
    """Energy lost to the discretisation, J/m; negative where it is gained."""

    time: float
    advection: float
    surface: float


class Outflow(NamedTuple):
    """Energy that left through an open end during the step, J/m."""

    kinetic: float
    potential: float


@njit(cache=True)
def viscous_work(weight_centre, weight_node, u, w, geometry, dx, dz):
    """Power of the viscous stress, summed over cells, Pa/s: eta times the squared deviatoric strain rate."""
    aperture = geometry.aperture
    power = 0.0
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if weight_centre[i, k] > 0.0:
                stretch = (aperture[i + 1, k] * u[i + 1, k] - aperture[i, k] * u[i, k]) / dx
                stretch -= (w[i, k + 1] - w[i, k]) / dz
                power += weight_centre[i, k] * stretch * stretch
            if weight_node[i, k] > 0.0:
                shear = (u[i, k] - u[i, k - 1]) / dz + (w[i, k] - w[i - 1, k]) / dx
                power += weight_node[i, k] * shear * shear
    return power


def work_of_step(scratch, state, geometry, impulse, balance, dx, dz):
    """Work of one step from the coefficients of its last nonlinear sweep.

    Parameters
    ----------
    scratch : coupled.Work
        Coefficients of viscosity and friction with which the velocity was solved.
    state : State
        Velocity after the solve, before it is continued beyond the surface.
    geometry : Geometry
    impulse : tuple of (nx + 1, nz), (nx, nz + 1) arrays, or None
        Change of velocity by the lateral walls before the solve (split form), m/s.
    balance : coupled.Balance
    dx, dz : float
        m.

    Returns
    -------
    Work
    """
    u, w, dt = state.u, state.w, balance.dt
    solved_u, solved_w = geometry.index_u >= 0, geometry.index_w >= 0
    solved_u[: geometry.first] = solved_w[: geometry.first] = False
    if geometry.first > 0:
        solved_u[geometry.last :] = solved_w[geometry.last :] = False
    bed_u, wall_w = np.where(solved_u[:, 0], u[:, 0], 0.0), np.where(solved_w[0], w[0], 0.0)
    bed = dx * np.sum(scratch.k_bed * bed_u * state.bed_slip)
    bed_shear = dx * np.sum(scratch.k_bed * bed_u**2) - bed
    wall = dz * np.sum(scratch.k_wall * np.abs(wall_w) * scratch.wall_slip)
    wall_shear = dz * np.sum(scratch.k_wall * wall_w**2) - wall
    volume = dx * dz
    bulk = volume * viscous_work(scratch.weight_centre, scratch.weight_node, u, w, geometry, dx, dz)
    lateral = volume * (
        np.sum(scratch.sink_x * u**2, where=solved_u)
        + np.sum(scratch.sink_z * w**2, where=solved_w)
    )
    if impulse is not None:
        inertia_x, inertia_z = (
            np.maximum(mass, MASS_FLOOR) * balance.density / dt
            for mass in (geometry.mass_x, geometry.mass_z)
        )
        lateral -= volume * np.sum(inertia_x * impulse[0] * u, where=solved_u)
        lateral -= volume * np.sum(inertia_z * impulse[1] * w, where=solved_w)
    return Work(dt * (bulk + bed_shear + wall_shear), dt * bed, dt * wall, dt * lateral)


def loss_of_step(
    energy_before, energy_after, outflow, state, u_star, w_star, geometry, balance, dx, dz
):
    """What the discretisation took during one step.

    Parameters
    ----------
    energy_before, energy_after : dict
        From `quantities.energies`, at both ends of the step.
    outflow : Outflow
    state : State
        Velocity after the solve.
    u_star, w_star : arrays
        Velocity after advection.
    geometry : Geometry
        At the end of the step.
    balance : coupled.Balance
    dx, dz : float
        m.

    Returns
    -------
    Loss
    """
    cell = balance.density * dx * dz
    faces = ((geometry.mass_x, state.u, u_star), (geometry.mass_z, state.w, w_star))
    time = 0.5 * cell * sum(np.sum(mass * (v - v_star) ** 2) for mass, v, v_star in faces)
    carried = 0.5 * cell * sum(np.sum(mass * v_star**2) for mass, _, v_star in faces)
    gravity = balance.gx * np.sum(geometry.mass_x * state.u)
    gravity += balance.gz * np.sum(geometry.mass_z * state.w)
    released = energy_before["potential"] - energy_after["potential"] - outflow.potential
    return Loss(
        time,
        energy_before["kinetic"] - outflow.kinetic - carried,
        released - cell * balance.dt * gravity,
    )
