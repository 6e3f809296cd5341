"""The free surface of a step: moved with the grains, held to their volume, its outflow booked."""

from typing import NamedTuple

import numpy as np

from . import level_set, redistancing
from .compiled import inner_jit
from .domain import OPEN, WALL
from .flow import (
    ENERGY_OUTFLOW,
    TIME,
    TRAVEL,
    VOLUME_0,
    VOLUME_CORRECTION,
    VOLUME_OUTFLOW,
    packing_of,
)
from .gate import gate_height, hold_at_gate, open_fractions
from .geometry import repeat, wetted_edge
from .grain_volume import hold_volume
from .terms import carry_terms


class Moved(NamedTuple):
    """What moves beside the surface: volume added by the correction, m2; energy that has left, J/m."""

    added: float
    kinetic_out: float
    potential_out: float


@inner_jit()
def move_surface(flow, dt):
    """The surface and the fields of the grains have moved for dt (s); return `Moved`."""
    fields, dx, dz = flow.fields, flow.constants.dx, flow.constants.dz
    phi = fields.level_set
    u_node, w_node = np.empty_like(phi), np.empty_like(phi)
    level_set.node_velocity(u_node, w_node, flow.carrier.u, flow.carrier.w)
    u_surface, w_surface = np.empty_like(phi), np.empty_like(phi)
    band = level_set.BAND * max(dx, dz)
    level_set.carry_from_surface(u_surface, w_surface, u_node, w_node, phi, band, dx, dz)
    level_set.advect(phi, u_surface, w_surface, dt, dx, dz)
    speed = np.empty_like(phi)
    fastest = level_set.node_speed(speed, u_node, w_node)
    if flow.constants.right_end == WALL:
        level_set.close_end(phi, dx)
    restore_distance(fields, fastest * dt / min(dx, dz), dx, dz)
    repeat(flow.geometry, phi)
    carry_terms(flow.constants.balance.response, flow, dt)
    if fastest == 0.0:
        return Moved(0.0, 0.0, 0.0)
    kinetic, potential = book_outflow(flow, u_node, w_node, dt)
    return Moved(correct_surface(flow, speed, dt), kinetic, potential)


@inner_jit()
def restore_distance(fields, travel, dx, dz):
    """The level set is a signed distance again if it has been moved far enough, `travel` cells in this step."""
    numbers = fields.numbers
    numbers[TRAVEL] += travel
    if numbers[TRAVEL] >= redistancing.RESTORE_AFTER:
        redistancing.reinitialise(fields.level_set, redistancing.SWEEPS, dx, dz)
        numbers[TRAVEL] = 0.0


@inner_jit()
def correct_surface(flow, speed, dt):
    """The grains have their volume again; return what was added, m2, booked as a correction."""
    fields, constants = flow.fields, flow.constants
    numbers, area = fields.numbers, constants.dx * constants.dz
    aperture = np.ones_like(flow.geometry.aperture)
    height = gate_height(numbers[TIME] + dt, constants.lift)
    open_fractions(aperture, height, constants.gate_column, constants.dz)
    hold_at_gate(speed, fields.level_set, aperture, constants.gate_column)
    target = (numbers[VOLUME_0] - numbers[VOLUME_OUTFLOW]) * constants.packing_0 / area
    cell = min(constants.dx, constants.dz)
    added = hold_volume(fields.level_set, aperture, speed, packing_of(flow), target, cell)
    added *= area / constants.packing_0
    numbers[VOLUME_CORRECTION] += abs(added)
    return added


@inner_jit()
def book_outflow(flow, u_node, w_node, dt):
    """Volume and energy that cross an open end during dt (s) are booked; return kinetic and potential energy, J/m."""
    constants, numbers = flow.constants, flow.fields.numbers
    if constants.right_end != OPEN:
        return 0.0, 0.0
    phi, packing = flow.fields.level_set, packing_of(flow)
    nx, nz = packing.shape
    dx, dz, balance = constants.dx, constants.dz, constants.balance
    volume = kinetic = potential = 0.0
    for k in range(nz):
        wetted = wetted_edge(phi[nx, k], phi[nx, k + 1])
        speed = 0.5 * (u_node[nx, k] + u_node[nx, k + 1])
        rise = 0.5 * (w_node[nx, k] + w_node[nx, k + 1])
        through = max(wetted * speed, 0.0) * dz * dt * packing[nx - 1, k]
        middle = (k + 0.5 * wetted) * dz
        mass = balance.density * through
        volume += through
        kinetic += mass * 0.5 * (speed**2 + rise**2)
        potential -= mass * (balance.gx * nx * dx + balance.gz * middle)
    numbers[VOLUME_OUTFLOW] += volume / constants.packing_0
    numbers[ENERGY_OUTFLOW] += kinetic + potential
    return kinetic, potential
