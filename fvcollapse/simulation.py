"""One collapse: the case, the state, and the steps that advance it. No files; failures are named.

The order of a step stands in `fvcollapse.step.advance`: surface, momentum advection, gate, then gravity, pressure,
viscosity and every friction together in one implicit solve, so that a static state stays static for any time step; at
last the velocity is continued beyond the surface for the next step. Steps are taken many at a time (`march`).
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fvcollapse.effects.catalogue import effects_on
from fvcollapse.errors import NumericalError
from fvcollapse.march import (
    BREAKS_LAW,
    GO_ON,
    LOG,
    NEEDS_ROOM,
    PLACE,
    SETTLE,
    SPEED,
    VOLUME,
    Plan,
    march,
    marcher,
)
from fvcollapse.measure.series_row import ROW, reading_of
from fvcollapse.step import quantities
from fvcollapse.step.acceptance import problem_of
from fvcollapse.step.advance import DONE, REFUSED, STAGES, TOO_SHORT, StepRecord
from fvcollapse.step.compiled import from_python
from fvcollapse.step.constants import constants_of
from fvcollapse.step.domain import allocate, make_room
from fvcollapse.step.energy import energies
from fvcollapse.step.flow import KINETIC, POTENTIAL, flow_of
from fvcollapse.step.grid import Grid
from fvcollapse.step.guards import broken_law, broken_words, fastest_place, watch_of
from fvcollapse.step.initial import HALO, initial_grid, initial_state
from fvcollapse.step.plain_terms import stages_with
from fvcollapse.step.settling import settling_flow
from fvcollapse.step.state import State
from fvcollapse.step.terms import terms_of
from fvcollapse.step.time_step import explain_short_step

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


ENERGIES, BROKEN_LAW = from_python(energies), from_python(broken_law)


class Simulation:
    """A case in motion.

    Parameters
    ----------
    case : Case
    state : State, optional
        Where to continue; without it the column at rest, in static equilibrium behind the closed
        gate.
    stages : Stages, optional
        Other stages than those of a collapse.

    Attributes
    ----------
    row : (len(ROW),) array
        The series at the start (`fvcollapse.measure.series_row`).
    """

    def __init__(self, case: "Case", state: Any = None, stages: Any = STAGES) -> None:
        self.case, self.terms = case.resolved, terms_of(case.resolved)
        self.constants, self.reading = constants_of(self.case), reading_of(self.case)
        self.stages = stages_with(stages, self.case, self.terms)
        self._march = march if self.stages is STAGES else marcher(self.stages)
        self._read_constants()
        given = state is not None
        self.state = state if given else initial_state(self.case, initial_grid(self.case))
        for _, start in self.terms.start:
            start(self.state, self.case)
        self._energy, self._memory = np.zeros(2), np.zeros(0)
        self.watch = watch_of(self.case, 0.0)
        allocate(self)
        self.row = self._begin(PLACE if given else SETTLE)
        self.watch = watch_of(self.case, self._energy.sum())

    def _read_constants(self):
        constants, response = self.constants, self.constants.balance.response
        self.spacing, self.material = (constants.dx, constants.dz), constants.material
        self.halo = HALO if self.case.boundary.ends == "periodic" else 0
        self.gate_column, self.lift, self.layer = (
            constants.gate_column,
            constants.lift,
            constants.layer,
        )
        self.response, self.packing_0 = response, constants.packing_0
        self.gravity = constants.balance.gx, constants.balance.gz

    def _begin(self, begin):
        """Geometry and energy are those of the state: placed, or settled behind the closed gate; return the series.

        The column settles with all friction at work: static pressure, then at rest.
        """
        flow, log, rows = self.flow(), np.empty((0, len(LOG))), np.empty((1, len(ROW)))
        if begin == SETTLE:
            flow = settling_flow(flow, self.constants.soft_rate)
        plan = Plan(0.0, self.reading, self.watch, guarded=False, begin=begin)
        steps = march if begin == SETTLE else self._march
        steps(flow, plan, log, rows, self._memory)
        return rows[0]

    def watch_energy(self, series: Mapping[str, Any]) -> None:
        """The guards watch the energy of the start of the record of a run that is continued."""
        start = series["kinetic_energy"][0] + series["potential_energy"][0]
        self.watch = watch_of(self.case, start)

    # -- steps ---------------------------------------------------------------------------------------

    def advance(self, time_limit: float) -> StepRecord:
        """One step, never beyond `time_limit` (s).

        Returns
        -------
        StepRecord

        Raises
        ------
        NumericalError
            If the solve fails or stays above the error limit after five halvings of the step; the
            state is then the last good one.
        """
        marched = self.march(time_limit, 1, guarded=False)
        if marched.problem is not None:
            raise marched.problem
        return marched.records[0]

    def march(self, time_limit: float, steps: int, guarded: bool = True) -> "Marched":
        """Take steps until `time_limit` (s), at most so many; a step that fails ends the march.

        Parameters
        ----------
        time_limit : float
            s.
        steps : int
        guarded : bool
            Whether the guards (`fvcollapse.step.guards`) refuse what no collapse can do. The state is then left at
            what they refuse.

        Returns
        -------
        Marched
        """
        plan = Plan(float(time_limit), self.reading, self.watch, guarded, GO_ON)
        log, rows = np.empty((steps, len(LOG))), np.empty((steps, len(ROW)))
        taken, problem, needs_room = 0, None, True
        while needs_room and problem is None:
            count, good, problem, room = self._march_on(plan, log[taken:], rows[taken:])
            taken += count
            needs_room = room is not None
            if needs_room:
                try:
                    make_room(self, room)
                except NumericalError as error:
                    problem = error
        records = [record_of(row) for row in log[:taken].tolist()]
        return Marched(records, rows[:taken], good, problem)

    def _march_on(self, plan, log, rows):
        """Steps on the present grid: how many; the last good state; what went wrong, if anything; the `Room` needed."""
        start, energy = self.state, self._energy.copy()
        before = start.copy()  # takes the state before each step
        self.state = start.copy()
        flow = self._flow(before)
        try:
            ended, self._memory = self._march(flow, plan, log, rows, self._memory)
        except ArithmeticError as error:  # of a compiled kernel
            self.state, self._energy, self._memory = start, energy, np.zeros(0)
            return 0, start, NumericalError(f"{error} in a kernel", time=start.time), None
        if ended.code == NEEDS_ROOM:
            return ended.steps, self.state, None, ended.room
        problem = self._problem(ended, flow, rows[min(ended.steps, len(rows) - 1)])
        return ended.steps, before if ended.code == BREAKS_LAW else self.state, problem, None

    def _problem(self, ended, flow, row):
        """The error of a march that has ended with a step that failed, whose series are `row`; None if none has."""
        if ended.code == DONE:
            return None
        time = self.state.time
        if ended.code == TOO_SHORT:
            return explain_short_step(flow, [effect.name for effect, _ in effects_on(self.case)])
        if ended.code == REFUSED:
            problem = problem_of(ended.outcome, self.constants)
            return NumericalError(problem, "in the momentum solve", time)
        broken = BROKEN_LAW(flow, self.watch, row[VOLUME], row[SPEED])
        return NumericalError(broken_words(*broken), fastest_place(self), time)

    # -- what the kernels see ------------------------------------------------------------------------

    def flow(self) -> Any:
        """The `Flow` of the present state: its arrays themselves."""
        return self._flow(self.state.copy())

    def _flow(self, before):
        arrays = self._energy, self.carrier, self.geometry, self.work, self.unit_packing
        return flow_of(self.state, before, arrays, self.constants)

    def place(self) -> None:
        """The geometry is that of the present surface, with the gate where it is now."""
        energy = self._energy.copy()
        self._begin(PLACE)
        self._energy[:] = energy

    # -- what is read --------------------------------------------------------------------------------

    @property
    def grid(self) -> Grid:
        """Current grid; it grows with the flow."""
        return Grid(*self.state.pressure_filled.shape, *self.spacing)

    @property
    def energy(self):
        """Kinetic and potential energy after the last step, J/m."""
        return {
            "kinetic": float(self._energy[KINETIC]),
            "potential": float(self._energy[POTENTIAL]),
        }

    @energy.setter
    def energy(self, values):
        self._energy[KINETIC], self._energy[POTENTIAL] = values["kinetic"], values["potential"]

    def energies(self) -> dict[str, float]:
        """Kinetic and potential energy of the present state, J/m; see `fvcollapse.step.energy.energies`."""
        kinetic, potential = ENERGIES(self.flow())
        return {"kinetic": kinetic, "potential": potential}

    def packing(self) -> np.ndarray:
        """Local density over density_bulk, (nx, nz); 1 in an incompressible mass."""
        if self.state.solid_fraction is None:
            return self.unit_packing
        return self.state.solid_fraction / self.constants.fraction_bulk

    def cell_quantities(self) -> dict[str, np.ndarray]:
        """Fields at the cell centres; see `fvcollapse.step.quantities.cell_quantities`."""
        return quantities.cell_quantities(self.flow())

    def max_speed(self) -> float:
        """Largest velocity component on the faces of the grains, m/s."""
        u = self.state.u[self.geometry.index_u >= 0]
        w = self.state.w[self.geometry.index_w >= 0]
        return max(np.abs(u).max(initial=0.0), np.abs(w).max(initial=0.0))


class Marched(NamedTuple):
    """What a march has done: a record and a row of the series for every step; the last good state; why it ended.

    `problem` is None if no step has failed.
    """

    records: list
    rows: np.ndarray
    state: State
    problem: NumericalError | None


def record_of(row: Any) -> StepRecord:
    """The `StepRecord` of a line of the log of `march`."""
    time, dt, sweeps, residual, divergence, capped, added = row
    sweeps = int(sweeps)
    return StepRecord(time, dt, sweeps, sweeps, residual, divergence, bool(capped), added)
