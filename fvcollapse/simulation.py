"""One collapse: the state, and the step that advances it. No files; failures are named.

Order of a step: surface, momentum advection, gate, then gravity, pressure, viscosity and every
friction together in one implicit solve, so that a static state stays static for any time step; at
last the velocity is continued beyond the surface for the next step.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.errors import NumericalError
from fvcollapse.step import coupled, level_set, quantities
from fvcollapse.step.arrays import largest
from fvcollapse.step.balance import SPEED_SCALE, balance_of
from fvcollapse.step.banded import allocate_system, clear
from fvcollapse.step.dilatancy import initial_fraction, limit_dilatancy
from fvcollapse.step.energy import Outflow, loss_of_step, work_of_step
from fvcollapse.step.erodible_bed import extend_layer, layer_thickness, moves_near_end
from fvcollapse.step.extrapolation import (
    LAYERS,
    SOLENOIDAL_LAYERS,
    close_divergence,
    extrapolate,
    mark_known,
)
from fvcollapse.step.gate import gate_height, gate_lift, hold_at_gate, open_fractions
from fvcollapse.step.geometry import allocate_geometry, repeat_columns, wetted_edge
from fvcollapse.step.grain_response import (
    carry_response,
    extend_response,
    finish_response,
    prepare_response,
    response_of,
    start_response,
)
from fvcollapse.step.grid import Grid, gate_column
from fvcollapse.step.guards import refuse_growth
from fvcollapse.step.initial import HALO, MARGIN, initial_grid, initial_state, initial_volume
from fvcollapse.step.lateral_friction import brake_before_solve
from fvcollapse.step.momentum import advect_momentum
from fvcollapse.step.place import place
from fvcollapse.step.rheology import material
from fvcollapse.step.state import crop, grow
from fvcollapse.step.time_step import (
    fit_to,
    limit_advection,
    limit_gate,
    limit_surface_wave,
    shortest,
)
from fvcollapse.step.transverse_profile import shape_factor_of

RESIDUAL_TOLERANCE = 1.0e-3  # of the weight per volume; sound solves leave less than 1e-5
CHANGE_LIMIT = 0.1  # change of the last sweep, relative to the largest speed, that refuses a step
# of sqrt(g h0): slower grains may stall, by a tenth of this speed; behind an opening gate neither shorter steps
# (down to 2e-6 s) nor 200 sweeps make them converge, and nothing of it is left after 0.1 s
SLOW = 0.1
HALVINGS = 5
GROWTH = 16
SPARE = 4  # rows in excess of the margin before they go: memory that no cache holds is what a step waits for


class StepRecord(NamedTuple):
    """What one step reports; `residual` is the relative change of the velocity in the last nonlinear sweep."""

    time: float
    dt: float
    sweeps: int
    linear_iterations: int
    residual: float
    divergence: float
    capped: bool
    volume_correction: float


class Simulation:
    """A case in motion.

    Parameters
    ----------
    case : Case
    state : State, optional
        Where to continue; without it the column at rest, in static equilibrium behind the closed
        gate.
    """

    def __init__(self, case, state=None):
        self.case = case = case.resolved
        grid = initial_grid(case)
        self.spacing = grid.dx, grid.dz
        self.halo = HALO if case.boundary.ends == "periodic" else 0
        self.gate_column = -1 if self.halo else gate_column(case)
        self.lift, self.layer = gate_lift(case), layer_thickness(case)
        self.shape_factor = shape_factor_of(case)
        self.material = material(case)
        self.response = response_of(case)
        self.packing_0 = initial_fraction(case) / self.response.dilatancy.fraction_bulk
        slope = math.radians(case.geometry.slope_angle_deg)
        self.gravity = GRAVITY * math.sin(slope), -GRAVITY * math.cos(slope)
        self.state = initial_state(case, grid) if state is None else state
        start_response(self.state, case)
        self._allocate()
        if state is None:
            self._settle()
        else:
            self._place(state.time)
        self.energy, self.outflow = self.energies(), Outflow(0.0, 0.0)

    @property
    def grid(self):
        """Current grid; it grows with the flow."""
        return Grid(*self.state.pressure_filled.shape, *self.spacing)

    def _allocate(self):
        nx, nz = self.state.pressure_filled.shape
        self.geometry = allocate_geometry(nx, nz, self.halo)
        self.work = coupled.allocate_work(nx, nz)
        self.unit_packing = np.ones((nx, nz))
        self.buffer = np.empty(0)

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

    # ---------------------------------------------------------------- one step

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
        self._fit_grid()
        start = self.state  # each step changes a copy of it
        try:
            return self._advance(start, time_limit)
        except ArithmeticError as error:  # of a compiled kernel
            self.state = start
            raise NumericalError(f"{error} in a kernel", time=start.time) from error

    def _advance(self, start, time_limit):
        dt = fit_to(time_limit, start.time, self._time_step(time_limit))
        for _ in range(HALVINGS + 1):
            outcome, correction, energy = self._try_step(start, dt)
            if outcome.info == 0 and self._last_change(outcome) <= CHANGE_LIMIT:
                break
            dt *= 0.5
        else:
            self.state = start
            if outcome.info != 0:
                raise NumericalError(
                    f"the factorisation meets pivot {outcome.info}, which is not positive, also after "
                    f"{HALVINGS} halvings of the time step",
                    "in the momentum solve",
                    start.time,
                )
            raise NumericalError(
                f"the nonlinear sweeps still change the velocity by {self._last_change(outcome):.2g} (limit "
                f"{CHANGE_LIMIT}) after {HALVINGS} halvings of the time step",
                "in the momentum solve",
                start.time,
            )
        if self.case.numerics.method == "coupled" and not outcome.residual <= RESIDUAL_TOLERANCE:
            self.state = start
            raise NumericalError(
                f"the linear solve leaves {outcome.residual:.2g} of the weight (limit "
                f"{RESIDUAL_TOLERANCE})",
                "in the momentum solve",
                start.time,
            )
        state, self.energy = self.state, energy
        state.time = time_limit if abs(start.time + dt - time_limit) < 1e-12 else start.time + dt
        state.step = start.step + 1
        state.dt = dt
        return StepRecord(
            state.time,
            dt,
            outcome.sweeps,
            outcome.sweeps,
            outcome.change,
            outcome.divergence,
            not outcome.settled,
            correction,
        )

    def _last_change(self, outcome):
        """Change of the velocity in the last sweep, relative to the largest speed, at least that of slow grains."""
        if outcome.change <= CHANGE_LIMIT:
            return outcome.change
        scale = math.sqrt(GRAVITY * self.case.geometry.height_0)
        change = outcome.change * max(outcome.speed, SPEED_SCALE * scale)
        return change / max(outcome.speed, SLOW * scale)

    def _try_step(self, start, dt):
        self.state = state = start.copy()
        dx, dz = self.spacing
        self._repeat(state.level_set, state.u, state.w)
        packing = self._packing()
        correction = self._move_surface(dt)
        u_star, w_star = self._advect_momentum(start.level_set, packing, dt)
        self._place(state.time + dt)
        balance = self._balance(dt)
        impulse = self._split_friction(u_star, w_star, balance)
        if impulse is not None:
            balance = balance._replace(wall_strength=0.0)
        outcome = self._solve(u_star, w_star, impulse, balance)
        self._finish_response(dt)
        solved = self._book_energy(u_star, w_star, impulse, balance)
        self._continue_velocity()
        kinetic = quantities.kinetic_energy(state, self.geometry, balance.density, dx, dz)
        state.loss_advection += float(solved["kinetic"] - kinetic)
        return outcome, correction, solved | {"kinetic": kinetic}

    def _time_step(self, time_limit):
        case, (dx, dz), time = self.case, self.spacing, self.state.time
        h = min(dx, dz)
        fastest = max(largest(self.state.u), largest(self.state.w))  # beyond the surface too
        limits = {
            "the case": case.longest_step,
            f"a speed of {fastest:.3g} m/s": limit_advection(
                self.shape_factor * fastest, case.time.cfl, h
            ),
            "the free surface": limit_surface_wave(GRAVITY, h),
            "dilatancy": limit_dilatancy(self.state.dilation_rate),
        }
        dt = shortest(limits, case.longest_step, time)
        dt = (
            min(dt, 1.1 * self.state.dt)
            if self.state.dt > 0.0
            else min(dt, 0.1 * case.longest_step)
        )
        return min(
            dt, limit_gate(self.lift, time, self.grid.nz * dz, dz, fit_to(time_limit, time, dt))
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

    # ---------------------------------------------------------------- its parts

    def _packing(self):
        """Local density over density_bulk, (nx, nz); 1 in an incompressible mass."""
        if self.state.solid_fraction is None:
            return self.unit_packing
        return self.state.solid_fraction / self.response.dilatancy.fraction_bulk

    def _finish_response(self, dt):
        """Fields that the effects carry, after the solve."""
        state, work = self.state, self.work
        finish_response(
            work.response,
            state,
            work.e_centre,
            work.g_node,
            self.geometry,
            self.material,
            self.response,
            dt,
            *self.spacing,
        )
        self._repeat(*(getattr(state, name) for name in state.effect_fields()))

    def _move_surface(self, dt):
        state, (dx, dz) = self.state, self.spacing
        phi_old = state.level_set.copy() if state.effect_fields() else None
        u_node, w_node = np.empty_like(state.level_set), np.empty_like(state.level_set)
        level_set.node_velocity(u_node, w_node, state.u, state.w)
        u_surface, w_surface = np.empty_like(u_node), np.empty_like(w_node)
        level_set.carry_from_surface(
            u_surface,
            w_surface,
            u_node,
            w_node,
            state.level_set,
            level_set.BAND * max(dx, dz),
            dx,
            dz,
        )
        level_set.advect(state.level_set, u_surface, w_surface, dt, dx, dz)
        speed = np.empty_like(u_node)
        fastest = level_set.node_speed(speed, u_node, w_node)
        state.travel += fastest * dt / min(dx, dz)
        state.travel_steps += 1
        if level_set.needs_restoring(state.travel, state.travel_steps):
            level_set.reinitialise(state.level_set, level_set.SWEEPS, dx, dz)
            state.travel, state.travel_steps = 0.0, 0
        self._repeat(state.level_set)
        if phi_old is not None:
            carry_response(state, self.geometry.aperture, phi_old, dt, dx, dz)
            self._repeat(*(getattr(state, name) for name in state.effect_fields()))
        self.outflow = Outflow(0.0, 0.0)
        if fastest == 0.0:
            return 0.0
        self._book_outflow(u_node, w_node, dt)
        aperture = self._aperture(state.time + dt)
        hold_at_gate(speed, state.level_set, aperture, self.gate_column)
        target = (state.volume_0 - state.volume_outflow) * self.packing_0 / (dx * dz)
        added = (
            level_set.hold_volume(
                state.level_set,
                aperture,
                speed,
                self._packing(),
                target,
                min(dx, dz),
            )
            * dx
            * dz
            / self.packing_0
        )
        state.volume_correction += abs(added)
        return added

    def _advect_momentum(self, old_level_set, packing, dt):
        """Velocity (u*, w*) after the mass between the old and the new surface has carried it for dt."""
        state = self.state
        u_star, w_star = np.empty_like(state.u), np.empty_like(state.w)
        advect_momentum(
            u_star,
            w_star,
            state.u,
            state.w,
            state.bed_slip,
            self.geometry.aperture,
            old_level_set,
            state.level_set,
            packing,
            dt,
            *self.spacing,
            self.shape_factor,
        )
        return u_star, w_star

    def _book_outflow(self, u_node, w_node, dt):
        """Volume and energy that cross an open end during the step."""
        if self.case.boundary.right_end != "open":
            return
        phi, (dx, dz) = self.state.level_set[-1], self.spacing
        speed = 0.5 * (u_node[-1, :-1] + u_node[-1, 1:])
        rise = 0.5 * (w_node[-1, :-1] + w_node[-1, 1:])
        wetted = np.array([wetted_edge(*ends) for ends in itertools.pairwise(phi)])
        packing = self._packing()[-1]
        through = np.maximum(wetted * speed, 0.0) * dz * dt * packing
        gx, gz = self.gravity
        middle = self.grid.z_nodes[:-1] + 0.5 * wetted * dz
        mass = self.case.rheology.density_bulk * through
        self.outflow = Outflow(
            float(mass @ (0.5 * (speed**2 + rise**2))),
            float(mass @ (-gx * self.grid.nx * dx - gz * middle)),
        )
        self.state.volume_outflow += through.sum() / self.packing_0
        self.state.energy_outflow += sum(self.outflow)

    def _aperture(self, time):
        """Open part of each x-face at `time`, (nx + 1, nz)."""
        aperture = np.ones_like(self.geometry.aperture)
        open_fractions(aperture, gate_height(time, self.lift), self.gate_column, self.spacing[1])
        return aperture

    def _place(self, time, closed=False):
        """Geometry of the current surface with the gate where it is at `time`."""
        height = self.lift.foot if closed else gate_height(time, self.lift)
        open_fractions(self.geometry.aperture, height, self.gate_column, self.spacing[1])
        open_end = self.case.boundary.right_end == "open"
        self.ends = place(
            self.geometry, self.state.level_set, self._packing(), self.gate_column, open_end
        )

    def _split_friction(self, u_star, w_star, balance):
        """Change of velocity by the lateral walls before the solve; None where they act within it."""
        walls = self.case.effects.lateral_friction
        if balance.wall_strength == 0.0 or walls.scheme != "split":
            return None
        return brake_before_solve(
            u_star,
            w_star,
            self.state.pressure_filled,
            self.work,
            self.geometry,
            balance,
            coupled.MASS_FLOOR,
            *self.spacing,
        )

    def _solve(self, u_star, w_star, impulse, balance):
        if impulse is not None:
            u_star, w_star = u_star + impulse[0], w_star + impulse[1]
        if self.case.numerics.method == "coupled":
            return self._solve_coupled(u_star, w_star, balance)
        from fvcollapse.step import (
            projection,  # sparse matrices of scipy, for the reference method only
        )

        return projection.solve(
            self.state,
            self.work,
            self.ends,
            u_star,
            w_star,
            self.geometry,
            self.material,
            balance,
            *self.spacing,
        )

    def _book_energy(self, u_star, w_star, impulse, balance):
        """Energy spent during the step: work against each resistance, and what the discretisation took."""
        state, energy = self.state, self.energies()
        work = work_of_step(self.work, state, self.geometry, impulse, balance, *self.spacing)
        loss = loss_of_step(
            self.energy,
            energy,
            self.outflow,
            state,
            u_star,
            w_star,
            self.geometry,
            balance,
            *self.spacing,
        )
        for kind, terms in (("work", work), ("loss", loss)):
            for name, value in terms._asdict().items():
                total = getattr(state, f"{kind}_{name}") + float(value)
                setattr(state, f"{kind}_{name}", total)
        return energy

    def _solve_coupled(self, u_star, w_star, balance):
        state = self.state
        buffer, self.buffer = self.buffer, np.empty(0)
        band, rhs = allocate_system(self.ends, buffer)
        prepare_response(self.work.response, state, self.response)
        outcome = coupled.solve(
            state.u,
            state.w,
            state.pressure_filled,
            state.bed_slip,
            self.work,
            band,
            rhs,
            self.ends,
            u_star,
            w_star,
            self.geometry,
            self.material,
            balance,
            *self.spacing,
        )
        if outcome.info == 0 and math.isfinite(outcome.change):  # else there is NaN in it
            clear(band, self.ends)
            self.buffer = band.reshape(-1) if band.size > buffer.size else buffer
        return outcome

    def _balance(self, dt):
        return balance_of(
            self.case,
            self.state,
            dt,
            self.gravity,
            self.lift,
            self.gate_column,
            self.response,
        )

    def _continue_velocity(self):
        state = self.state
        known_u, known_w = np.empty(state.u.shape, np.int64), np.empty(state.w.shape, np.int64)
        mark_known(
            known_u,
            known_w,
            self.geometry,
            self.work.constrained,
            self.case.numerics.film_thickness,
            self.spacing[1],
        )
        extrapolate(state.u, known_u, LAYERS)
        extrapolate(state.w, known_w, LAYERS)
        if self.layer > 0.0:
            state.u[-1] = 0.0  # the wall that closes the layer
        self._repeat(state.u, state.w)
        close_divergence(
            state.u,
            state.w,
            known_u,
            known_w,
            self.geometry.filled,
            SOLENOIDAL_LAYERS,
            *self.spacing,
        )

    def _repeat(self, *fields):
        """Fill the halo of a periodic stretch."""
        if self.halo:
            for field in fields:
                repeat_columns(field, self.geometry.first, self.geometry.last)

    def _fit_grid(self):
        """Rows and columns for what the grains will reach; rows that they have left long ago go."""
        if self.halo:
            return
        rows = self.geometry.reach.max() + MARGIN
        if self.grid.nz > rows + SPARE and not self.gate_is_moving():
            self.state = self.state.copy()
            crop(self.state, int(rows))
            self._allocate()
            self._place(self.state.time)
        self._make_room()

    def _make_room(self):
        filled = self.geometry.filled
        nx, nz = filled.shape
        extra_x = extra_z = 0
        right_end = self.case.boundary.right_end
        if right_end == "grow" and self._is_near_end():
            extra_x = GROWTH
        if right_end == "error" and filled[nx - 1].any():
            raise NumericalError(
                "the mass has reached the end of the domain; lengthen boundary.domain_length",
                f"at x = {nx * self.spacing[0]:.3g} m",
                self.state.time,
            )
        if filled[:, nz - 4 :].any():
            extra_z = MARGIN
        if extra_x or extra_z:
            shape = nx + extra_x, nz + extra_z
            refuse_growth(self.case, shape, self.spacing, self.state.time)
            self.state = self.state.copy()
            grow(self.state, extra_x, extra_z)
            extend_response(self.state, self.case, nx, nz)
            self._allocate()
            if extra_x and self.layer > 0.0:
                extend_layer(self.state, extra_x, self.layer, self.grid.z_nodes, self.spacing[0])
            self._place(self.state.time)
            if extra_x and self.layer > 0.0:
                self._book_layer()

    def _is_near_end(self):
        """Whether the grains come near the far end; those of an erodible layer, whether they move there."""
        if self.layer > 0.0:
            return moves_near_end(self.state, self.geometry, MARGIN)
        return self.geometry.filled[-MARGIN:].any()

    def _book_layer(self):
        """Energy of the layer by which the domain has grown: it has flowed in."""
        before, self.energy = self.energy, self.energies()
        self.state.energy_outflow += float(before["potential"] - self.energy["potential"])

    def _settle(self):
        """Static pressure behind the closed gate, with all friction at work; then at rest."""
        state = self.state
        self._place(0.0, closed=True)
        # Both methods start from the coupled solution: exact at once, where the projection would
        # need many steps.
        self._solve_coupled(
            np.zeros_like(state.u),
            np.zeros_like(state.w),
            self._balance(1.0)._replace(max_sweeps=100, tolerance=1e-6, gate_speed=0.0),
        )
        state.u[:] = 0.0
        state.w[:] = 0.0
        state.bed_slip[:] = 0.0
        self._place(0.0)
        state.volume_0 = initial_volume(state.level_set, self.geometry.aperture, self.grid)
