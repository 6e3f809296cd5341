"""The drag -c u, exact over a step, between advection and solve; its work is dissipated in the bulk."""

import math

from fvcollapse.step.terms import Impulse


def before_solve(simulation, u_star, w_star, balance):
    """Return the impulse of the drag, and the balance as it is."""
    change = math.expm1(-simulation.case.effects.linear_drag.c * balance.dt)
    return Impulse(change * u_star, change * w_star), balance
