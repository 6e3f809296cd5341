"""The implicit solve of a step, by the method of the case."""

import math

import numpy as np

from . import coupled
from .banded import allocate_system
from .grain_response import prepare_response


def solve(simulation, u_star, w_star, impulses, balance):
    """Velocity and pressure of the state are those at the end of the step; return the `Outcome`."""
    for impulse in impulses:
        u_star, w_star = u_star + impulse.u, w_star + impulse.w
    if simulation.case.numerics.method == "coupled":
        return solve_coupled(simulation, u_star, w_star, balance)
    from . import projection  # sparse matrices of scipy, for the reference method only

    return projection.solve(
        simulation.state,
        simulation.work,
        simulation.ends,
        u_star,
        w_star,
        simulation.geometry,
        simulation.material,
        balance,
        *simulation.spacing,
    )


def solve_coupled(simulation, u_star, w_star, balance):
    """Velocity and pressure together; see `fvcollapse.step.coupled`."""
    state, work, ends = simulation.state, simulation.work, simulation.ends
    buffer, simulation.buffer = simulation.buffer, np.empty(0)
    band, rhs = allocate_system(ends, buffer)
    prepare_response(work.response, state, simulation.response)
    outcome = coupled.solve(
        state.u,
        state.w,
        state.pressure_filled,
        state.bed_slip,
        work,
        band,
        rhs,
        ends,
        u_star,
        w_star,
        simulation.geometry,
        simulation.material,
        balance,
        *simulation.spacing,
    )
    if outcome.info == 0 and math.isfinite(
        outcome.change + outcome.residual
    ):  # else it is not zero
        simulation.buffer = band.reshape(-1) if band.size > buffer.size else buffer
    return outcome
