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

from .compiled import inner_jit, kernel_jit
from .dilatancy import dilation_power
from .geometry import MASS_FLOOR, last_face


class Work(NamedTuple):
    """Work done against each resistance, J/m.

    bulk: viscous (frictional) stress inside the grains, the sheared half cell at a wall included,
    less what the grains do against the pressure in dilating, and against the forces of terms that act before
    the solve; bed, back_wall: slip along them;
    lateral: the channel's side walls; gate: friction along it less what its motion gives the
    grains, so it may be negative.
    """

    bulk: float
    bed: float
    back_wall: float
    lateral: float
    gate: float


class Loss(NamedTuple):
    """Energy lost to the discretisation, J/m; negative where it is gained."""

    time: float
    advection: float
    surface: float


class Outflow(NamedTuple):
    """Energy that left through an open end during the step, J/m."""

    kinetic: float
    potential: float


@kernel_jit()
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


@kernel_jit()
def friction_work(sink_x, sink_z, u, w, geometry):
    """Power of the lateral walls, summed over faces, Pa/s."""
    power = 0.0
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            if geometry.index_u[i, k] >= 0:
                power += sink_x[i, k] * u[i, k] * u[i, k]
            if i < geometry.last and geometry.index_w[i, k] >= 0:
                power += sink_z[i, k] * w[i, k] * w[i, k]
    return power


@kernel_jit()
def impulse_work(impulse, u, w, geometry, least_mass, inertia):
    """Power gained from a change of velocity `impulse` before the solve, summed over faces, Pa/s."""
    power = 0.0
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            if geometry.index_u[i, k] >= 0:
                power += max(geometry.mass_x[i, k], least_mass) * impulse[0][i, k] * u[i, k]
            if i < geometry.last and geometry.index_w[i, k] >= 0:
                power += max(geometry.mass_z[i, k], least_mass) * impulse[1][i, k] * w[i, k]
    return inertia * power


@kernel_jit()
def face_sums(mass, solved, start):
    """Sums over faces of mass (solved - start)^2, mass start^2 and mass solved."""
    change = carried = flow = 0.0
    for i in range(mass.shape[0]):
        for k in range(mass.shape[1]):
            m = mass[i, k]
            if m == 0.0:  # most cells are air
                continue
            change += m * (solved[i, k] - start[i, k]) ** 2
            carried += m * start[i, k] ** 2
            flow += m * solved[i, k]
    return change, carried, flow


@inner_jit()
def bed_work(k_bed, bed_drag, bed_slip, u, geometry):
    """Power of the friction of the bed over its slip, and over the velocity of the first faces, W/m2, summed."""
    slid = moved = 0.0
    for i in range(geometry.first, last_face(geometry)):
        if geometry.index_u[i, 0] >= 0:
            force = k_bed[i] * u[i, 0] + bed_drag[i]
            slid += force * bed_slip[i]
            moved += force * u[i, 0]
    return slid, moved


@inner_jit()
def wall_work(k_wall, wall_slip, w, geometry):
    """The same of the back wall, from slip speeds."""
    slid = moved = 0.0
    if geometry.first == 0:
        for k in range(geometry.reach[0]):
            if geometry.index_w[0, k] >= 0:
                force = k_wall[k] * abs(w[0, k])
                slid += force * wall_slip[k]
                moved += force * abs(w[0, k])
    return slid, moved


@kernel_jit()
def resisted_work(scratch, u, w, bed_slip, geometry, dx, dz):
    """`viscous_work`, `friction_work`, `bed_work` and `wall_work` of the coefficients of a solve."""
    return (
        viscous_work(scratch.weight_centre, scratch.weight_node, u, w, geometry, dx, dz),
        friction_work(scratch.sink_x, scratch.sink_z, u, w, geometry),
        bed_work(scratch.k_bed, scratch.bed_drag, bed_slip, u, geometry),
        wall_work(scratch.k_wall, scratch.wall_slip, w, geometry),
    )


def work_of_step(simulation, impulses, balance):
    """Work of one step from the coefficients of its last nonlinear sweep.

    Parameters
    ----------
    simulation : Simulation
        After the solve, before the velocity is continued beyond the surface.
    impulses : list of Impulse
        Changes of velocity before the solve.
    balance : Balance

    Returns
    -------
    Work
    """
    scratch, state, geometry = simulation.work, simulation.state, simulation.geometry
    dx, dz = simulation.spacing
    u, w, dt = state.u, state.w, balance.dt
    volume = dx * dz
    bulk, lateral, bed, wall = resisted_work(scratch, u, w, state.bed_slip, geometry, dx, dz)
    gate, gate_shear = gate_work(scratch, w, geometry, balance, dz)
    bulk *= volume
    if balance.response is not None and balance.response.dilatancy.factor > 0.0:
        bulk -= volume * dilation_power(scratch.response.source, state.pressure_filled, geometry)
    for impulse in impulses:
        change = impulse.u, impulse.w
        given = impulse_work(change, u, w, geometry, MASS_FLOOR, balance.density / dt)
        if impulse.lateral:
            lateral -= given
        else:
            bulk -= volume * given
    lateral *= volume
    bulk += dx * (bed[1] - bed[0]) + dz * (wall[1] - wall[0]) + gate_shear
    return Work(dt * bulk, dt * dx * bed[0], dt * dz * wall[0], dt * lateral, dt * gate)


def gate_work(scratch, w, geometry, balance, dz):
    """Power that the gate takes from the grains, and that of the shear in the half cell beside it, W/m."""
    column = balance.gate_column - 1
    if balance.mu_gate == 0.0 or column < 0:
        return 0.0, 0.0
    relative = np.where(geometry.index_w[column] >= 0, w[column] - balance.gate_speed, 0.0)
    slip = dz * np.sum(scratch.k_gate * np.abs(relative) * scratch.gate_slip)
    given = -dz * balance.gate_speed * np.sum(scratch.k_gate * relative)
    return slip - given, dz * np.sum(scratch.k_gate * relative**2) - slip


def loss_of_step(simulation, energy_after, u_star, w_star, balance):
    """What the discretisation took during one step.

    Parameters
    ----------
    simulation : Simulation
        After the solve; its `energy` is that before the step.
    energy_after : dict
        From `quantities.energies`, at the end of the step.
    u_star, w_star : arrays
        Velocity after advection.
    balance : Balance

    Returns
    -------
    Loss
    """
    state, geometry, (dx, dz) = simulation.state, simulation.geometry, simulation.spacing
    energy_before, outflow = simulation.energy, simulation.outflow
    cell = balance.density * dx * dz
    change_x, carried_x, flow_x = face_sums(geometry.mass_x, state.u, u_star)
    change_z, carried_z, flow_z = face_sums(geometry.mass_z, state.w, w_star)
    time = 0.5 * cell * (change_x + change_z)
    carried = 0.5 * cell * (carried_x + carried_z)
    gravity = balance.gx * flow_x + balance.gz * flow_z
    released = energy_before["potential"] - energy_after["potential"] - outflow.potential
    return Loss(
        time,
        energy_before["kinetic"] - outflow.kinetic - carried,
        released - cell * balance.dt * gravity,
    )
