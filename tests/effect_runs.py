"""Short coarse collapses that the tests of the effects compare."""

import math

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.state import FIELDS

CELL = 0.02  # m
COLUMN = {"grid.cell_size": CELL, "geometry.channel_width": 0.10, "geometry.slope_angle_deg": 16.0}


def collapse(time, **changes):
    """A collapse at 16 deg, w = 10 cm, advanced to `time` (s); double underscores stand for dots."""
    keys = COLUMN | {name.replace("__", "."): value for name, value in changes.items()}
    simulation = Simulation(Case().replace(**keys))
    while simulation.state.time < time - 1e-12:
        simulation.advance(time)
    return simulation


def same_to_the_last_bit(first, second):
    """Whether two simulations hold the same fields."""
    return all(
        np.array_equal(getattr(first.state, name), getattr(second.state, name)) for name in FIELDS
    )


def centre_of_mass(simulation):
    """Abscissa of the centre of mass, m: a smooth measure of how far the grains went."""
    columns = simulation.geometry.filled.sum(1)
    return float(columns @ simulation.grid.x_centres / columns.sum())


def volume_change(simulation):
    """Relative change of the volume since the start."""
    return (
        simulation.geometry.filled.sum() * math.prod(simulation.spacing) / simulation.state.volume_0
        - 1.0
    )
