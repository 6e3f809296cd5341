"""Nonlocal granular fluidity: grains beside a flow creep below their yield stress, grains beside rest are held.

The fluidity g = shear_rate / mu, mu = tau/p, follows from the shear rate by one elliptic equation,

    mu_loc(I, p) g - (A d)^2 lap g = shear_rate,    no flux through surface and walls,

mu_loc being the friction coefficient of the local law: the steady form of Henann & Kamrin (2014),
for which g = shear_rate / mu_loc, the local law, if A = 0. Where nothing yields by itself it is

    xi^2 lap g = g,    xi = A d / sqrt(mu_loc - mu),

so g fades exponentially from the flow; about the local fluidity it is, to first order, xi^2 lap g =
g - g_loc (Kamrin & Koval 2012). Written with the shear rate instead of the stress it is linear, its
matrix is symmetric and positive, and the sweeps converge as with the local law.

Discretisation: one value per wet cell; the factor c = mu/mu_loc = shear_rate / (mu_loc g) changes the
friction coefficient by (c - 1) mu_loc, at nodes by the mean of the cells. The shear rate is the
regularised one of the law, so that g > 0. Everything is implicit: no limit on the time step. A d is
a fraction of a millimetre, so cells must be about a millimetre before xi is resolved, except
close to yield; on coarser cells the effect is that of the mean over a cell. A rough bed (`thin_layer`)
holds the fluidity at zero, half a cell below the lowest centre or half the filled height of that cell.
The fluidity is solved by `fluidity_relaxation` where cells are no finer than A d, else by elimination.

References
----------
Kamrin & Koval (2012), Phys. Rev. Lett. 108, 178301; Henann & Kamrin (2014), Phys. Rev. Lett. 113,
178001.
"""

import numpy as np

from .arrays import copy
from .banded import factorise, new_system, solve_factorised
from .compiled import inner_jit, kernel_jit
from .geometry import WET, repeat


def nonlocal_length(case):
    """A d, m; 0 where the effect is off."""
    effect = getattr(case.effects, "nonlocal")  # a word of Python, hence no attribute in its syntax
    return 0.0 if effect is None else effect.A * case.rheology.grain_diameter


def start(state, case):
    """The state has the fluidity, 0 at rest, unless it had it."""
    if state.fluidity is None:
        state.fluidity = np.zeros(state.pressure_filled.shape)


@inner_jit()
def finish(flow, dt):
    """The fluidity is that of the solve."""
    copy(flow.fields.fluidity, flow.work.response.fluidity)
    repeat(flow.geometry, flow.fields.fluidity)


@inner_jit()
def number_cells(index, geometry):
    """Number the wet cells, column by column (a periodic stretch row by row); return how many."""
    index[:] = -1
    n = 0
    if geometry.first > 0:
        for k in range(index.shape[1]):
            for i in range(geometry.first, geometry.last):
                if geometry.filled[i, k] > WET:
                    index[i, k] = n
                    n += 1
    else:
        for i in range(index.shape[0]):
            for k in range(geometry.reach[i]):
                if geometry.filled[i, k] > WET:
                    index[i, k] = n
                    n += 1
    return n


@inner_jit()
def neighbour(index, geometry, i, k, ahead):
    """Number of the cell next to (i, k) along the bed or, if not `ahead`, above it; -1 if it is dry or itself."""
    if not ahead:
        return index[i, k + 1] if k + 1 < index.shape[1] else -1
    beside = i + 1
    if geometry.first > 0 and beside == geometry.last:
        beside = geometry.first
    if beside == i or beside >= index.shape[0]:
        return -1
    return index[beside, k]


@inner_jit()
def _couple(band, a, b, strength):
    """Add strength (g_a - g_b)^2 / 2 to the energy of the band."""
    band[a, 0] += strength
    band[b, 0] += strength
    band[min(a, b), abs(a - b)] -= strength


@inner_jit()
def bed_hold(geometry, i, k, rough):
    """Pull of a rough bed on the fluidity of cell (i, k), in units of (length/dz)^2; 0 off the bed."""
    if not rough or k > 0:
        return 0.0
    return 2.0 * geometry.bed_cover[i] / geometry.filled[i, k]


@kernel_jit()
def fluidity(g, shear_rate, mu, geometry, length, rough, dx, dz):
    """Fluidity g (nx, nz) of the wet cells, 1/s: mu g - length^2 lap g = shear_rate; 0 elsewhere.

    Parameters
    ----------
    g : (nx, nz) array
        Result.
    shear_rate, mu : (nx, nz) arrays
        1/s; friction coefficient of the local law, > 0 in the wet cells.
    geometry : Geometry
    length : float
        A d, m.
    rough : bool
        Whether g = 0 on the bed; else no flux goes through it.
    """
    nx, nz = g.shape
    index = np.empty((nx, nz), np.int64)
    n = number_cells(index, geometry)
    ends = np.arange(n)
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            a = index[i, k]
            for ahead in (True, False):
                b = neighbour(index, geometry, i, k, ahead) if a >= 0 else -1
                if b >= 0:
                    ends[min(a, b)] = max(ends[min(a, b)], max(a, b))
    width = 0
    for m in range(n):
        if m > 0:
            ends[m] = max(ends[m], ends[m - 1])
        width = max(width, ends[m] - m)
    band, rhs = new_system(n, width)
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            a, v = index[i, k], geometry.filled[i, k]
            if a < 0:
                continue
            band[a, 0] += mu[i, k] * v + bed_hold(geometry, i, k, rough) * (length / dz) ** 2
            rhs[a] = shear_rate[i, k] * v
            b = neighbour(index, geometry, i, k, True)
            if b >= 0 and b != a:
                beside = geometry.first if geometry.first > 0 and i + 1 == geometry.last else i + 1
                wetted = min(v, geometry.filled[beside, k]) * geometry.aperture[i + 1, k]
                _couple(band, a, b, wetted * (length / dx) ** 2)
            b = neighbour(index, geometry, i, k, False)
            if b >= 0:
                _couple(band, a, b, min(v, geometry.filled[i, k + 1]) * (length / dz) ** 2)
    factorise(band, ends)
    solve_factorised(rhs, band, ends)
    _spread(g, rhs, index, geometry)


@inner_jit()
def _spread(g, solution, index, geometry):
    """Write the solution to the cells, those of the halo of a periodic stretch included."""
    period = geometry.last - geometry.first
    for i in range(g.shape[0]):
        source = i
        if geometry.first > 0:
            source = geometry.first + (i - geometry.first) % period
        for k in range(g.shape[1]):
            a = index[source, k]
            g[i, k] = solution[a] if a >= 0 else 0.0
