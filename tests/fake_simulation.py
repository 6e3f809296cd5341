"""A stand-in for `Simulation`: a triangular pile that spreads by formula, with memory.

h(x, t) = 2 (A/L) (1 - x/L) with area A = height_0 length_0 and L(t) = 2 length_0 + 0.5 (1 -
exp(-t/0.1)): the volume is constant, the grid grows with L, and the velocities relax towards their
formula, so that a restart that loses any field or scalar changes what follows.
"""

import math
from types import SimpleNamespace

import numpy as np

from fvcollapse.measure.pile import front_position, x_at_volume
from fvcollapse.measure.series_row import ROW
from fvcollapse.output import run as output
from fvcollapse.simulation import Marched
from fvcollapse.step.advance import StepRecord
from fvcollapse.step.geometry import cell_fractions
from fvcollapse.step.grid import Grid
from fvcollapse.step.state import FIELDS, SCALARS, State, location_shape

SPREAD, TAU = 0.5, 0.1


def length(case, time):
    return 2.0 * case.geometry.length_0 + SPREAD * (1.0 - math.exp(-time / TAU))


def height(case, time, x):
    long = length(case, time)
    area = case.geometry.height_0 * case.geometry.length_0
    return 2.0 * area / long * (1.0 - x / long)


class FakeSimulation:
    """Same interface as `fvcollapse.simulation.Simulation`."""

    def __init__(self, case, state=None):
        self.case = case
        self.state = self._start() if state is None else state

    def _start(self):
        nz = math.ceil(1.2 * self.case.geometry.height_0 / self.case.grid.cell_size)
        nx = math.ceil(length(self.case, 0.0) / self.case.grid.cell_size) + 3
        arrays = {name: np.zeros(location_shape(FIELDS[name][0], nx, nz)) for name in FIELDS}
        state = State(**arrays, **{name: 0 if "step" in name else 0.0 for name in SCALARS})
        self.state = state
        self._fill()
        state.volume_0 = self._volume()
        return state

    @property
    def grid(self):
        cell_size = self.case.grid.cell_size
        return Grid(*self.state.pressure_filled.shape, cell_size, cell_size)

    @property
    def spacing(self):
        return self.grid.dx, self.grid.dz

    @property
    def geometry(self):
        everywhere = np.zeros(self.state.u.shape, np.int64)
        return SimpleNamespace(reach=np.full(self.grid.nx, self.grid.nz), index_u=everywhere)

    def watch_energy(self, series):
        """Nothing watches this one."""

    def march(self, time_limit, steps, guarded=True):
        """One step, however many may be taken: what a test lets fail in it spoils no other."""
        record = self.advance(time_limit)
        return Marched([record], self.row[None], self.state, None)

    @property
    def row(self):
        """The series of the pile, as far as the formula has them."""
        state, x = self.state, self.grid.x_nodes
        h = np.maximum(height(self.case, state.time, x), 0.0)
        columns = 0.5 * (h[1:] + h[:-1])
        threshold = self.case.front.thickness
        known = {
            "time": state.time,
            "front_position": front_position(x, h, threshold),
            "front_1mm": front_position(x, h, 1e-3),
            "front_10mm": front_position(x, h, 1e-2),
            "x_99": x_at_volume(x, columns, 0.99),
            "max_thickness": h[0],
            "relative_volume": self._volume() / state.volume_0 - 1.0,
            "volume_correction": state.volume_correction / state.volume_0,
            "kinetic_energy": self.energy["kinetic"],
            "potential_energy": self.energy["potential"],
            "max_speed": float(np.abs(state.u).max()),
        }
        return np.array([known.get(name, 0.0) for name in ROW])

    def advance(self, time_limit):
        state = self.state
        dt = min(1.1 * state.dt or 1.0e-3, 7.0e-3, time_limit - state.time)
        state.time = time_limit if state.time + dt > time_limit - 1e-12 else state.time + dt
        state.step += 1
        state.dt = dt
        self._grow()
        self._fill()
        added = 1e-7 * math.sin(state.step)
        state.volume_correction += abs(added)
        capped = state.step % 7 == 0
        return StepRecord(state.time, dt, 5 + state.step % 3, 9, 1e-4, 1e-12, capped, added)

    def _grow(self):
        cell_size = self.case.grid.cell_size
        nx, nz = self.state.pressure_filled.shape
        if length(self.case, self.state.time) > (nx - 2) * cell_size:
            for name, (location, *_) in FIELDS.items():
                old = getattr(self.state, name)
                new = np.zeros(location_shape(location, nx + 5, nz))
                new[tuple(slice(n) for n in old.shape)] = old
                setattr(self.state, name, new)

    def _fill(self):
        state, grid = self.state, self.grid
        x, z = grid.x_nodes, grid.z_nodes
        long = length(self.case, state.time)
        rate = SPREAD / TAU * math.exp(-state.time / TAU) if state.time > 0.0 else 0.0
        state.level_set = z[None, :] - height(self.case, state.time, x)[:, None]
        target = (x * rate / long)[:, None] * np.ones(grid.nz)
        state.u = 0.5 * (state.u + target)
        state.w = 0.5 * (state.w - (grid.z_nodes * rate / long)[None, :] * np.ones((grid.nx, 1)))
        state.bed_slip = 0.5 * (state.bed_slip + target[:, 0])
        depth = np.maximum(
            height(self.case, state.time, grid.x_centres)[:, None] - grid.z_centres, 0.0
        )
        state.pressure_filled = 0.5 * (state.pressure_filled + 1550.0 * 9.81 * depth)

    def _volume(self):
        return cell_fractions(self.state.level_set).sum() * self.grid.dx * self.grid.dz

    @property
    def energy(self):
        return self.energies()

    def energies(self):
        return {"kinetic": 1e-4 * float((self.state.u**2).sum()), "potential": -self.state.time}

    def cell_quantities(self):
        filled = cell_fractions(self.state.level_set)
        pressure = np.where(
            filled > 0.0, self.state.pressure_filled / np.maximum(filled, 1e-12), 0.0
        )
        rate = np.abs(np.diff(self.state.u, axis=0)) / self.grid.dx
        return {
            "filled_fraction": filled,
            "pressure": pressure,
            "shear_rate": rate,
            "viscosity": 1.0 / (rate + 1.0),
            "inertial_number": rate / np.sqrt(pressure + 1.0),
            "ill_posed": rate > 1.0,
        }


def counted(cases):
    """The fake simulation; each case that is started from t = 0 is added to `cases`."""

    class Counted(FakeSimulation):
        def __init__(self, case, state=None):
            if state is None:
                cases.append(case)
            super().__init__(case, state)

    return Counted


def stopped(error, step=3, only=lambda case: True):
    """The present simulation, stopped before a step."""

    class Stopped(output.Simulation):
        def march(self, time_limit, steps, guarded=True):
            left = step - self.state.step
            if left == 0 and only(self.case):
                raise error
            return super().march(time_limit, min(steps, left) if left > 0 else steps, guarded)

    return Stopped
