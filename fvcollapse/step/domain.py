"""The domain of a simulation: its scratch arrays, the geometry of the present surface, and room for the flow."""

import numpy as np

from fvcollapse.errors import NumericalError

from .coefficients import allocate_work
from .erodible_bed import extend_layer, moves_near_end
from .gate import gate_height, open_fractions
from .geometry import allocate_geometry, repeat_columns
from .guards import refuse_growth
from .initial import MARGIN
from .placement import fill_geometry
from .state import crop, grow

GROWTH = 16
SPARE = 4  # rows in excess of the margin before they go: a step is limited by the bandwidth of the memory


def allocate(simulation):
    """Geometry and scratch arrays have the shape of the state."""
    nx, nz = simulation.state.pressure_filled.shape
    simulation.geometry = allocate_geometry(nx, nz, simulation.halo)
    simulation.work = allocate_work(nx, nz)
    simulation.unit_packing = np.ones((nx, nz))
    simulation.buffer = np.empty(0)


def repeat(simulation, *fields):
    """The halo of a periodic stretch repeats the fields."""
    if simulation.halo:
        for field in fields:
            repeat_columns(field, simulation.geometry.first, simulation.geometry.last)


def place(simulation, time, closed=False):
    """The geometry is that of the present surface, with the gate where it is at `time` (s), or closed."""
    lift, geometry, column = simulation.lift, simulation.geometry, simulation.gate_column
    height = lift.foot if closed else gate_height(time, lift)
    open_fractions(geometry.aperture, height, column, simulation.spacing[1])
    open_end = simulation.case.boundary.right_end == "open"
    simulation.ends = fill_geometry(
        geometry, simulation.state.level_set, simulation.packing(), column, open_end
    )


def fit_grid(simulation):
    """The grid has the rows and columns that the grains will reach, without rows that they have left long ago."""
    if simulation.halo:
        return
    rows = simulation.geometry.reach.max() + MARGIN
    if simulation.grid.nz > rows + SPARE and not simulation.gate_is_moving():
        simulation.state = simulation.state.copy()
        crop(simulation.state, int(rows))
        allocate(simulation)
        simulation.stages.place(simulation, simulation.state.time)
    make_room(simulation)


def make_room(simulation):
    """The grains are away from the end and the top of the grid.

    Raises
    ------
    NumericalError
        The mass has reached the end of a domain that must not grow.
    LimitReached
    """
    filled = simulation.geometry.filled
    right_end = simulation.case.boundary.right_end
    if right_end == "error" and filled[-1].any():
        raise NumericalError(
            "the mass has reached the end of the domain; lengthen boundary.domain_length",
            f"at x = {len(filled) * simulation.spacing[0]:.3g} m",
            simulation.state.time,
        )
    extra_x = GROWTH if right_end == "grow" and is_near_end(simulation) else 0
    extra_z = MARGIN if filled[:, -4:].any() else 0
    if extra_x or extra_z:
        enlarge(simulation, extra_x, extra_z)


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
    simulation.stages.place(simulation, state.time)
    if longer:
        book_layer(simulation)


def is_near_end(simulation):
    """Whether the grains come near the far end; those of an erodible layer, whether they move there."""
    if simulation.layer > 0.0:
        return moves_near_end(simulation.state, simulation.geometry, MARGIN)
    return simulation.geometry.filled[-MARGIN:].any()


def book_layer(simulation):
    """The energy of the layer by which the domain has grown is booked: it has flowed in."""
    before, simulation.energy = simulation.energy, simulation.energies()
    gained = before["potential"] - simulation.energy["potential"]
    simulation.state.energy_outflow += float(gained)
