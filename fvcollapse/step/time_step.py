"""The time step: the smallest of the limits that the terms set. Viscosity and friction are implicit and set none."""

import math

import numpy as np

from fvcollapse.case.case import GRAVITY
from fvcollapse.errors import NumericalError

from .arrays import larger, largest
from .compiled import from_python, inner_jit, kernel_jit
from .flow import DT, TIME
from .gate import gate_height
from .terms import limit_terms

LEAST_STEP = 1.0e-6  # of the longest step of a case
FIRST_STEP = 0.1  # of the longest step of a case
UNCOVERED = 0.25  # cells that the gate uncovers per step at most
NEWTON_MAX = 50  # iterations; four are enough from the upper bound that they start with


@kernel_jit()
def limit_advection(speed_max, cfl, spacing):
    """The surface and the momentum move at most `cfl` cells, s."""
    return cfl * spacing / speed_max if speed_max != 0.0 else math.inf


@kernel_jit()
def limit_surface_wave(gravity, spacing):
    """The free surface is moved explicitly: half the period of the shortest gravity wave, s."""
    return 0.5 * math.sqrt(spacing / (math.pi * gravity))


@inner_jit()
def choose_step(flow, time_limit):
    """Return the longest step, s, that all limits allow on the way to `time_limit` (s); NaN if it is too short."""
    constants, time = flow.constants, flow.fields.numbers[TIME]
    longest, previous = constants.longest_step, flow.fields.numbers[DT]
    advection, wave, terms = explicit_limits(flow)
    dt = min(min(longest, advection), min(wave, terms))
    if not dt >= LEAST_STEP * longest or advection != advection:  # NaN among the speeds
        return math.nan
    dt = min(dt, constants.growth * previous if previous > 0.0 else FIRST_STEP * longest)
    top = flow.geometry.filled.shape[1] * constants.dz
    near = fit_to(time_limit, time, dt)
    return min(dt, limit_gate(constants.lift, time, top, constants.dz, near))


@inner_jit()
def explicit_limits(flow):
    """Longest steps, s, that advection, surface waves and the terms of the effects allow."""
    fields, constants = flow.fields, flow.constants
    fastest = larger(largest(fields.u), largest(fields.w))  # beyond the surface too
    h = min(constants.dx, constants.dz)
    advection = limit_advection(constants.shape_factor * fastest, constants.cfl, h)
    return (
        advection,
        limit_surface_wave(GRAVITY, h),
        limit_terms(constants.balance.response, fields),
    )


LIMITS = from_python(explicit_limits)


def explain_short_step(flow, effects):
    """The error of a step that is too short: a run with it would never end.

    Parameters
    ----------
    flow : Flow
    effects : list of str
        Names of the effects that may limit the step.

    Returns
    -------
    NumericalError
    """
    advection, wave, terms = LIMITS(flow)
    fastest = max(np.abs(flow.fields.u).max(), np.abs(flow.fields.w).max())
    limits = {
        f"a speed of {fastest:.3g} m/s": advection,
        "the free surface": wave,
        " or ".join(effects): terms,
    }
    what = min(limits, key=lambda name: limits[name] if limits[name] >= 0.0 else -math.inf)
    least = LEAST_STEP * flow.constants.longest_step
    return NumericalError(
        f"the time step falls below {least:.3g} s: {what} asks for {limits[what]:.3g} s",
        time=flow.fields.numbers[TIME],
    )


@kernel_jit()
def limit_gate(lift, time, top, spacing, dt):
    """Longest step during which the gate uncovers no more than a quarter of a cell, s.

    A gate that waits, or is slow to start, sets no limit before it has risen that far. A gate that
    passes the grains as a whole within one step is as good as removed at once: it sets no limit.

    Parameters
    ----------
    lift : Lift
    time : float
        Start of the step, s.
    top : float
        Height above which there are no grains, m.
    spacing : float
        Height of a cell, m.
    dt : float
        Step that would be taken without this limit, s.

    Returns
    -------
    float
        inf without a gate in the grains.
    """
    height = gate_height(time, lift)
    if math.isinf(lift.speed) or lift.speed <= 0.0 or height >= top:
        return math.inf
    quarter = UNCOVERED * spacing
    if height - lift.foot <= quarter and gate_height(time + dt, lift) >= top:
        return math.inf
    return time_to_rise(quarter, lift, time)


@kernel_jit()
def time_to_rise(rise, lift, time):
    """Time from `time` (s) until the gate stands `rise` (m) higher than then, s."""
    shortest = rise / lift.speed  # at full speed
    waiting = max(lift.delay - time, 0.0)
    if lift.time_constant <= 0.0:
        return waiting + shortest
    since = max(time - lift.delay, 0.0)
    target = (gate_height(time, lift) - lift.foot + rise) / (lift.speed * lift.time_constant)
    return waiting + max(shortest, lift.time_constant * start_up_time(target) - since)


@kernel_jit()
def start_up_time(target):
    """The s > 0 at which s - (1 - exp(-s)) = `target` > 0.

    Newton's iteration falls monotonically from the upper bound target + sqrt(2 target), as the
    function is convex.
    """
    s = target + math.sqrt(2.0 * target)
    for _ in range(NEWTON_MAX):
        slope = -math.expm1(-s)
        change = (s - slope - target) / slope
        if not change > 1e-12 * s:
            break
        s -= change
    return s


@kernel_jit()
def fit_to(time_limit, time, dt):
    """Divide what is left until `time_limit` into equal steps of at most dt, so that no tiny last step arises."""
    left = time_limit - time
    return left / math.ceil(left / dt * (1.0 - 1e-12))
