"""The drag -c u, exact over a step, between advection and solve; its work is dissipated in the bulk."""

import math


def before_solve(case, flow, u_star, w_star, balance):
    """Return the change of the velocity by the drag, m/s."""
    change = math.expm1(-case.effects.linear_drag.c * balance.dt)
    return change * u_star, change * w_star
