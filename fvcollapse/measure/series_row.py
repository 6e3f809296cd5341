"""The values of the series at one instant: one row, filled by a kernel after every step."""

import math
from typing import NamedTuple

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.measure.pile import (
    cells_inside,
    detached_volume,
    fastest_cell,
    front_position,
    x_at_volume,
)
from fvcollapse.measure.series_readings import ENERGY_SPENT, LOSSES
from fvcollapse.step.adhesion import adhesion_of
from fvcollapse.step.arrays import total
from fvcollapse.step.compiled import inner_jit
from fvcollapse.step.flow import (
    ENERGY_OUTFLOW,
    KINETIC,
    LOSS_ADVECTION,
    LOSS_SURFACE,
    LOSS_TIME,
    POTENTIAL,
    TIME,
    VOLUME_0,
    VOLUME_CORRECTION,
    VOLUME_OUTFLOW,
    WORK_BACK_WALL,
    WORK_BED,
    WORK_BULK,
    WORK_GATE,
    WORK_LATERAL,
)
from fvcollapse.step.geometry import WET

SHAPE = (
    "time",
    "front_position",
    "front_1mm",
    "front_10mm",
    "x_99",
    "max_thickness",
    "detached_volume",
)
STATE = ("relative_volume", "volume_correction", "max_speed", "negative_pressure_cells")
ROW = (*SHAPE, *STATE, "kinetic_energy", "potential_energy", *ENERGY_SPENT, *LOSSES)
SUCTION = 1.0e-6  # of the hydrostatic scale, above round-off


class Reading(NamedTuple):
    """How a row is read: thickness of the front, m, and the pressure below which a cell is in suction, Pa."""

    front_thickness: float
    suction: float


def reading_of(case):
    """The `Reading` of a case."""
    scale = case.rheology.density_bulk * GRAVITY * case.geometry.height_0
    return Reading(float(case.front.thickness), -SUCTION * scale)


@inner_jit()
def fill_row(row, flow, reading):
    """Fill `row` (len(ROW),) with the present values.

    On an erodible bed thickness and volumes are measured from the initial surface of the layer.
    """
    fill_shape(row[: len(SHAPE)], flow, reading.front_thickness)
    fill_state(row[len(SHAPE) :], flow, reading.suction)
    numbers, here = flow.fields.numbers, len(SHAPE) + len(STATE)
    row[here], row[here + 1] = flow.energy[KINETIC], flow.energy[POTENTIAL]
    row[here + 2], row[here + 3] = numbers[WORK_BULK], numbers[WORK_BED]
    row[here + 4], row[here + 5] = numbers[WORK_BACK_WALL], numbers[WORK_LATERAL]
    row[here + 6], row[here + 7] = numbers[WORK_GATE], numbers[ENERGY_OUTFLOW]
    row[here + 8], row[here + 9] = numbers[LOSS_TIME], numbers[LOSS_ADVECTION]
    row[here + 10] = numbers[LOSS_SURFACE]


@inner_jit()
def fill_shape(row, flow, front_thickness):
    """Fill the values of `SHAPE`."""
    filled, constants = flow.geometry.filled, flow.constants
    dx, dz, layer = constants.dx, constants.dz, constants.layer
    x, h = np.empty(filled.shape[0] + 1), np.zeros(filled.shape[0] + 1)
    cells_inside(h, flow.fields.level_set)
    highest = -math.inf
    for i in range(x.size):
        x[i] = dx * i
        h[i] = dz * h[i] - layer
        highest = max(highest, h[i])
    columns = np.empty(filled.shape[0])
    for i in range(columns.size):
        columns[i] = max(total(filled[i]) * (dx * dz) - layer * dx, 0.0)
    row[0] = flow.fields.numbers[TIME]
    row[1] = front_position(x, h, front_thickness)
    row[2], row[3] = front_position(x, h, 1.0e-3), front_position(x, h, 1.0e-2)
    row[4], row[5] = x_at_volume(x, columns, 0.99), highest
    for i in range(h.size):
        h[i] = max(h[i], 0.0)
    row[6] = detached_volume(x, h)


@inner_jit()
def fill_state(row, flow, suction):
    """Fill the values of `STATE`."""
    filled, fields, constants = flow.geometry.filled, flow.fields, flow.constants
    numbers, pressure = fields.numbers, fields.pressure_filled
    adhesion = adhesion_of(constants.balance.response)
    volume = 0.0
    in_suction = 0
    for i in range(filled.shape[0]):
        for k in range(filled.shape[1]):
            volume += filled[i, k]
            p = pressure[i, k] - adhesion * filled[i, k]
            if filled[i, k] > WET and p < suction * filled[i, k]:
                in_suction += 1
    area = constants.dx * constants.dz
    row[0] = (volume * area + numbers[VOLUME_OUTFLOW]) / numbers[VOLUME_0] - 1.0
    row[1] = numbers[VOLUME_CORRECTION] / numbers[VOLUME_0]
    row[2] = fastest_cell(filled, fields.u, fields.w)
    row[3] = in_suction
