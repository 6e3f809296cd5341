"""Dilatancy: the solid fraction nu of the sheared grains changes, and mass instead of volume is conserved.

    div u = shear_rate tan(psi),    tan(psi) = K (nu - nu_eq(I)),    nu_eq = nu_c - b min(I, 1),
    nu_t + u . grad nu = -nu div u,    friction coefficient mu(I) + F tan(psi)

The friction coefficient is mu(I) + F tan(psi); F = 1 (`friction_factor`) is the work that dilation takes, and what more
there is the grains dissipate in their denser packing.

Grains denser than nu_eq expand when sheared and rub more, looser ones contract and rub less, until
nu = nu_eq after a strain of some 1/(K nu). nu_eq is linear in I up to the I = 1 to which it has been
measured. The density of inertia and weight is the local rho_grain nu.

Discretisation. Over one step at constant shear rate and nu_eq the equations integrate to

    nu / nu(0) = 1 / (1 + y),    y = (nu(0)/nu_eq - 1) (1 - exp(-K nu_eq shear_rate dt)),

and the source of the solve is the s = (1 - nu/nu(0))/dt of that solution: exact in strain, never
beyond nu_eq, so it sets no limit of stability. s follows the velocity and the pressure of every
nonlinear sweep. It falls as the pressure rises (I falls), and strongly; therefore the multiplier of
the solve is updated not with the penalty r but with 1/(1/r - ds/dP), a Newton step, without which
pressure and expansion would chase each other from sweep to sweep; if after some sweeps they still
do, in a thin tongue, s and the friction go half of their way only. A cell under pressure expands at
s; one without pressure may open faster (p >= 0, div u - s >= 0), and that opening, as in an
incompressible mass, is no change of nu. The surface is corrected to the mass of the grains, the sum
of nu over the volume, instead of the volume.

The yield stress is never negative: F tan(psi) >= -mu_1 in the friction. A loose pile at rest has less
static friction, a dense one more. K = 0 is the incompressible mass exactly.

Limits: one bulk relation for all states (no free compaction of a dilute cloud); tan(psi) depends on
the shear rate of the plane deformation only; where ill-posedness is reported, tan(psi) counts as a
constant part of the friction.

References
----------
Roux & Radjai (1998), in Physics of Dry Granular Media, 229, for tan(psi); Pailha & Pouliquen (2009),
J. Fluid Mech. 633, 115, for friction and nu_eq; Pouliquen, Cassar, Jop, Forterre & Nicolas (2006),
J. Stat. Mech. P07020, for nu_eq linear in I.
"""

import math
from typing import NamedTuple

import numpy as np

from .arrays import copy, largest
from .cell_transport import TRUSTED, transport_cells
from .compiled import inner_jit, kernel_jit
from .geometry import repeat
from .rheology import inertial_number
from .strain import shear_rate_centre

PRESSURE_STEP = 0.01  # relative, of the one-sided slope ds/dp
CHANGE_PER_STEP = 0.1  # of the volume of any cell
FULL_SWEEPS = 6  # nonlinear sweeps before the source is relaxed


class Dilatancy(NamedTuple):
    """K (0: no dilatancy), nu_c, b and F of the module docstring; `fraction_bulk` is that of density_bulk."""

    factor: float
    fraction_critical: float
    slope: float
    fraction_bulk: float
    friction_factor: float


def dilatancy_law(case):
    """`Dilatancy` of a case; K = 0 where the effect is off."""
    effect = case.effects.dilatancy
    bulk = case.rheology.density_bulk / case.rheology.density_grain
    if effect is None:
        return Dilatancy(0.0, bulk, 0.0, bulk, 1.0)
    return Dilatancy(
        effect.dilatancy_factor,
        effect.solid_fraction_critical,
        effect.solid_fraction_slope,
        bulk,
        effect.friction_factor,
    )


def initial_fraction(case):
    """Solid fraction at the start: nu_0 of the effect, or that of density_bulk."""
    effect = case.effects.dilatancy
    if effect is None or effect.solid_fraction_0 is None:
        return case.rheology.density_bulk / case.rheology.density_grain
    return effect.solid_fraction_0


def start(state, case):
    """The state has the fields of the effect, uniform and at rest, unless it had them."""
    if state.solid_fraction is None:
        state.solid_fraction = np.full(state.pressure_filled.shape, initial_fraction(case))
        state.dilation_rate = np.zeros(state.pressure_filled.shape)


