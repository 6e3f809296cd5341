"""One collapse: the case, the state, and the step that advances it. No files; failures are named.

The order of a step stands in `fvcollapse.step.advance`: surface, momentum advection, gate, then gravity, pressure,
viscosity and every friction together in one implicit solve, so that a static state stays static for any time step; at
last the velocity is continued beyond the surface for the next step.
"""

import math

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.errors import NumericalError
from fvcollapse.step import quantities
from fvcollapse.step.advance import STAGES, advance_safely
from fvcollapse.step.balance import balance_of
from fvcollapse.step.dilatancy import initial_fraction
from fvcollapse.step.domain import allocate
from fvcollapse.step.energy import Outflow
from fvcollapse.step.erodible_bed import layer_thickness
from fvcollapse.step.gate import gate_height, gate_lift
from fvcollapse.step.grain_response import response_of
from fvcollapse.step.grid import Grid, gate_column
from fvcollapse.step.initial import HALO, initial_grid, initial_state, initial_volume
from fvcollapse.step.rheology import material
from fvcollapse.step.solution import solve_coupled
from fvcollapse.step.terms import terms_of
from fvcollapse.step.transverse_profile import shape_factor_of


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
    """

    def __init__(self, case, state=None, stages=STAGES):
        self.case, self.stages = case.resolved, stages
        self._read_case()
        self.state = initial_state(self.case, initial_grid(self.case)) if state is None else state
        for _, start in self.terms.start:
            start(self.state, self.case)
        allocate(self)
        if state is None:
            self._settle()
        else:
            stages.place(self, state.time)
        self.energy, self.outflow = self.energies(), Outflow(0.0, 0.0)

    def _read_case(self):
        """Constants of the run."""
        case, grid = self.case, initial_grid(self.case)
        self.spacing = grid.dx, grid.dz
        self.halo = HALO if case.boundary.ends == "periodic" else 0
        self.gate_column = -1 if self.halo else gate_column(case)
        self.lift, self.layer = gate_lift(case), layer_thickness(case)
        self.shape_factor = shape_factor_of(case)
        self.material = material(case)
        self.response, self.terms = response_of(case), terms_of(case)
        self.packing_0 = initial_fraction(case) / self.response.dilatancy.fraction_bulk
        slope = math.radians(case.geometry.slope_angle_deg)
        self.gravity = GRAVITY * math.sin(slope), -GRAVITY * math.cos(slope)

    def _settle(self):
        """Static pressure behind the closed gate, with all friction at work; then at rest."""
        state = self.state
        self.stages.place(self, 0.0, closed=True)
        # Both methods start from the coupled solution: exact at once, where the projection would
        # need many steps.
        solve_coupled(
            self,
            np.zeros_like(state.u),
            np.zeros_like(state.w),
            balance_of(self, 1.0)._replace(max_sweeps=100, tolerance=1e-6, gate_speed=0.0),
        )
        state.u[:] = 0.0
        state.w[:] = 0.0
        state.bed_slip[:] = 0.0
        self.stages.place(self, 0.0)
        state.volume_0 = initial_volume(state.level_set, self.geometry.aperture, self.grid)

    def advance(self, time_limit):
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
        self.stages.fit_grid(self)
        start = self.state  # each step changes a copy of it
        try:
            return advance_safely(self, time_limit)
        except ArithmeticError as error:  # of a compiled kernel
            self.state = start
            raise NumericalError(f"{error} in a kernel", time=start.time) from error

    @property
    def grid(self):
        """Current grid; it grows with the flow."""
        return Grid(*self.state.pressure_filled.shape, *self.spacing)

    def packing(self):
        """Local density over density_bulk, (nx, nz); 1 in an incompressible mass."""
        if self.state.solid_fraction is None:
            return self.unit_packing
        return self.state.solid_fraction / self.response.dilatancy.fraction_bulk

    def cell_quantities(self):
        """Fields at the cell centres; see `fvcollapse.step.quantities.cell_quantities`."""
        return quantities.cell_quantities(
            self.state, self.geometry, self.material, self.response, *self.spacing
        )

    def energies(self):
        """Kinetic and potential energy, J/m; see `fvcollapse.step.quantities.energies`."""
        return quantities.energies(
            self.state, self.geometry, self.case.rheology.density_bulk, self.gravity, *self.spacing
        )

    def gate_is_moving(self):
        """Whether the gate still touches the mass."""
        height = gate_height(self.state.time, self.lift)
        return self.lift.speed > 0.0 and height < self.grid.nz * self.spacing[1]

    def max_speed(self):
        """Largest velocity component on the faces of the grains, m/s."""
        u = self.state.u[self.geometry.index_u >= 0]
        w = self.state.w[self.geometry.index_w >= 0]
        return max(np.abs(u).max(initial=0.0), np.abs(w).max(initial=0.0))
