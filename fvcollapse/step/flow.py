"""A flow as the kernels see it: the fields of the state, geometry, scratch arrays and the constants of the run.

The arrays are those of the `Simulation`, changed in place; the scalars of the state stand in `Fields.numbers`.
"""

from collections import namedtuple
from typing import NamedTuple

import numpy as np

from .balance import Balance
from .coefficients import Work
from .compiled import inner_jit
from .gate import Lift
from .geometry import Geometry
from .rheology import Material
from .state import EFFECT_FIELDS, FIELDS, SCALARS

# The fields of a state, (0, 0) where their effect is off, and its scalars: `numbers` (len(SCALARS),).
Fields = namedtuple("Fields", [*FIELDS, *EFFECT_FIELDS, "numbers"])  # noqa: PYI024
ABSENT = np.zeros((0, 0))

(
    TIME,
    STEP,
    DT,
    VOLUME_0,
    VOLUME_CORRECTION,
    VOLUME_OUTFLOW,
    WORK_BULK,
    WORK_BED,
    WORK_BACK_WALL,
    WORK_LATERAL,
    WORK_GATE,
    LOSS_TIME,
    LOSS_ADVECTION,
    LOSS_SURFACE,
    ENERGY_OUTFLOW,
    TRAVEL,
) = range(len(SCALARS))
KINETIC, POTENTIAL = 0, 1  # places in `Flow.energy`


class Constants(NamedTuple):
    """What stays during a run, SI.

    `balance` is that of a step of no length; `layer` the thickness of an erodible bed, 0 without one; `slow` the
    speed of grains whose sweeps may stall; `ahead` the part of the step, 0 or 0.5, whose velocity carries surface and
    momentum (`carrier`).
    """

    dx: float
    dz: float
    gate_column: int
    lift: Lift
    shape_factor: float
    packing_0: float
    fraction_bulk: float
    layer: float
    right_end: int
    film_thickness: float
    cfl: float
    longest_step: float
    growth: float
    ahead: float
    slow: float
    check_residual: bool
    split_walls: bool
    soft_rate: float
    material: Material
    balance: Balance


class Carrier(NamedTuple):
    """Velocity that carries surface, momentum and the fields of the effects during a step, m/s; see `set_carrier`."""

    u: np.ndarray
    w: np.ndarray


class Before(NamedTuple):
    """Level set, m, and velocity, m/s, at the start of the step."""

    level_set: np.ndarray
    u: np.ndarray
    w: np.ndarray


class Flow(NamedTuple):
    """A state with its geometry, scratch arrays and constants.

    `store` (n,) are the numbers of all `fields`, and `saved` (n,) those of the start of the step; `before` are the
    fields of that start that a step reads. `energy` (2,) is the kinetic and the potential energy, J/m.
    """

    fields: Fields
    before: Before
    store: np.ndarray
    saved: np.ndarray
    energy: np.ndarray
    carrier: Carrier
    geometry: Geometry
    work: Work
    unit_packing: np.ndarray
    constants: Constants


def flow_of(state, before, arrays, constants):
    """The `Flow` of a state and of a copy of it, `before`, which takes what the state holds at the start of each step.

    `arrays` are energy, carrier, geometry, work and unit packing (see `Flow`). Only of a state that is a copy
    (`State.copy`) steps can be taken.
    """
    return Flow(
        fields_of(state),
        Before(before.level_set, before.u, before.w),
        getattr(state, "store", before.store),
        before.store,
        *arrays,
        constants,
    )


def fields_of(state):
    """The `Fields` of a state: its arrays themselves."""
    arrays = {name: getattr(state, name) for name in (*FIELDS, *EFFECT_FIELDS)}
    present = {name: ABSENT if values is None else values for name, values in arrays.items()}
    return Fields(**present, numbers=state.numbers)


@inner_jit()
def copy_all(target, source):
    """Copy an array (n,) into another one."""
    for n in range(target.size):
        target[n] = source[n]


@inner_jit()
def packing_of(flow):
    """Local density over density_bulk, (nx, nz); 1 in an incompressible mass."""
    fraction = flow.fields.solid_fraction
    if fraction.size == 0:
        return flow.unit_packing
    return fraction / flow.constants.fraction_bulk


@inner_jit()
def set_carrier(flow, dt):
    """The carrier is the velocity in the middle of the step of dt (s), extrapolated from the last two instants.

    u + (dt / 2 dt_before) (u - u_before): second order in dt. Where that would turn a velocity round, grains have come
    to rest: there it is zero.
    """
    fields, carrier = flow.fields, flow.carrier
    previous = fields.numbers[DT]
    factor = flow.constants.ahead * dt / previous if previous > 0.0 else 0.0
    extrapolate_in_time(carrier.u, fields.u, fields.u_before, factor)
    extrapolate_in_time(carrier.w, fields.w, fields.w_before, factor)


@inner_jit()
def extrapolate_in_time(target, now, before, factor):
    """Set target = now + factor (now - before), or zero where its sign would differ from that of now."""
    for i in range(now.shape[0]):
        for k in range(now.shape[1]):
            value = now[i, k] + factor * (now[i, k] - before[i, k])
            target[i, k] = value if value * now[i, k] > 0.0 else 0.0
