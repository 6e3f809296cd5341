"""Friction hysteresis: grains that have settled need more than mu(I) to start, delta_mu at most.

A share L of the contacts has settled, 1 at rest and 0 in flow; it moves with the grains, and the
friction coefficient is mu(I) + delta_mu L. L is the memory that the hysteresis needs:

    L_t + u . grad L = -L shear_rate / strain                     where I > I_start,
                     = (1 - L) (1 - I/I_stop) rate_start / strain where I < I_stop = I_start / 10,
                     = 0                                          between them,

rate_start = I_start sqrt(p)/k being the shear rate at I_start: contacts are broken by a strain of
some per cent, and settle again as fast as the weakest shear would break them. So a layer at rest
starts to flow freely above arctan(mu(I_start) + delta_mu), a few tenths of a degree above
arctan(mu_1 + delta_mu) from which it creeps, and, once it flows, stops below arctan(mu_1). The friction
of a bed on which grains slip (finite mu_bed) has no memory: the angles are those of a rough bed.

A law mu(I) that falls with I would give the same two angles without a memory, but it is ill-posed
wherever it falls. Here the law at any instant is mu(I) plus a constant, which is monotone; only the
slow evolution of L makes the steady curve fold back. Within a step L is frozen and then follows its
exact solution at constant I, between 0 and 1 for any time step: the effect sets no limit.

References
----------
Pouliquen & Forterre (2002), J. Fluid Mech. 453, 133, and Edwards, Russell, Johnson & Gray (2019),
J. Fluid Mech. 875, 1058, for friction that depends on whether the grains move; the memory in place
of a dependence on I is this project's own.
"""

import math
from typing import NamedTuple

import numpy as np

from .cell_transport import TRUSTED, transport_cells
from .compiled import inner_jit, kernel_jit
from .geometry import repeat
from .rheology import inertial_number
from .strain import shear_rate_centre, strain_rates

STOP_SHARE = 0.1  # I_stop / I_start


class FrictionHysteresis(NamedTuple):
    """delta_mu, I_start and strain of the module docstring; delta_mu = 0: no hysteresis."""

    delta_mu: float
    I_start: float
    strain: float


def hysteresis_law(case):
    """`FrictionHysteresis` of a case; delta_mu = 0 where the effect is off."""
    effect = case.effects.friction_hysteresis
    if effect is None:
        return FrictionHysteresis(0.0, 1.0, 1.0)
    return FrictionHysteresis(effect.delta_mu, effect.I_start, effect.strain)


def start(state, case):
    """The state has the settled share, 1, unless it had it."""
    if state.settled_share is None:
        state.settled_share = np.ones(state.pressure_filled.shape)


def extend(state, case, nx, nz):
    """Cells beyond the first nx columns and nz rows hold settled contacts."""
    state.settled_share[nx:] = state.settled_share[:, nz:] = 1.0


@inner_jit()
def carry(flow, dt):
    """The settled share has moved with the grains for dt (s); the surface has moved already."""
    share = flow.fields.settled_share
    transport_cells(share, flow, dt)
    for i in range(share.shape[0]):
        for k in range(share.shape[1]):
            share[i, k] = min(max(share[i, k], 0.0), 1.0)


@inner_jit()
def finish(flow, dt, law):
    """The contacts have settled or broken for dt (s) at the velocity of the solve, by a `FrictionHysteresis`."""
    fields, work, geometry = flow.fields, flow.work, flow.geometry
    constants = flow.constants
    e_centre, g_node = work.e_centre, work.g_node
    strain_rates(
        e_centre, g_node, fields.u, fields.w, fields.bed_slip, geometry, constants.dx, constants.dz
    )
    settle(
        fields.settled_share,
        e_centre,
        g_node,
        fields.pressure_filled,
        geometry,
        law,
        constants.material.grain_scale,
        dt,
    )
    repeat(geometry, fields.settled_share)


@kernel_jit()
def settled_after(share, shear_rate, pressure, dt, law, grain_scale):
    """Settled share of the contacts, 0 to 1, after the time dt (s) at constant shear rate and pressure.

    Parameters
    ----------
    share : float
        At the start.
    shear_rate, pressure : float
        1/s, Pa; without pressure nothing settles.
    law : FrictionHysteresis
    grain_scale : float
        k = d sqrt(rho_grain) of the inertial number.
    """
    inertial = inertial_number(shear_rate, pressure, grain_scale)
    if inertial > law.I_start:
        return share * math.exp(-shear_rate * dt / law.strain)
    stop = STOP_SHARE * law.I_start
    if inertial >= stop:
        return share
    rate_start = law.I_start * math.sqrt(max(pressure, 0.0)) / grain_scale
    healing = (1.0 - inertial / stop) * rate_start / law.strain
    return 1.0 - (1.0 - share) * math.exp(-healing * dt)


@kernel_jit()
def settle(share, e_centre, g_node, pressure_filled, geometry, law, grain_scale, dt):
    """Settled share of every well-filled cell after dt, in place."""
    for i in range(share.shape[0]):
        for k in range(geometry.reach[i]):
            v = geometry.filled[i, k]
            if v >= TRUSTED:
                rate = shear_rate_centre(e_centre, g_node, i, k)
                p = pressure_filled[i, k] / v
                share[i, k] = settled_after(share[i, k], rate, p, dt, law, grain_scale)
