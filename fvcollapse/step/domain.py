"""The domain of a simulation: its scratch arrays, the geometry of the present surface, and room for the flow."""

from typing import NamedTuple

import numpy as np

from fvcollapse.errors import NumericalError

from .coefficients import allocate_work
from .compiled import inner_jit
from .erodible_bed import extend_layer, moves_near_end
from .flow import TIME, Carrier, packing_of
from .gate import gate_height, open_fractions
from .geometry import allocate_geometry
from .guards import refuse_growth
from .initial import MARGIN
from .placement import fill_geometry
from .state import crop, grow

GROWTH = 16
SPARE = 4  # rows in excess of the margin before they go: a step is limited by the bandwidth of the memory
RIGHT_ENDS = ("error", "grow", "open", "wall")  # of the case; a kernel knows them by their place
UNREACHED, GROWS, OPEN, WALL = range(len(RIGHT_ENDS))


class Room(NamedTuple):
    """What the grid needs: columns and rows to add, rows to keep (0: all), and whether the mass is at a fixed end."""

    columns: int
    rows: int
    keep: int
    at_end: bool


NO_CHANGE = Room(0, 0, 0, False)


# -- within the step -----------------------------------------------------------------------------


@inner_jit()
def place(flow, time, closed):
    """The geometry is that of the present surface, with the gate where it is at `time` (s), or closed.

    Returns
    -------
    (n,) int64 array
        Envelope of the matrix, from `number_unknowns`.
    """
    constants, geometry = flow.constants, flow.geometry
    lift, column = constants.lift, constants.gate_column
    height = lift.foot if closed else gate_height(time, lift)
    open_fractions(geometry.aperture, height, column, constants.dz)
    return fill_geometry(
        geometry, flow.fields.level_set, packing_of(flow), column, constants.right_end == OPEN
    )


@inner_jit()
def room_needed(flow):
    """What the grid needs for the next step: the `Room` that the grains will reach, and no rows left long ago."""
    geometry, constants = flow.geometry, flow.constants
    if geometry.first > 0:
        return NO_CHANGE
    filled = geometry.filled
    nx, nz = filled.shape
    top = 0
    for i in range(geometry.reach.size):
        top = max(top, geometry.reach[i])
    keep = 0
    if nz > top + MARGIN + SPARE and not gate_is_moving(flow):
        keep = top + MARGIN
    at_end = near_end = False
    for k in range(nz):
        at_end |= filled[nx - 1, k] > 0.0
        for i in range(max(nx - MARGIN, 0), nx):
            near_end |= filled[i, k] > 0.0
    if constants.layer > 0.0:
        near_end = moves_near_end(flow.fields, geometry, MARGIN)
    near_top = False
    for i in range(nx):
        for k in range(nz - 4, nz):
            near_top |= filled[i, k] > 0.0
    columns = GROWTH if constants.right_end == GROWS and near_end else 0
    return Room(
        columns, MARGIN if near_top else 0, keep, constants.right_end == UNREACHED and at_end
    )


@inner_jit()
def gate_is_moving(flow):
    """Whether the gate still touches the mass."""
    lift, nz = flow.constants.lift, flow.geometry.filled.shape[1]
    height = gate_height(flow.fields.numbers[TIME], lift)
    return lift.speed > 0.0 and height < nz * flow.constants.dz


# -- between steps -------------------------------------------------------------------------------


def allocate(simulation):
    """Geometry and scratch arrays have the shape of the state."""
    nx, nz = simulation.state.pressure_filled.shape
    simulation.geometry = allocate_geometry(nx, nz, simulation.halo)
    simulation.work = allocate_work(nx, nz)
    simulation.unit_packing = np.ones((nx, nz))
    simulation.carrier = Carrier(np.zeros((nx + 1, nz)), np.zeros((nx, nz + 1)))


def make_room(simulation, room):
    """The grid has the rows and columns that a step asks for.

    Parameters
    ----------
    simulation : Simulation
    room : Room

    Raises
    ------
    NumericalError
        The mass has reached the end of a domain that must not grow.
    LimitReached
    """
    if room.keep:
        simulation.state = simulation.state.copy()
        crop(simulation.state, room.keep)
        allocate(simulation)
        simulation.place()
    if room.at_end:
        length = simulation.grid.nx * simulation.spacing[0]
        raise NumericalError(
            "the mass has reached the end of the domain; lengthen boundary.domain_length",
            f"at x = {length:.3g} m",
            simulation.state.time,
        )
    if room.columns or room.rows:
        enlarge(simulation, room.columns, room.rows)


def enlarge(simulation, extra_x, extra_z):
    """The grid has `extra_x` columns and `extra_z` rows more, which hold an erodible layer or nothing."""
    nx, nz = simulation.state.pressure_filled.shape
    shape = nx + extra_x, nz + extra_z
    refuse_growth(simulation.case, shape, simulation.spacing, simulation.state.time)
    simulation.state = state = simulation.state.copy()
    grow(state, extra_x, extra_z)
    for _, extend in simulation.terms.extend:
        extend(state, simulation.case, nx, nz)
    allocate(simulation)
    longer = extra_x > 0 and simulation.layer > 0.0
    if longer:
        extend_layer(
            state, extra_x, simulation.layer, simulation.grid.z_nodes, simulation.spacing[0]
        )
    simulation.place()
    if longer:
        book_layer(simulation)


def book_layer(simulation):
    """The energy of the layer by which the domain has grown is booked: it has flowed in."""
    before, simulation.energy = simulation.energy, simulation.energies()
    gained = before["potential"] - simulation.energy["potential"]
    simulation.state.energy_outflow += float(gained)
