"""Flows with a known solution, set up on the `Simulation` that runs a collapse.

A uniform flow is a level layer in a periodic stretch of the channel, a few columns long. Nothing in
it is explicit (the surface does not move and velocities do not vary along the bed), so its time
step may be set at will.
"""

import math
from collections.abc import Callable
from contextvars import ContextVar
from typing import Any

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.console.interruption import Interrupted
from fvcollapse.errors import NumericalError
from fvcollapse.simulation import Simulation
from fvcollapse.step import level_set, redistancing
from fvcollapse.step.advance import STAGES
from fvcollapse.step.geometry import cell_fractions
from fvcollapse.step.initial import HALO, initial_grid, initial_state
from fvcollapse.verification.exact import pressure_hydrostatic

COLUMNS = 1
INTERRUPTED = ContextVar("interrupted", default=lambda: 0)  # a signal that waits to be heeded
TIGHT = {"numerics.tolerance": 1e-8, "numerics.max_sweeps": 300}


def with_step(stages: Any, dt: float) -> Any:
    """The stages of a simulation whose time step is dt (s), whatever the limits."""
    return stages._replace(choose_step=lambda flow, time_limit: dt)


class UniformFlow(Simulation):
    """A uniform flow, with a time step of one's own choice (s)."""

    def __init__(self, case, state, dt):
        super().__init__(case, state, with_step(STAGES, dt))

    def profile(self) -> tuple[np.ndarray, np.ndarray]:
        """U (m/s) at the heights (m) of the wet cell centres, as (z, u)."""
        wet = self.geometry.filled[HALO] > 1e-3
        return self.grid.z_centres[wet], self.state.u[HALO, wet]

    def mean_velocity(self) -> float:
        """Velocity averaged over the mass of the layer, m/s."""
        mass = self.geometry.mass_x[HALO]
        return float(mass @ self.state.u[HALO] / mass.sum())

    def surface_velocity(self) -> float:
        """U of the uppermost wet cell, m/s."""
        return float(self.profile()[1][-1])


def layer_case(cell_size: float, depth: float, **changes: Any) -> Case:
    """Case of a layer of `depth` (m) in a periodic stretch; no lateral walls, unless added.

    Keys are those of the case file with a double underscore for the dot, as in `rheology__mu_1 =
    0.38`.
    """
    keys = {
        "grid.cell_size": cell_size,
        "geometry.height_0": depth,
        "geometry.length_0": COLUMNS * cell_size,
        "geometry.channel_width": math.inf,
        "boundary.ends": "periodic",
        **TIGHT,
    }
    keys.update({name.replace("__", "."): value for name, value in changes.items()})
    return Case().replace(**keys)


def layer(
    case: Case, velocity: Callable, dt: float, depth: float | None = None, slip: Any = 0.0
) -> Any:
    """Layer in hydrostatic balance that moves along the bed with `velocity(z)`.

    Parameters
    ----------
    case : Case
        As from `layer_case`.
    velocity : callable
        u(z), m/s, of an array of heights (m).
    dt : float
        Time step, s.
    depth : float, optional
        Depth of the layer, m, at most height_0 (which is its default; a case must be four cells
        high).
    slip : float
        Velocity at the bed, m/s.

    Returns
    -------
    UniformFlow
    """
    depth = case.geometry.height_0 if depth is None else depth
    grid = initial_grid(case)
    state = initial_state(case, grid)
    state.level_set[:] = grid.z_nodes - depth
    filled = cell_fractions(state.level_set)
    state.u[:] = velocity(grid.z_centres)
    state.bed_slip[:] = slip
    middle = grid.z_nodes[:-1] + 0.5 * filled[0] * grid.dz
    state.pressure_filled[:] = filled * pressure_hydrostatic(case, middle, depth)
    state.volume_0 = filled.sum() * grid.dx * grid.dz
    state.dt = dt
    return UniformFlow(case, state, dt)


def heed_interrupt() -> Any:
    """Raise Interrupted if a signal waits; within a compiled kernel it would crash the process."""
    if number := INTERRUPTED.get()():
        raise Interrupted(number)


def run_until(flow: Any, time: float) -> Any:
    """Advance to `time` (s)."""
    while flow.state.time < time - 1e-12:
        flow.advance(time)
        heed_interrupt()
    return flow


def run_until_steady(flow: Any, change: float = 1e-6, steps: int = 60) -> Any:
    """Advance until a step whose sweeps have settled changes the velocity by less than `change` of the largest.

    Near a static-flowing interface the sweeps of a long step often end at their cap, with a small
    change from step to step, far from the solution: such a step does not count as steady.

    Raises
    ------
    NumericalError
        If it still changes after `steps` steps.
    """
    for _ in range(steps):
        before = flow.state.u.copy()
        record = flow.advance(1e9)
        heed_interrupt()
        if (
            not record.capped
            and np.abs(flow.state.u - before).max() <= change * np.abs(before).max()
        ):
            return flow
    raise NumericalError(f"no steady flow after {steps} steps", time=flow.state.time)


# -- surfaces in a given velocity ---------------------------------------------------------------


def transport(
    surface: Callable, velocity: Callable, duration: float, cells: int, courant: float = 0.5
) -> Any:
    """Carry a surface through the unit square with the solver's own level-set routines.

    Parameters
    ----------
    surface : callable
        Signed distance (x, z) at the start.
    velocity : callable
        (x, z, time) -> (u, w).
    duration : float
        s; `cells` per side, at most `courant` cells per step.

    Returns
    -------
    level_set : (cells + 1, cells + 1) array
        At the nodes, after `duration`; the volume is not corrected.
    """
    h = 1.0 / cells
    x, z = np.meshgrid(h * np.arange(cells + 1), h * np.arange(cells + 1), indexing="ij")
    phi = surface(x, z)
    fastest = np.hypot(*velocity(x, z, 0.0)).max()
    count = math.ceil(duration * fastest / (courant * h))
    dt = duration / count
    travel = 0.0
    for step in range(count):
        u, w = velocity(x, z, (step + 0.5) * dt)
        level_set.advect(phi, u + 0.0 * x, w + 0.0 * x, dt, h, h)
        heed_interrupt()
        travel += np.hypot(u, w).max() * dt / h
        if travel >= redistancing.RESTORE_AFTER:
            redistancing.reinitialise(phi, redistancing.SWEEPS, h, h)
            travel = 0.0
    return phi


def surface_errors(phi: np.ndarray, expected: np.ndarray) -> Any:
    """(area error, symmetric difference) of two surfaces, relative to the area."""
    found, wanted = cell_fractions(phi), cell_fractions(expected)
    area = wanted.sum()
    return float(found.sum() / area - 1.0), float(np.abs(found - wanted).sum() / area)
