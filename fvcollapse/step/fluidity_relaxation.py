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
def beside(i, step, first, last):
    """Column next to column i (`step` = 1 or -1), round the ends of a periodic stretch; -1 if there is none."""
    column = i + step
    if first > 0:
        column = first + (column - first) % (last - first)
        return -1 if column == i else column
    return column if 0 <= column < last else -1


@inner_jit()
def couplings(side, above, geometry, length, dx, dz):
    """Strength (A d/spacing)^2 times wetted part, of the sides (nx + 1, nz) and tops (nx, nz) of the wet cells."""
    filled, aperture = geometry.filled, geometry.aperture
    first, last = geometry.first, geometry.last
    x, z = (length / dx) ** 2, (length / dz) ** 2
    for i in range(first, last):
        left, right = beside(i, -1, first, last), beside(i, 1, first, last)
        for k in range(geometry.reach[i]):
            v = filled[i, k]
            if v <= WET:
                continue
            if left >= 0 and filled[left, k] > WET:
                side[i, k] = x * min(v, filled[left, k]) * aperture[i, k]
            if right >= 0 and filled[right, k] > WET:
                side[i + 1, k] = x * min(v, filled[right, k]) * aperture[i + 1, k]
            if k + 1 < geometry.reach[i] and filled[i, k + 1] > WET:
                above[i, k] = z * min(v, filled[i, k + 1])


@inner_jit()
def factorise_columns(inverse, side, above, mu, geometry, rough, hold):
    """Inverse pivots (nx, nz) of the equations of each column, whose neighbours are given; 0 in dry cells."""
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            v = geometry.filled[i, k]
            if v > WET:
                below = above[i, k - 1] if k > 0 else 0.0
                pivot = mu[i, k] * v + hold * bed_hold(geometry, i, k, rough)
                pivot += side[i, k] + side[i + 1, k] + above[i, k] + below
                if below > 0.0:
                    pivot -= below * below * inverse[i, k - 1]
                inverse[i, k] = 1.0 / pivot


@inner_jit()
def relax_column(g, partial, source, inverse, side, above, i, left, right, rows):
    """Solve the equations of column i with its neighbours as they are; return the largest relative change of g.

    `partial` (nz,) is scratch.
    """
    low = 0.0
    for k in range(rows):
        value = source[i, k] + low
        if left >= 0:
            value += side[i, k] * g[left, k]
        if right >= 0:
            value += side[i + 1, k] * g[right, k]
        partial[k] = value * inverse[i, k]
        low = above[i, k] * partial[k]
    largest = beyond = 0.0
    for k in range(rows - 1, -1, -1):
        beyond = partial[k] + above[i, k] * inverse[i, k] * beyond
        if beyond > 0.0:
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
    first, last = geometry.first, geometry.last
    side, above, inverse = np.zeros((nx + 1, nz)), np.zeros((nx, nz)), np.zeros((nx, nz))
    source, partial = np.zeros((nx, nz)), np.empty(nz)
    couplings(side, above, geometry, law.length, dx, dz)
    factorise_columns(inverse, side, above, mu, geometry, law.rough, (law.length / dz) ** 2)
    for i in range(first, last):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] > WET:
                source[i, k] = shear_rate[i, k] * geometry.filled[i, k]
                if not g[i, k] > 0.0:
                    g[i, k] = shear_rate[i, k] / mu[i, k]
    passes = 0
    change = math.inf
    while change > law.tolerance and passes < PASSES:
        change = 0.0
        for m in range(last - first):
            i = first + m if passes % 2 == 0 else last - 1 - m
            left, right = beside(i, -1, first, last), beside(i, 1, first, last)
            moved = relax_column(
                g, partial, source, inverse, side, above, i, left, right, geometry.reach[i]
            )
            change = max(change, moved)
        passes += 1
    if first > 0:
        repeat_columns(g, first, last)
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
