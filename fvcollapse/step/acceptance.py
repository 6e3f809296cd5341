"""Whether the outcome of a solve is accepted, and in which words it is refused."""

import math

from fvcollapse.case.case import GRAVITY

from .compiled import inner_jit

RESIDUAL_TOLERANCE = 1.0e-3  # of the weight per volume; sound solves leave less than 1e-5
CHANGE_LIMIT = 0.1  # change of the last sweep, relative to the largest speed, that refuses a step
# Of sqrt(g h0). The sweeps of slower grains may stall, by a tenth of this speed: behind an opening gate they converge
# neither with steps down to 2e-6 s nor with 200 sweeps. The effect on the flow is gone after 0.1 s.
SLOW = 0.1
HALVINGS = 5  # of a step whose solve fails


@inner_jit()
def change_of(outcome, constants):
    """Change of the velocity in the last sweep, relative to the largest speed, at least that of slow grains."""
    if outcome.change <= CHANGE_LIMIT:
        return outcome.change
    change = outcome.change * max(outcome.speed, constants.balance.speed_scale)
    return change / max(outcome.speed, constants.slow)


@inner_jit()
def is_sound(outcome, constants):
    """Whether the outcome of a solve is accepted."""
    if outcome.info != 0 or not change_of(outcome, constants) <= CHANGE_LIMIT:  # true for NaN
        return False
    return not constants.check_residual or outcome.residual <= RESIDUAL_TOLERANCE


def problem_of(outcome, constants):
    """Why the outcome of a solve is refused."""
    change = change_of.py_func(outcome, constants)
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
    return (
        f"the linear solve leaves {outcome.residual:.2g} of the weight (limit {RESIDUAL_TOLERANCE})"
    )


def slow_speed(case):
    """Speed, m/s, of grains whose sweeps may stall (`SLOW`)."""
    return SLOW * math.sqrt(GRAVITY * case.geometry.height_0)
