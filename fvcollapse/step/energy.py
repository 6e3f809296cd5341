"""Where the energy goes: the work of every resistance during one step, and what the discretisation takes.

The momentum balance of the step, multiplied by its own velocity u and dt, is an identity between the gain of kinetic
energy from u* to u, the work of gravity, the work against each resistance (not negative) and the loss m (u - u*)^2 / 2
of the first-order time step. Two more losses lie outside it: the kinetic energy that advection, and the continuation of
the velocity beyond the surface, lose between the end of the last solve and u*, and the potential energy by which the
motion and correction of the surface miss the work of gravity. These two may be gains. All in J/m, per unit width.
"""

from typing import NamedTuple

from .compiled import inner_jit, kernel_jit
from .flow import (
    KINETIC,
    LOSS_ADVECTION,
    LOSS_SURFACE,
    LOSS_TIME,
    POTENTIAL,
    WORK_BACK_WALL,
    WORK_BED,
    WORK_BULK,
    WORK_GATE,
    WORK_LATERAL,
)
from .geometry import MASS_FLOOR, last_face
from .grain_response import work_of_grains
from .side_shear import side_power


class Work(NamedTuple):
    """Work done against each resistance, J/m.

    bulk: viscous (frictional) stress inside the grains, the sheared half cell at a wall included,
    less what the grains do against the pressure in dilating, plus what they pay for opening (`adhesion`), less
    the work of terms that act before
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


@inner_jit()
def impulse_work(change_u, change_w, u, w, geometry):
    """Mass times change of velocity times velocity after the solve, summed over faces; 0 without a change, (0, 0)."""
    power = 0.0
    if change_u.size == 0:
        return power
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            if geometry.index_u[i, k] >= 0:
                power += max(geometry.mass_x[i, k], MASS_FLOOR) * change_u[i, k] * u[i, k]
            if i < geometry.last and geometry.index_w[i, k] >= 0:
                power += max(geometry.mass_z[i, k], MASS_FLOOR) * change_w[i, k] * w[i, k]
    return power


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


@inner_jit()
def work_of_step(flow, impulse, balance):
    """`Work` of one step from the coefficients of its last nonlinear sweep.

    Parameters
    ----------
    flow : Flow
        After the solve, before the velocity is continued beyond the surface.
    impulse : Impulse
        Change of velocity before the solve.
    balance : Balance
    """
    scratch, fields, geometry = flow.work, flow.fields, flow.geometry
    dx, dz = flow.constants.dx, flow.constants.dz
    u, w, dt = fields.u, fields.w, balance.dt
    volume = dx * dz
    bulk, lateral, bed, wall = resisted_work(scratch, u, w, fields.bed_slip, geometry, dx, dz)
    gate, gate_shear = gate_work(scratch, w, geometry, balance, dz)
    bulk *= volume
    bulk -= volume * side_power(scratch.side, w, geometry)
    bulk -= volume * work_of_grains(balance.response, scratch.response, fields, geometry, dx, dz)
    inertia = balance.density / dt
    bulk -= volume * inertia * impulse_work(impulse.bulk_u, impulse.bulk_w, u, w, geometry)
    lateral -= inertia * impulse_work(impulse.lateral_u, impulse.lateral_w, u, w, geometry)
    lateral *= volume
    bulk += dx * (bed[1] - bed[0]) + dz * (wall[1] - wall[0]) + gate_shear
    return Work(dt * bulk, dt * dx * bed[0], dt * dz * wall[0], dt * lateral, dt * gate)


@inner_jit()
def gate_work(scratch, w, geometry, balance, dz):
    """Power that the gate takes from the grains, and that of the shear in the half cell beside it, W/m."""
    i = balance.gate_column - 1
    slip = given = shear = 0.0
    if balance.mu_gate == 0.0 or i < 0:
        return 0.0, 0.0
    for k in range(w.shape[1]):
        if geometry.index_w[i, k] >= 0:
            relative, friction = w[i, k] - balance.gate_speed, scratch.k_gate[k]
            slip += dz * friction * abs(relative) * scratch.gate_slip[k]
            given -= dz * balance.gate_speed * friction * relative
            shear += dz * friction * relative**2
    return slip - given, shear - slip


@inner_jit()
def loss_of_step(flow, moved, potential, u_star, w_star, balance):
    """`Loss`: what the discretisation took during one step.

    Parameters
    ----------
    flow : Flow
        After the solve; its `energy` is that before the step.
    moved : Moved
        What left through an open end.
    potential : float
        Potential energy at the end of the step, J/m.
    u_star, w_star : arrays
        Velocity after advection.
    balance : Balance
    """
    fields, geometry, energy = flow.fields, flow.geometry, flow.energy
    cell = balance.density * flow.constants.dx * flow.constants.dz
    change_x, carried_x, flow_x = face_sums(geometry.mass_x, fields.u, u_star)
    change_z, carried_z, flow_z = face_sums(geometry.mass_z, fields.w, w_star)
    gravity = balance.gx * flow_x + balance.gz * flow_z
    released = energy[POTENTIAL] - potential - moved.potential_out
    return Loss(
        0.5 * cell * (change_x + change_z),
        energy[KINETIC] - moved.kinetic_out - 0.5 * cell * (carried_x + carried_z),
        released - cell * balance.dt * gravity,
    )


@inner_jit()
def book_energy(flow, moved, u_star, w_star, impulse, balance):
    """Book the energy of the step: work against each resistance, and what the discretisation took.

    Returns
    -------
    (float, float)
        Kinetic and potential energy after the solve, J/m.
    """
    numbers = flow.fields.numbers
    kinetic, potential = energies(flow)
    work = work_of_step(flow, impulse, balance)
    numbers[WORK_BULK] += work.bulk
    numbers[WORK_BED] += work.bed
    numbers[WORK_BACK_WALL] += work.back_wall
    numbers[WORK_LATERAL] += work.lateral
    numbers[WORK_GATE] += work.gate
    loss = loss_of_step(flow, moved, potential, u_star, w_star, balance)
    numbers[LOSS_TIME] += loss.time
    numbers[LOSS_ADVECTION] += loss.advection
    numbers[LOSS_SURFACE] += loss.surface
    return kinetic, potential


@inner_jit()
def energies(flow):
    """Kinetic and potential energy, J/m, with the face masses of the solver; the potential is zero at the origin."""
    geometry, constants = flow.geometry, flow.constants
    balance, dx, dz = constants.balance, constants.dx, constants.dz
    x_moment, z_moment = first_moments(
        geometry.filled, geometry.lever_x, geometry.lever_z, geometry.packing
    )
    fall = balance.gx * dx * x_moment + balance.gz * dz * z_moment
    return kinetic_energy(flow), -(balance.density * dx * dz) * fall


@inner_jit()
def kinetic_energy(flow):
    """Kinetic energy per unit width, J/m."""
    fields, geometry, constants = flow.fields, flow.geometry, flow.constants
    squares = weighted_square(geometry.mass_x, fields.u)
    squares += weighted_square(geometry.mass_z, fields.w)
    return 0.5 * (constants.balance.density * constants.dx * constants.dz) * squares


@inner_jit()
def weighted_square(weight, values):
    """Sum of weight * values^2 over two arrays of one shape."""
    total = 0.0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            if weight[i, k] != 0.0:  # most cells are air
                total += weight[i, k] * values[i, k] * values[i, k]
    return total


@inner_jit()
def first_moments(filled, lever_x, lever_z, packing):
    """Moments of the filled area, weighted by the packing, about the origin, in cells^2 dx and cells^2 dz."""
    x_moment = z_moment = 0.0
    for i in range(filled.shape[0]):
        for k in range(filled.shape[1]):
            if filled[i, k] > 0.0:
                x_moment += packing[i, k] * (i * filled[i, k] + lever_x[i, k])
                z_moment += packing[i, k] * (k * filled[i, k] + lever_z[i, k])
    return x_moment, z_moment
