"""Friction of thin layers: grains a few diameters above a rough bed need more friction than a thick layer to flow.

A column of grains of thickness h, normal to the bed, has at least the friction coefficient

    mu_stop(h) = mu_1 + (mu_2 - mu_1)/(1 + h/L):    mu = max(mu(I), mu_stop(h)).

So a uniform layer stops where tan(slope) < mu_stop(h), and above that it flows as mu(I) has it, which is what
chutes show: with I_0 = 5 beta d/(2 L sqrt(solid fraction cos(slope))), mu(I) is the dynamic friction of Pouliquen &
Forterre (2002), and mu(I) = mu_stop(h) is their least steady flow, Froude number = beta. Friction effects beside it
(settled contacts, dilatancy) add to the larger of the two. What was compared stands in `fvcollapse/effects/README.md`.

On a bed that slips, mu_bed + mu_stop(h) - mu_1 is the friction at any speed: mu_bed has no rate that could exceed it.

h of a cell is the height of the connected wet cells of its column, filled fractions summed, over the wetted part of
the bed below them. A detached piece has a thickness of its own; it has no pressure, so nothing acts on it. At a steep
side h falls from the height of the side to nothing within a cell; an overhanging nose counts by what it holds.
"""

import math
from typing import NamedTuple

from .compiled import inner_jit, kernel_jit
from .geometry import WET
from .nonlocal_fluidity import nonlocal_length
from .rheology import DRUCKER_PRAGER
from .strain import shear_rate_centre


class ThinLayer(NamedTuple):
    """L in m (0: off), mu_2 - mu_1, A d of the nonlocal closure in m (0: thickness closure)."""

    length: float
    contrast: float
    cooperation: float


def thin_layer_law(case):
    """`ThinLayer` of a case; length = 0 where the effect is off."""
    effect, rheology = case.effects.thin_layer, case.rheology
    if effect is None:
        return ThinLayer(0.0, 0.0, 0.0)
    contrast = rheology.mu_2 - rheology.mu_1
    length = effect.length * rheology.grain_diameter
    if effect.closure == "thickness":
        return ThinLayer(length, contrast, 0.0)
    alike = (
        2.0 / math.pi * math.sqrt(0.5 * contrast) * length
    )  # mu_stop as of the other closure at h = L
    return ThinLayer(length, contrast, nonlocal_length(case) or alike)


@inner_jit()
def stopping_excess(thickness, law):
    """mu_stop - mu_1 of a layer of `thickness` (m), at most mu_2 - mu_1."""
    if law.cooperation > 0.0:
        steepest = 0.5 * math.pi * law.cooperation / thickness
        return min(steepest * steepest, law.contrast)
    return law.contrast / (1.0 + thickness / law.length)


@inner_jit()
def viscous_friction(rate, pressure, material):
    """Part of the friction coefficient that grows with the shear rate (1/s), at `pressure` > 0 (Pa)."""
    if material.law == DRUCKER_PRAGER:
        return material.viscosity * rate / pressure
    faster = material.I_0 * math.sqrt(pressure) / material.grain_scale
    return (material.mu_2 - material.mu_1) * rate / (rate + faster)


@inner_jit()
def top_of_run(filled, i, low, reach):
    """Row above the connected wet cells of column i that begin at the row `low`, and their filled fractions summed."""
    top, height = low, 0.0
    while top < reach and filled[i, top] > WET:
        height += filled[i, top]
        top += 1
    return top, height


@kernel_jit()
def strengthen(
    friction, bed_excess, e_centre, g_node, pressure_filled, geometry, material, law, dz
):
    """Add what thin layers need to the extra friction of the cells; what a bed on which grains slide has more.

    Parameters
    ----------
    friction : (nx, nz) array
        Extra friction coefficient of the cells, changed in place by the closure "thickness".
    bed_excess : (nx,) array
        Result: mu_stop - mu_1 of the layer on the bed of each column.
    e_centre, g_node : arrays
        From `strain_rates`, 1/s.
    pressure_filled : (nx, nz) array
        Pa.
    geometry : Geometry
    material : Material
    law : ThinLayer
    dz : float
        m.
    """
    filled = geometry.filled
    for i in range(filled.shape[0]):
        bed_excess[i] = 0.0
        low = 0
        while low < geometry.reach[i]:
            if filled[i, low] <= WET:
                low += 1
                continue
            top, height = top_of_run(filled, i, low, geometry.reach[i])
            cover = geometry.bed_cover[i] if low == 0 and geometry.bed_cover[i] > 0.0 else 1.0
            excess = stopping_excess(height * dz / cover, law)
            if low == 0:
                bed_excess[i] = excess
            if law.cooperation == 0.0:
                for k in range(low, top):
                    p = pressure_filled[i, k] / filled[i, k]
                    if p > 0.0:
                        rate = shear_rate_centre(e_centre, g_node, i, k)
                        friction[i, k] += max(excess - viscous_friction(rate, p, material), 0.0)
            low = top
