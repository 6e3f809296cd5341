"""The gate at X = length_0: a rigid wall lifted normal to the bed, closing Z > z_gate(t).

z_gate(t) = v t, or v (t - tau (1 - exp(-t/tau))) for the start-up law v (1 - exp(-t/tau)), both
from the `delay` on. The partly uncovered face is open by its uncovered fraction, in the divergence
as well as in the pressure force: opening it at once would give a pressure spike at every cell the
gate passes.

The gate slips freely, or (effect `gate`) it rubs: Coulomb friction mu_gate on the grains behind it,
up to its lower edge, against their velocity relative to the gate, which drags them upwards while it
is faster. The half cell beside it is solved exactly, stuck or slipping, as at the other walls. The
friction is implicit and sets no time step of its own; the motion does (`limit_gate`).
"""

import math
from typing import NamedTuple

from .compiled import inner_jit, kernel_jit
from .coulomb_walls import friction_coefficient
from .erodible_bed import layer_thickness
from .geometry import WET, wetted_edge
from .rheology import with_extra_friction

CONTACT = 1.0e-3  # of the depth of the node behind the gate: a gap that is none


class Lift(NamedTuple):
    """How the gate moves: speed (m/s, inf = removed at once), time constant and delay (s); foot: z at rest (m)."""

    speed: float
    time_constant: float
    delay: float
    foot: float


def gate_lift(case):
    """`Lift` of a case whose effects on keys are applied (`Case.resolved`)."""
    effect = case.effects.gate
    delay = 0.0 if effect is None else effect.delay
    return Lift(case.gate.speed, case.gate.time_constant, delay, layer_thickness(case))


@kernel_jit()
def gate_height(time, lift):
    """Height of the gate's lower edge above the bed at `time`, m."""
    since = time - lift.delay
    if since < 0.0:
        return lift.foot
    if math.isinf(lift.speed):
        return math.inf
    if lift.time_constant <= 0.0:
        return lift.foot + lift.speed * since
    start_up = lift.time_constant * math.expm1(-since / lift.time_constant)
    return lift.foot + lift.speed * (since + start_up)


@kernel_jit()
def gate_velocity(time, lift):
    """Velocity of the gate at `time`, m/s; 0 when it is gone."""
    since = time - lift.delay
    if since < 0.0 or math.isinf(lift.speed):
        return 0.0
    if lift.time_constant <= 0.0:
        return lift.speed
    return -lift.speed * math.expm1(-since / lift.time_constant)


@kernel_jit(error_model="numpy")
def open_fractions(aperture, height, column, dz):
    """Set the open fraction of the x-faces of the gate at `column` (negative: no gate); the others are open."""
    if 0 < column < aperture.shape[0] - 1:
        for k in range(aperture.shape[1]):
            rise = min(max((height - dz * k) / dz, 0.0), 1.0)
            aperture[column, k] = rise if rise >= 1e-9 else 0.0


@inner_jit()
def hold_at_gate(speed, level_set, aperture, column):
    """Set the speed of the nodes between closed gate and grains to zero, in place: no correction may move that face.

    Parameters
    ----------
    speed, level_set : (nx + 1, nz + 1) arrays
        m/s, m.
    aperture : (nx + 1, nz) array
        Open part of each x-face.
    column : int
        Of the gate; negative without one.
    """
    if column > 0:
        for k in range(aperture.shape[1]):
            if aperture[column, k] == 0.0 and level_set[column - 1, k] < 0.0:
                speed[column, k] = 0.0


@inner_jit()
def fill_gate(gate_cover, level_set, aperture, column):
    """Wetted part, as a fraction of a cell, of each cell's stretch of the closed gate; 0 without a gate.

    As in `cell_moments` the surface on the inner side continues straight through the gate. The upright face of the
    column coincides with the gate, so the level set is zero on it to round-off: a node is wet if it lies nearer to
    the grains than `CONTACT` of the depth of the node behind it.
    """
    gate_cover[:] = 0.0
    if column < 2 or column >= aperture.shape[0]:
        return
    for k in range(gate_cover.size):
        low = _at_gate(level_set, column, k)
        high = _at_gate(level_set, column, k + 1)
        gate_cover[k] = (1.0 - aperture[column, k]) * wetted_edge(low, high)


@inner_jit()
def _at_gate(level_set, column, k):
    """Level set of the inner side at node k of the gate, m, negative where the grains touch it."""
    behind = level_set[column - 1, k]
    continued = min(level_set[column, k], 2.0 * behind - level_set[column - 2, k])
    return continued + CONTACT * min(behind, 0.0)


@kernel_jit()
def gate_reaction(pressure_filled, weight_centre, e_centre, geometry, column, k, gx, density, dx):
    """Normal reaction of the closed part of the gate on cell (column - 1, k), Pa averaged over the cell, >= 0."""
    i = column - 1
    carried = density * gx * dx * geometry.lever_x[i, k] * geometry.packing[i, k]
    stress = pressure_filled[i, k] - 2.0 * weight_centre[i, k] * e_centre[i, k] + carried
    return max((1.0 - geometry.aperture[column, k]) * stress, 0.0)


@inner_jit()
def gate_friction(
    k_gate,
    gate_slip,
    w,
    pressure_filled,
    weight_centre,
    e_centre,
    extra_friction,
    geometry,
    material,
    balance,
    dx,
):
    """Friction coefficients (nz + 1,) of the z-faces beside the gate, Pa s/m, and slip speeds along it, m/s."""
    i = balance.gate_column - 1
    k_gate[:] = 0.0
    gate_slip[:] = 0.0
    for k in range(1, pressure_filled.shape[1]):
        if geometry.index_w[i, k] < 0:
            continue
        reaction = coverage = extra = shares = 0.0
        for cell in range(k - 1, k + 1):
            v = geometry.filled[i, cell]
            if v > WET:
                share = geometry.lever_z[i, cell] / v
                if cell == k:
                    share = 1.0 - share
                reaction += share * gate_reaction(
                    pressure_filled,
                    weight_centre,
                    e_centre,
                    geometry,
                    i + 1,
                    cell,
                    balance.gx,
                    balance.density,
                    dx,
                )
                coverage += share * geometry.gate_cover[cell]
                extra += share * extra_friction[i, cell]
                shares += share
        extra = extra / shares if shares > 0.0 else 0.0
        k_gate[k], gate_slip[k] = friction_coefficient(
            abs(w[i, k] - balance.gate_speed),
            0.5 * dx,
            reaction,
            coverage,
            balance.mu_gate,
            with_extra_friction(material, extra),
        )
