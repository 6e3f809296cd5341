"""The algorithm of a step: its stages, and the order in which they act.

A stage is a function of a `Flow` (`fvcollapse/step/flow.py`), which holds state, geometry and scratch arrays; its
docstring says what holds afterwards. `STAGES` are those of a collapse. They are kernels, and `stepper` compiles them
into one. A simulation may be given others in plain Python, for a flow in a box, say, or to take their time: the step
is then the same function, interpreted.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .acceptance import CHANGE_LIMIT, HALVINGS, change_of, is_sound
from .arrays import copy
from .balance import balance_with
from .compiled import from_python, inner_jit
from .coupled import Outcome
from .domain import WALL, place, room_needed
from .energy import book_energy, kinetic_energy
from .extrapolation import (
    LAYERS,
    SOLENOIDAL_LAYERS,
    close_divergence,
    extrapolate,
    mark_known,
)
from .flow import (
    DT,
    KINETIC,
    LOSS_ADVECTION,
    POTENTIAL,
    STEP,
    TIME,
    copy_all,
    packing_of,
    set_carrier,
)
from .gate import gate_velocity
from .geometry import repeat
from .momentum import advect_momentum
from .solution import solve
from .surface import move_surface
from .terms import act_before_solve, finish_terms
from .time_step import choose_step, fit_to

SOFT_STEPS = 10  # first steps, whose sweeps begin with a larger regularisation
SAME_TIME = 1.0e-12  # s

# How a step ends
DONE, TOO_SHORT, REFUSED = 0, 1, 2


class Step(NamedTuple):
    """How a step has ended: its length, s, what its last solve reports, and the volume that was added, m2."""

    code: int
    dt: float
    outcome: Outcome
    added: float


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


# -- the stages that stand in no other file --------------------------------------------------------


@inner_jit()
def carry_momentum(flow, packing, dt):
    """Return the velocity (u*, w*) that the mass between the old and the new surface has after dt (s), m/s.

    `packing` (nx, nz) is the local density over density_bulk at the start of the step.
    """
    fields, constants = flow.fields, flow.constants
    u_star, w_star = np.empty_like(fields.u), np.empty_like(fields.w)
    advect_momentum(
        u_star,
        w_star,
        fields.u,
        fields.w,
        flow.carrier.u,
        flow.carrier.w,
        fields.bed_slip,
        flow.geometry.aperture,
        flow.before.level_set,
        fields.level_set,
        packing,
        dt,
        constants.dx,
        constants.dz,
        constants.shape_factor,
        constants.right_end == WALL,
    )
    return u_star, w_star


@inner_jit()
def continue_velocity(flow):
    """The velocity is known beyond the surface too, as far as the next step reaches."""
    fields, geometry, constants = flow.fields, flow.geometry, flow.constants
    u, w, dx, dz = fields.u, fields.w, constants.dx, constants.dz
    known_u, known_w = np.empty(u.shape, np.int64), np.empty(w.shape, np.int64)
    constrained = flow.work.constrained
    film = constants.film_thickness
    closed_end = constants.right_end == WALL or constants.layer > 0.0  # a wall closes the layer
    mark_known(known_u, known_w, geometry, constrained, film, dz, closed_end)
    extrapolate(u, known_u, LAYERS)
    extrapolate(w, known_w, LAYERS)
    repeat(geometry, u)
    repeat(geometry, w)
    close_divergence(u, w, known_u, known_w, geometry.filled, SOLENOIDAL_LAYERS, dx, dz)


@inner_jit()
def balance_of(flow, dt):
    """`Balance` of the step of dt (s) that the state is in."""
    constants, numbers = flow.constants, flow.fields.numbers
    balance = constants.balance
    soft = constants.soft_rate if numbers[STEP] < SOFT_STEPS else 0.0
    gate_speed = gate_velocity(numbers[TIME] + dt, constants.lift)
    return balance_with(balance, dt, soft, gate_speed, balance.wall_strength)


class Stages(NamedTuple):
    """The stages of a step, in the order in which they act."""

    room_needed: Callable = room_needed
    choose_step: Callable = choose_step
    move_surface: Callable = move_surface
    carry_momentum: Callable = carry_momentum
    place: Callable = place
    act_before_solve: Callable = act_before_solve
    solve: Callable = solve
    finish_terms: Callable = finish_terms
    book_energy: Callable = book_energy
    continue_velocity: Callable = continue_velocity


COMPILED = Stages()
STAGES = Stages(*(from_python(stage) for stage in COMPILED))  # the same, to be called from Python


# -- a step --------------------------------------------------------------------------------------


def stepper(stages):
    """The functions (advance, take_step) of one step with these stages; see their docstrings.

    Parameters
    ----------
    stages : Stages
        Kernels, or functions of which some are plain Python.
    """
    (
        _,
        choose_step,
        move_surface,
        carry_momentum,
        place,
        act_before_solve,
        solve,
        finish_terms,
        book_energy,
        continue_velocity,
    ) = stages
    jit, helpers = (
        (inner_jit(inline="always"), _KERNELS) if stages is COMPILED else (_as_it_is, _FROM_PYTHON)
    )
    (
        repeat,
        packing_of,
        set_carrier,
        balance_of,
        kinetic_energy,
        copy,
        copy_all,
        fit_to,
        change_of,
        is_sound,
    ) = helpers

    @jit
    def advance(flow, dt, memory):
        """Take one step of dt (s); `flow.before` holds its start.

        Returns
        -------
        (Outcome, float, float, float, (m,) array)
            What the solve reports; the volume that was added, m2; kinetic and potential energy at the end, J/m; the
            memory of the next solve.
        """
        fields = flow.fields
        repeat(flow.geometry, fields.level_set)
        repeat(flow.geometry, fields.u)
        repeat(flow.geometry, fields.w)
        packing = packing_of(flow)
        set_carrier(flow, dt)
        moved = move_surface(flow, dt)
        u_star, w_star = carry_momentum(flow, packing, dt)
        ends = place(flow, fields.numbers[TIME] + dt, False)

        balance = balance_of(flow, dt)
        impulse, left = act_before_solve(flow, u_star, w_star, balance)
        outcome, memory = solve(flow, ends, u_star, w_star, impulse, left, memory)
        finish_terms(flow, dt)

        solved, potential = book_energy(flow, moved, u_star, w_star, impulse, left)
        continue_velocity(flow)
        kinetic = kinetic_energy(flow)
        fields.numbers[LOSS_ADVECTION] += solved - kinetic
        return outcome, moved.added, kinetic, potential, memory

    @jit
    def take_step(flow, time_limit, memory):
        """Take one step, shorter ones where the solve fails; the state then holds time and length of the step.

        A step that fails after `HALVINGS` halvings, too, leaves the state as it was.

        Returns
        -------
        (Step, (m,) array)
            The second is the memory of the next solve.
        """
        numbers, constants = flow.fields.numbers, flow.constants
        time = numbers[TIME]
        dt = choose_step(flow, time_limit)
        if not dt > 0.0:
            nothing = Outcome(0, math.nan, 0.0, 0.0, math.nan, 0, False)
            return Step(TOO_SHORT, dt, nothing, 0.0), memory
        dt = fit_to(time_limit, time, dt)
        copy_all(flow.saved, flow.store)
        for halving in range(HALVINGS + 1):
            if halving > 0:
                dt *= 0.5
                copy_all(flow.store, flow.saved)
            outcome, added, kinetic, potential, memory = advance(flow, dt, memory)
            if outcome.info == 0 and change_of(outcome, constants) <= CHANGE_LIMIT:
                break
        if not is_sound(outcome, constants):
            copy_all(flow.store, flow.saved)
            return Step(REFUSED, dt, outcome, added), memory
        end = time + dt
        numbers[TIME] = time_limit if abs(end - time_limit) < SAME_TIME else end
        numbers[STEP] += 1
        numbers[DT] = dt
        copy(flow.fields.u_before, flow.before.u)
        copy(flow.fields.w_before, flow.before.w)
        flow.energy[KINETIC], flow.energy[POTENTIAL] = kinetic, potential
        return Step(DONE, dt, outcome, added), memory

    return advance, take_step


def _as_it_is(function):
    return function


_KERNELS = (
    repeat,
    packing_of,
    set_carrier,
    balance_of,
    kinetic_energy,
    copy,
    copy_all,
    fit_to,
    change_of,
    is_sound,
)
_FROM_PYTHON = tuple(from_python(kernel) for kernel in _KERNELS)