def extend(state, case, nx, nz):
    """Cells beyond the first nx columns and nz rows hold the solid fraction of the start."""
    state.solid_fraction[nx:] = state.solid_fraction[:, nz:] = initial_fraction(case)


@inner_jit()
def limit(fields):
    """Longest step, s, in which no cell changes its volume by more than `CHANGE_PER_STEP`."""
    fastest = largest(fields.dilation_rate)
    return CHANGE_PER_STEP / fastest if fastest != 0.0 else math.inf


@inner_jit()
def equilibrium_fraction(inertial, law):
    """nu_eq = nu_c - b min(I, 1), dimensionless."""
    return law.fraction_critical - law.slope * min(inertial, 1.0)


@kernel_jit()
def expansion(shear_rate, pressure, fraction, dt, law, grain_scale):
    """Rate of volume change s, 1/s, that takes nu to its value after the strain of one step.

    Parameters
    ----------
    shear_rate : float
        sqrt(2 D:D) of the deviatoric strain rate, 1/s.
    pressure : float
        Pa; without pressure I counts as infinite.
    fraction : float
        Solid fraction nu at the start of the step.
    dt : float
        s.
    law : Dilatancy
    grain_scale : float
        k = d sqrt(rho_grain) of the inertial number.
    """
    if shear_rate <= 0.0:
        return 0.0
    target = equilibrium_fraction(inertial_number(shear_rate, pressure, grain_scale), law)
    strain = law.factor * target * shear_rate * dt
    y = -(fraction / target - 1.0) * math.expm1(-strain)
    return y / ((1.0 + y) * dt)


@inner_jit()
def dilate(
    source,
    penalty,
    friction,
    friction_before,
    fraction,
    e_centre,
    g_node,
    pressure_filled,
    geometry,
    material,
    law,
    hardest,
    dt,
    share,
):
    """Source of div u = s, penalty and extra friction of every well-filled cell, from velocity and pressure.

    The slope ds/dp is taken where I <= 1: below that pressure s is constant, and a multiplier
    updated without its slope would jump to and fro across the kink.

    Parameters
    ----------
    source, penalty, friction : (nx, nz) arrays
        Results: s in 1/s; 1/(1/r - ds/dP) in Pa s; friction_before + F tan(psi).
    friction_before : (nx, nz) array
        What other effects add to the friction coefficient.
    fraction : (nx, nz) array
        Solid fraction nu at the start of the step.
    hardest : float
        Penalty r of an incompressible cell, Pa s.
    dt : float
        s.
    share : float
        How far source and friction move from their present values towards the new ones; 1: all the
        way.
    """
    penalty[:] = hardest
    for i in range(source.shape[0]):
        for k in range(geometry.reach[i]):
            v = geometry.filled[i, k]
            rate = shear_rate_centre(e_centre, g_node, i, k) if v >= TRUSTED else 0.0
            if rate <= 0.0:
                source[i, k] = 0.0
                friction[i, k] = friction_before[i, k]
                continue
            p = pressure_filled[i, k] / v
            s = expansion(rate, p, fraction[i, k], dt, law, material.grain_scale)
            source[i, k] += share * (s - source[i, k])
            total = friction_before[i, k] + max(law.friction_factor * s / rate, -material.mu_1)
            friction[i, k] += share * (total - friction[i, k])
            p = max(p, (material.grain_scale * rate) ** 2)
            s = expansion(rate, p, fraction[i, k], dt, law, material.grain_scale)
            step = PRESSURE_STEP * p
            s_above = expansion(rate, p + step, fraction[i, k], dt, law, material.grain_scale)
            penalty[i, k] = 1.0 / (1.0 / hardest + (s - s_above) / (step * v))


@kernel_jit()
def dilation_power(source, pressure_filled, geometry):
    """Power of the pressure in expanding the grains, summed over cells, Pa/s; the friction has paid for it."""
    power = 0.0
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            power += pressure_filled[i, k] * source[i, k]
    return power


@inner_jit()
def carry(flow, dt):
    """The solid fraction has moved and expanded with the grains for dt (s); the surface has moved already."""
    fraction, rate = flow.fields.solid_fraction, flow.fields.dilation_rate
    transport_cells(fraction, flow, dt)
    for i in range(fraction.shape[0]):
        for k in range(fraction.shape[1]):
            fraction[i, k] *= 1.0 - rate[i, k] * dt
    repeat(flow.geometry, fraction)


@inner_jit()
def finish(flow, dt):
    """The rate of dilation is that of the solve."""
    copy(flow.fields.dilation_rate, flow.work.response.source)
    repeat(flow.geometry, flow.fields.dilation_rate)
