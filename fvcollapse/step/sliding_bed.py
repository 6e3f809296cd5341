"""The friction of a sliding bed in the nonlinear sweeps: its sum, which must settle, and its tangent."""

from .compiled import inner_jit
from .geometry import last_face

TANGENT = 0.7  # of the Coulomb traction; at 1 the sweeps diverge, on faces that stick they chatter


@inner_jit()
def bed_force(work, u, geometry):
    """Sum of |traction| over the bed faces, Pa; the sweeps must settle it, not only the velocity."""
    total = 0.0
    for i in range(geometry.first, last_face(geometry)):
        if geometry.index_u[i, 0] >= 0:
            total += work.k_bed[i] * abs(u[i, 0])
    return total


@inner_jit()
def linearise(work, bed_slip, u, geometry, slowest):
    """Keep a part of the traction fixed where the grains slide: k_bed u = (1 - TANGENT) k_bed u + bed_drag.

    The traction mu N of a sliding face does not depend on its speed. With the coefficient mu N / |u| of the last sweep
    alone it lags behind grains that are slowing down, which then are too fast after two sweeps. Grains slower than
    `slowest` (m/s) may stop or turn within a step: a fixed traction would then drive them.
    """
    for i in range(geometry.first, last_face(geometry)):
        if geometry.index_u[i, 0] >= 0 and abs(bed_slip[i]) > slowest:
            work.bed_drag[i] = TANGENT * work.k_bed[i] * u[i, 0]
            work.k_bed[i] *= 1.0 - TANGENT
