"""The column before the gate moves: static pressure behind the closed gate, with all friction at work."""

import numpy as np

from .compiled import inner_jit
from .domain import place
from .flow import VOLUME_0
from .solution import solve
from .terms import no_impulse

SETTLING_TIME = 1.0  # s, the length of the step in which the column settles
SETTLING_SWEEPS, SETTLING_TOLERANCE = 100, 1e-6


def settling_flow(flow, soft_rate):
    """The `Flow` whose balance is that of the step in which the column settles."""
    balance = flow.constants.balance._replace(
        dt=SETTLING_TIME,
        max_sweeps=SETTLING_SWEEPS,
        tolerance=SETTLING_TOLERANCE,
        rate_start=soft_rate,
    )
    return flow._replace(constants=flow.constants._replace(balance=balance))


@inner_jit(inline="always")
def settle(flow, memory):
    """The column is at rest, in static equilibrium behind the closed gate, and its volume is that of the start.

    Both methods of the solve start from the coupled solution: it is exact at once, where the projection
    would need many steps.
    """
    fields, geometry = flow.fields, flow.geometry
    ends = place(flow, 0.0, True)
    u_start, w_start = np.zeros_like(fields.u), np.zeros_like(fields.w)
    solve(flow, ends, u_start, w_start, no_impulse(), flow.constants.balance, memory)
    fields.u[:] = 0.0
    fields.w[:] = 0.0
    fields.bed_slip[:] = 0.0
    place(flow, 0.0, False)
    volume = 0.0
    for i in range(geometry.filled.shape[0]):
        for k in range(geometry.filled.shape[1]):
            volume += geometry.filled[i, k]
    fields.numbers[VOLUME_0] = volume * flow.constants.dx * flow.constants.dz
