"""The terms that the effects add to a step: the stage functions of their modules, in the order of the catalogue.

The effect names its module (`Effect.term`). A module defines the stages that it needs and no others. Two act between
steps, in Python:

- `start(state, case)`: the state has the fields of the effect, unless it had them;
- `extend(state, case, nx, nz)`: cells beyond the first nx columns and nz rows hold what grains at rest hold.

The others act within the step, on a `Flow` (`fvcollapse/step/flow.py`):

- `limit(fields)`: the longest step that the term allows, s; inf if any;
- `carry(flow, dt)`: the fields have moved with the grains for dt (s), from the surface `flow.before.level_set` to
  that of `flow.fields`;
- `before_solve(flow, impulse, u_star, w_star, balance)`: fills its part of the `Impulse` that acts between advection
  and the implicit solve;
- `finish(flow, dt)`: the fields have taken what the solve left, and evolved for dt (s).

The terms of the catalogue are called by the kernels below, each where its field is present, so that one compiled step
serves all of them. A module may also define these stages in plain Python (`plain_terms`). Then the steps of the cases
with that effect are not compiled as a whole, and are slower by about a millisecond each.

Terms that answer the nonlinear sweeps are compiled into one kernel, `grain_response.respond`.
"""

import math
from importlib import import_module
from typing import NamedTuple

import numpy as np

from fvcollapse.effects.catalogue import effects_on

from . import dilatancy, friction_hysteresis, lateral_friction, nonlocal_fluidity
from .balance import balance_with
from .compiled import inner_jit, is_kernel


class Impulse(NamedTuple):
    """Change of the velocity by forces before the solve, m/s: on the x-faces and on the z-faces; (0, 0) without any.

    The work of the first pair is dissipated in the bulk, that of the second done against the lateral walls.
    """

    bulk_u: np.ndarray
    bulk_w: np.ndarray
    lateral_u: np.ndarray
    lateral_w: np.ndarray


class Terms(NamedTuple):
    """Pairs (name of the effect, function) of each stage; of those within the step, the ones in plain Python."""

    start: tuple
    extend: tuple
    limit: tuple
    carry: tuple
    before_solve: tuple
    finish: tuple


def terms_of(case):
    """The `Terms` of the effects of a case that are on."""
    modules = [
        (effect.name, import_module(f"fvcollapse.step.{effect.term}"))
        for effect, _ in effects_on(case)
        if effect.term
    ]

    def defined(stage):
        functions = [(name, getattr(module, stage, None)) for name, module in modules]
        return tuple((name, f) for name, f in functions if f is not None and not is_kernel(f))

    return Terms(*(defined(stage) for stage in Terms._fields))


@inner_jit()
def limit_terms(response, fields):
    """Longest step that the terms allow, s. Nothing of them is compiled where `response` is None."""
    if response is None:
        return math.inf
    return dilatancy.limit(fields)


@inner_jit()
def carry_terms(response, flow, dt):
    """The fields of the effects have moved with the grains for dt (s)."""
    if response is None:
        return
    if flow.fields.solid_fraction.size > 0:
        dilatancy.carry(flow, dt)
    if flow.fields.settled_share.size > 0:
        friction_hysteresis.carry(flow, dt)


@inner_jit()
def no_impulse():
    """The `Impulse` of no force."""
    none = np.zeros((0, 0))
    return Impulse(none, none, none, none)


@inner_jit()
def act_before_solve(flow, u_star, w_star, balance):
    """Return the `Impulse` of the terms that act between advection and solve, and the balance that is left for it."""
    if not (flow.constants.split_walls and balance.wall_strength > 0.0):
        return no_impulse(), balance
    none = np.zeros((0, 0))
    impulse = Impulse(none, none, np.zeros_like(u_star), np.zeros_like(w_star))
    lateral_friction.before_solve(flow, impulse, u_star, w_star, balance)
    left = balance_with(balance, balance.dt, balance.rate_start, balance.gate_speed, 0.0)
    return impulse, left


@inner_jit()
def finish_terms(flow, dt):
    """The fields of the effects are those at the end of the step."""
    finish_where_present(flow.constants.balance.response, flow, dt)


@inner_jit()
def finish_where_present(response, flow, dt):
    """See `finish_terms`; nothing of the terms is compiled where `response` is None."""
    if response is None:
        return
    fields = flow.fields
    if fields.dilation_rate.size > 0:
        dilatancy.finish(flow, dt)
    if fields.settled_share.size > 0:
        friction_hysteresis.finish(flow, dt, response.hysteresis)
    if fields.fluidity.size > 0:
        nonlocal_fluidity.finish(flow, dt)
