"""The free surface of a step: moved with the grains, held to their volume, its outflow booked."""

import itertools

import numpy as np

from . import grain_volume, level_set, redistancing
from .domain import repeat
from .energy import Outflow
from .gate import gate_height, hold_at_gate, open_fractions
from .geometry import wetted_edge


def move_surface(simulation, dt):
    """The surface and the fields of the grains have moved for dt (s); return the volume that was added, m2."""
    state, (dx, dz) = simulation.state, simulation.spacing
    phi_old = state.level_set.copy() if state.effect_fields() else None
    u_node, w_node = np.empty_like(state.level_set), np.empty_like(state.level_set)
    level_set.node_velocity(u_node, w_node, state.u, state.w)
    u_surface, w_surface = np.empty_like(u_node), np.empty_like(w_node)
    band = level_set.BAND * max(dx, dz)
    level_set.carry_from_surface(
        u_surface, w_surface, u_node, w_node, state.level_set, band, dx, dz
    )
    level_set.advect(state.level_set, u_surface, w_surface, dt, dx, dz)
    speed = np.empty_like(u_node)
    fastest = level_set.node_speed(speed, u_node, w_node)
    restore_distance(state, fastest * dt / min(dx, dz), dx, dz)
    repeat(simulation, state.level_set)
    if phi_old is not None:
        carry_fields(simulation, phi_old, dt)
    simulation.outflow = Outflow(0.0, 0.0)
    if fastest == 0.0:
        return 0.0
    book_outflow(simulation, u_node, w_node, dt)
    return hold_volume(simulation, speed, dt)


def restore_distance(state, travel, dx, dz):
    """The level set is a signed distance again if it has been moved far enough, `travel` cells in this step."""
    state.travel += travel
    state.travel_steps += 1
    if redistancing.needs_restoring(state.travel, state.travel_steps):
        redistancing.reinitialise(state.level_set, redistancing.SWEEPS, dx, dz)
        state.travel, state.travel_steps = 0.0, 0


def carry_fields(simulation, phi_old, dt):
    """The fields of the effects have moved with the grains."""
    state = simulation.state
    for _, carry in simulation.terms.carry:
        carry(state, simulation.geometry.aperture, phi_old, dt, *simulation.spacing)
    repeat(simulation, *(getattr(state, name) for name in state.effect_fields()))


def hold_volume(simulation, speed, dt):
    """The grains have their volume again; return what was added, m2, booked as a correction."""
    state, (dx, dz) = simulation.state, simulation.spacing
    aperture = aperture_at(simulation, state.time + dt)
    hold_at_gate(speed, state.level_set, aperture, simulation.gate_column)
    target = (state.volume_0 - state.volume_outflow) * simulation.packing_0 / (dx * dz)
    added = (
        grain_volume.hold_volume(
            state.level_set, aperture, speed, simulation.packing(), target, min(dx, dz)
        )
        * dx
        * dz
        / simulation.packing_0
    )
    state.volume_correction += abs(added)
    return added


def aperture_at(simulation, time):
    """Open part of each x-face at `time` (s), (nx + 1, nz)."""
    aperture = np.ones_like(simulation.geometry.aperture)
    height = gate_height(time, simulation.lift)
    open_fractions(aperture, height, simulation.gate_column, simulation.spacing[1])
    return aperture


def book_outflow(simulation, u_node, w_node, dt):
    """Volume and energy that cross an open end during dt (s) are booked."""
    if simulation.case.boundary.right_end != "open":
        return
    state, grid = simulation.state, simulation.grid
    phi, (dx, dz) = state.level_set[-1], simulation.spacing
    speed = 0.5 * (u_node[-1, :-1] + u_node[-1, 1:])
    rise = 0.5 * (w_node[-1, :-1] + w_node[-1, 1:])
    wetted = np.array([wetted_edge(*ends) for ends in itertools.pairwise(phi)])
    packing = simulation.packing()[-1]
    through = np.maximum(wetted * speed, 0.0) * dz * dt * packing
    gx, gz = simulation.gravity
    middle = grid.z_nodes[:-1] + 0.5 * wetted * dz
    mass = simulation.case.rheology.density_bulk * through
    simulation.outflow = Outflow(
        float(mass @ (0.5 * (speed**2 + rise**2))),
        float(mass @ (-gx * grid.nx * dx - gz * middle)),
    )
    state.volume_outflow += through.sum() / simulation.packing_0
    state.energy_outflow += sum(simulation.outflow)
