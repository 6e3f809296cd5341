"""The time step: the smallest of the limits that the terms set. Viscosity and friction are implicit and set none."""

import math

from fvcollapse.errors import NumericalError

from .gate import gate_height

LEAST_STEP = 1.0e-6  # of the longest step of a case
UNCOVERED = 0.25  # cells that the gate uncovers per step at most
NEWTON_MAX = 50  # iterations; four are enough from the upper bound that they start with


def limit_advection(speed_max, cfl, spacing):
    """The surface and the momentum move at most `cfl` cells, s."""
    return cfl * spacing / speed_max if speed_max > 0.0 else math.inf


def limit_surface_wave(gravity, spacing):
    """The free surface is moved explicitly: half the period of the shortest gravity wave, s."""
    return 0.5 * math.sqrt(spacing / (math.pi * gravity))


def shortest(limits, longest, time):
    """The smallest of the limits that the terms set, s.

    Parameters
    ----------
    limits : dict
        {what sets it: limit in s}.
    longest : float
        Longest step of the case, s.
    time : float
        s.

    Raises
    ------
    NumericalError
        One is below `LEAST_STEP` of the longest step: such a run would never end.
    """
    least = LEAST_STEP * longest
    for what, limit in limits.items():
        if not limit >= least:  # true for NaN
            raise NumericalError(
                f"the time step falls below {least:.3g} s: {what} asks for {limit:.3g} s", time=time
            )
    return min(limits.values())


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


def time_to_rise(rise, lift, time):
    """Time from `time` (s) until the gate stands `rise` (m) higher than then, s."""
    shortest = rise / lift.speed  # at full speed
    waiting = max(lift.delay - time, 0.0)
    if lift.time_constant <= 0.0:
        return waiting + shortest
    since = max(time - lift.delay, 0.0)
    target = (gate_height(time, lift) - lift.foot + rise) / (lift.speed * lift.time_constant)
    return waiting + max(shortest, lift.time_constant * start_up_time(target) - since)


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


def fit_to(time_limit, time, dt):
    """Divide what is left until `time_limit` into equal steps of at most dt, so that no tiny last step arises."""
    left = time_limit - time
    return left / math.ceil(left / dt * (1.0 - 1e-12))
