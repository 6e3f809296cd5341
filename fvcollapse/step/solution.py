"""The implicit solve of a step: velocity and pressure together; see `fvcollapse.step.coupled`."""

import math

import numpy as np

from . import coupled
from .arrays import add
from .banded import system_in
from .compiled import inner_jit
from .grain_response import prepare_response


@inner_jit()
def solve(flow, ends, u_star, w_star, impulse, balance, memory):
    """Velocity and pressure of the state are those at the end of the step.

    Parameters
    ----------
    flow : Flow
    ends : (n,) int64 array
        Envelope of the matrix, from `place`.
    u_star, w_star : arrays
        Velocity after advection, m/s.
    impulse : Impulse
        What forces have added to it.
    balance : Balance
    memory : (m,) array
        All zero: where the matrix is placed if it is long enough.

    Returns
    -------
    (Outcome, (m,) array)
        The second holds the matrix of the next solve.
    """
    fields, constants = flow.fields, flow.constants
    u_start, w_start = u_star, w_star
    for change_u, change_w in (
        (impulse.bulk_u, impulse.bulk_w),
        (impulse.lateral_u, impulse.lateral_w),
    ):
        if change_u.size > 0:
            u_start, w_start = u_start.copy(), w_start.copy()
            add(u_start, change_u)
            add(w_start, change_w)
    memory, band, rhs = system_in(memory, ends)
    prepare_response(flow.work.response, fields, balance.response)
    outcome = coupled.solve(
        fields.u,
        fields.w,
        fields.pressure_filled,
        fields.bed_slip,
        flow.work,
        band,
        rhs,
        ends,
        u_start,
        w_start,
        flow.geometry,
        constants.material,
        balance,
        constants.dx,
        constants.dz,
    )
    if outcome.info != 0 or not math.isfinite(outcome.change + outcome.residual):
        memory = np.zeros(0)  # what was there is not zero
    return outcome, memory
