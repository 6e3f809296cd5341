"""The nonlocal law in the sweeps: granular fluidity by relaxation, and the friction that follows from it.

Column after column takes the fluidity that its equations give with that of both neighbours (Gauss-Seidel with the
columns as blocks), to and fro along the bed. With c = (A d/cell size)^2 an error shrinks by c/(mu + c) at least in
each pass, to 2 % of itself and less on cells of ten times A d; the last sweep of the step leaves a good first guess.
Where cells are finer than A d that is slow, and the banded elimination of `nonlocal_fluidity` takes its place. All
passes keep g > 0.
"""

import math
from typing import NamedTuple

import numpy as np

from .compiled import inner_jit, kernel_jit
from .geometry import WET, repeat_columns
from .nonlocal_fluidity import bed_hold, fluidity, nonlocal_length
from .rheology import effective_viscosity, with_extra_friction
from .strain import shear_rate_centre

PRESSURE_MIN = 1.0  # Pa, a tenth of a layer of grains; below it mu_loc is that at this pressure
PASSES = 400
TOLERANCE = 0.1  # of that of the sweeps: largest relative change of the fluidity in the last pass


class Cooperation(NamedTuple):
    """A d in m (0: off); whether the bed is rough, and the largest friction then; tolerance of the fluidity."""

    length: float
    rough: bool
    mu_most: float
    tolerance: float


def cooperation_law(case, thin):
    """`Cooperation` of a case, from the effect nonlocal or from the `ThinLayer`."""
    tolerance = TOLERANCE * case.numerics.tolerance
    if thin.cooperation > 0.0:
        return Cooperation(thin.cooperation, True, case.rheology.mu_2, tolerance)
    return Cooperation(nonlocal_length(case), False, math.inf, tolerance)


@inner_jit()
def beside(i, step, geometry):
    """Column next to column i (`step` = 1 or -1), round the ends of a periodic stretch; -1 if there is none."""
    column = i + step
    if geometry.first > 0:
        period = geometry.last - geometry.first
        column = geometry.first + (column - geometry.first + period) % period
        return -1 if column == i else column
    return column if 0 <= column < geometry.last else -1


@inner_jit()
def coupling(geometry, i, k, other, face):
    """Wetted and open part of the side between cell (i, k) and the same row of the column `other`."""
    shared = min(geometry.filled[i, k], geometry.filled[other, k])
    return shared * geometry.aperture[face, k] if shared > WET else 0.0


@inner_jit()
def relax_column(g, i, shear_rate, mu, geometry, law, x, z, upper, right):
    """Solve the equations of column i with its neighbours as they are; return the largest relative change of g.

    x, z are (A d)^2 over dx^2 and dz^2; `upper`, `right` (nz,) are scratch.
    """
    before, after = beside(i, -1, geometry), beside(i, 1, geometry)
    filled, reach = geometry.filled, geometry.reach[i]
    for k in range(reach):  # elimination upwards; a dry cell has no coupling to either side
        v = filled[i, k]
        if v <= WET:
            upper[k] = right[k] = 0.0
            continue
        diagonal = mu[i, k] * v + bed_hold(geometry, i, k, law.rough) * z
        value = shear_rate[i, k] * v
        for other, face in ((before, i), (after, i + 1)):
            if other >= 0:
                strength = x * coupling(geometry, i, k, other, face)
                diagonal += strength
                value += strength * g[other, k]
        below = z * min(v, filled[i, k - 1]) if k > 0 and filled[i, k - 1] > WET else 0.0
        above = z * min(v, filled[i, k + 1]) if k + 1 < reach and filled[i, k + 1] > WET else 0.0
        diagonal += below + above
        if below > 0.0:
            diagonal -= below * upper[k - 1]
            value += below * right[k - 1]
        upper[k] = above / diagonal
        right[k] = value / diagonal
    largest = beyond = 0.0
    for k in range(reach - 1, -1, -1):
        beyond = right[k] + upper[k] * beyond
        if filled[i, k] > WET:
            largest = max(largest, abs(beyond - g[i, k]) / beyond)
            g[i, k] = beyond
    return largest


@kernel_jit()
def relax_fluidity(g, shear_rate, mu, geometry, law, dx, dz):
    """Fluidity g (nx, nz) of the wet cells, 1/s, from the guess in it; 0 elsewhere. See `nonlocal_fluidity.fluidity`.

    Returns
    -------
    int
        Passes that were needed.
    """
    nx, nz = g.shape
    upper, right = np.empty(nz), np.empty(nz)
    x, z = (law.length / dx) ** 2, (law.length / dz) ** 2
    for i in range(nx):
        for k in range(nz):
            if geometry.filled[i, k] <= WET:
                g[i, k] = 0.0
            elif not g[i, k] > 0.0:
                g[i, k] = shear_rate[i, k] / mu[i, k]
    passes = 0
    for _ in range(PASSES):
        change = 0.0
        for m in range(geometry.last - geometry.first):
            i = geometry.first + m if passes % 2 == 0 else geometry.last - 1 - m
            moved = relax_column(g, i, shear_rate, mu, geometry, law, x, z, upper, right)
            change = max(change, moved)
        passes += 1
        if change <= law.tolerance:
            break
    if geometry.first > 0:
        repeat_columns(g, geometry.first, geometry.last)
    return passes


@inner_jit()
def cooperate(friction, g, e_centre, g_node, pressure_filled, geometry, material, law, dx, dz):
    """Change the extra friction (nx, nz) of every wet cell, in place, from the local to the nonlocal law.

    The fluidity goes to `g` (nx, nz), 1/s; what is in it is the first guess, 0 for none. Above a rough bed the
    friction is mu_2 at most, which mu_stop is too.
    """
    nx, nz = friction.shape
    rates, mu = np.zeros((nx, nz)), np.ones((nx, nz))
    for i in range(nx):
        for k in range(geometry.reach[i]):
            v = geometry.filled[i, k]
            if v <= WET:
                continue
            rate = shear_rate_centre(e_centre, g_node, i, k)
            p = max(pressure_filled[i, k] / v, PRESSURE_MIN)
            grains = with_extra_friction(material, friction[i, k])
            rates[i, k] = math.sqrt(rate**2 + material.shear_rate_min**2)
            mu[i, k] = effective_viscosity(rate, p, grains) * rates[i, k] / p  # eta becomes p/g
    if law.length <= min(dx, dz):
        relax_fluidity(g, rates, mu, geometry, law, dx, dz)
    else:
        fluidity(g, rates, mu, geometry, law.length, law.rough, dx, dz)
    for i in range(nx):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] > WET:
                most = max(law.mu_most + friction[i, k], mu[i, k])
                friction[i, k] += min(rates[i, k] / g[i, k], most) - mu[i, k]
