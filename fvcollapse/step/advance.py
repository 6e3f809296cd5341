"""The algorithm of a step: its stages, and the order in which they act.

A stage is a function of a simulation, which holds case, state, geometry and scratch arrays; its docstring says what
holds afterwards. `STAGES` are those of a collapse. A simulation may be given others, for a flow in a box, say, or to
take their time.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.errors import NumericalError

from . import quantities
from .arrays import largest
from .balance import SPEED_SCALE, balance_of
from .domain import fit_grid, place, repeat
from .energy import loss_of_step, work_of_step
from .extrapolation import (
    LAYERS,
    SOLENOIDAL_LAYERS,
    close_divergence,
    extrapolate,
    mark_known,
)
from .momentum import advect_momentum
from .solution import solve
from .surface import move_surface
from .time_step import (
    fit_to,
    limit_advection,
    limit_gate,
    limit_surface_wave,
    shortest,
)

RESIDUAL_TOLERANCE = 1.0e-3  # of the weight per volume; sound solves leave less than 1e-5
CHANGE_LIMIT = 0.1  # change of the last sweep, relative to the largest speed, that refuses a step
# Of sqrt(g h0). The sweeps of slower grains may stall, by a tenth of this speed: behind an opening gate they converge
# neither with steps down to 2e-6 s nor with 200 sweeps. The effect on the flow is gone after 0.1 s.
SLOW = 0.1
HALVINGS = 5


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


# -- the stages ----------------------------------------------------------------------------------


def choose_step(simulation, time_limit):
    """Return the longest step, s, that all limits allow on the way to `time_limit` (s)."""
    case, (dx, dz), state = simulation.case, simulation.spacing, simulation.state
    h = min(dx, dz)
    fastest = max(largest(state.u), largest(state.w))  # beyond the surface too
    limits = {
        "the case": case.longest_step,
        f"a speed of {fastest:.3g} m/s": limit_advection(
            simulation.shape_factor * fastest, case.time.cfl, h
        ),
        "the free surface": limit_surface_wave(GRAVITY, h),
    }
    limits |= {name: limit(state) for name, limit in simulation.terms.limit}
    dt = shortest(limits, case.longest_step, state.time)
    dt = min(dt, 1.1 * state.dt if state.dt > 0.0 else 0.1 * case.longest_step)
    top = simulation.grid.nz * dz
    uncovered = limit_gate(simulation.lift, state.time, top, dz, fit_to(time_limit, state.time, dt))
    return min(dt, uncovered)


def carry_momentum(simulation, old_level_set, packing, dt):
    """Return the velocity (u*, w*) that the mass between the old and the new surface has after dt (s), m/s."""
    state = simulation.state
    u_star, w_star = np.empty_like(state.u), np.empty_like(state.w)
    advect_momentum(
        u_star,
        w_star,
        state.u,
        state.w,
        state.bed_slip,
        simulation.geometry.aperture,
        old_level_set,
        state.level_set,
        packing,
        dt,
        *simulation.spacing,
        simulation.shape_factor,
    )
    return u_star, w_star


def act_before_solve(simulation, u_star, w_star, balance):
    """Return the impulses of the terms that act between advection and solve, and the balance that is left for it."""
    impulses = []
    for _, before_solve in simulation.terms.before_solve:
        impulse, balance = before_solve(simulation, u_star, w_star, balance)
        impulses += [] if impulse is None else [impulse]
    return impulses, balance


def finish_terms(simulation, dt):
    """The fields of the effects are those at the end of the step."""
    for _, finish in simulation.terms.finish:
        finish(simulation, dt)
    state = simulation.state
    repeat(simulation, *(getattr(state, name) for name in state.effect_fields()))


def book_energy(simulation, u_star, w_star, impulses, balance):
    """The energy of the step is booked: work against each resistance, and what the discretisation took; return it."""
    state, energy = simulation.state, simulation.energies()
    work = work_of_step(simulation, impulses, balance)
    loss = loss_of_step(simulation, energy, u_star, w_star, balance)
    for kind, terms in (("work", work), ("loss", loss)):
        for name, value in terms._asdict().items():
            total = getattr(state, f"{kind}_{name}") + float(value)
            setattr(state, f"{kind}_{name}", total)
    return energy


def continue_velocity(simulation):
    """The velocity is known beyond the surface too, as far as the next step reaches."""
    state, geometry = simulation.state, simulation.geometry
    known_u, known_w = np.empty(state.u.shape, np.int64), np.empty(state.w.shape, np.int64)
    mark_known(
        known_u,
        known_w,
        geometry,
        simulation.work.constrained,
        simulation.case.numerics.film_thickness,
        simulation.spacing[1],
    )
    extrapolate(state.u, known_u, LAYERS)
    extrapolate(state.w, known_w, LAYERS)
    if simulation.layer > 0.0:
        state.u[-1] = 0.0  # the wall that closes the layer
    repeat(simulation, state.u, state.w)
    close_divergence(
        state.u, state.w, known_u, known_w, geometry.filled, SOLENOIDAL_LAYERS, *simulation.spacing
    )


class Stages(NamedTuple):
    """The stages of a step, in the order in which they act."""

    fit_grid: Callable = fit_grid
    choose_step: Callable = choose_step
    move_surface: Callable = move_surface
    carry_momentum: Callable = carry_momentum
    place: Callable = place
    act_before_solve: Callable = act_before_solve
    solve: Callable = solve
    finish_terms: Callable = finish_terms
    book_energy: Callable = book_energy
    continue_velocity: Callable = continue_velocity


STAGES = Stages()


# -- a step --------------------------------------------------------------------------------------


def advance(simulation, start, dt):
    """Take one step of dt (s) from the state `start`, which stays as it is; the state is then a changed copy.

    Returns
    -------
    (Outcome, float, dict)
        What the solve reports; the correction of the volume, m2; the energies at the end, J/m.
    """
    stages = simulation.stages
    simulation.state = state = start.copy()
    repeat(simulation, state.level_set, state.u, state.w)
    packing = simulation.packing()

    correction = stages.move_surface(simulation, dt)
    predicted = stages.carry_momentum(simulation, start.level_set, packing, dt)
    stages.place(simulation, state.time + dt)

    balance = balance_of(simulation, dt)
    impulses, balance = stages.act_before_solve(simulation, *predicted, balance)
    outcome = stages.solve(simulation, *predicted, impulses, balance)
    stages.finish_terms(simulation, dt)

    solved = stages.book_energy(simulation, *predicted, impulses, balance)
    stages.continue_velocity(simulation)
    kinetic = quantities.kinetic_energy(
        state, simulation.geometry, balance.density, *simulation.spacing
    )
    state.loss_advection += float(solved["kinetic"] - kinetic)
    return outcome, correction, solved | {"kinetic": kinetic}


def advance_safely(simulation, time_limit):
    """Take one step, shorter ones where the solve fails; the state then holds time and length of the step.

    Returns
    -------
    StepRecord

    Raises
    ------
    NumericalError
        If the solve fails or stays above the error limit after `HALVINGS` halvings of the step; the
        state is then the last good one.
    """
    start = simulation.state
    dt = fit_to(time_limit, start.time, simulation.stages.choose_step(simulation, time_limit))
    for _ in range(HALVINGS + 1):
        outcome, correction, energy = advance(simulation, start, dt)
        change = change_of(outcome, simulation.case)
        if outcome.info == 0 and change <= CHANGE_LIMIT:
            break
        dt *= 0.5
    problem = problem_of(outcome, change, simulation.case)
    if problem:
        simulation.state = start
        raise NumericalError(problem, "in the momentum solve", start.time)
    state, simulation.energy = simulation.state, energy
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


def problem_of(outcome, change, case):
    """Why the outcome of a solve is refused; "" if it is not."""
    if outcome.info != 0:
        return (
            f"the factorisation meets pivot {outcome.info}, which is not positive, also after "
            f"{HALVINGS} halvings of the time step"
        )
    if not change <= CHANGE_LIMIT:  # true for NaN
        return (
            f"the nonlinear sweeps still change the velocity by {change:.2g} (limit "
            f"{CHANGE_LIMIT}) after {HALVINGS} halvings of the time step"
        )
    if case.numerics.method == "coupled" and not outcome.residual <= RESIDUAL_TOLERANCE:
        return (
            f"the linear solve leaves {outcome.residual:.2g} of the weight (limit "
            f"{RESIDUAL_TOLERANCE})"
        )
    return ""


def change_of(outcome, case):
    """Change of the velocity in the last sweep, relative to the largest speed, at least that of slow grains."""
    if outcome.change <= CHANGE_LIMIT:
        return outcome.change
    scale = math.sqrt(GRAVITY * case.geometry.height_0)
    change = outcome.change * max(outcome.speed, SPEED_SCALE * scale)
    return change / max(outcome.speed, SLOW * scale)
