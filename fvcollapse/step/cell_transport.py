"""A material property of the grains, one value per cell, carried with the flow: q_t + u . grad q = 0.

The volume that crosses the sides of a cell during the step follows, as that of the momentum, from
the wetted part of each side in the old and the new surface; it carries the value reconstructed
upwind (third-order WENO, two-stage TVD Runge-Kutta), and the new value is content over volume, both
transported by the same fluxes. So a uniform property stays uniform to the last bit, and inside the
grains the content of the cells is conserved. Cells that hold few grains, and the air next to the
surface, take the mean of their neighbours.
"""

import math

import numpy as np

from .arrays import average, copy
from .compiled import inner_jit, kernel_jit
from .extrapolation import LAYERS, extrapolate
from .geometry import polygon_moments, repeat, wetted_edge
from .momentum import rows_in_reach
from .passages import list_passages, transport

TRUSTED = 0.05  # filled fraction below which a cell takes the value of its neighbours


@kernel_jit()
def volume_fluxes(flux_x, flux_z, u, w, aperture, phi_old, phi_new, dt, dx, dz):
    """Volume that crosses the faces (nx + 1, nz) and (nx, nz + 1) of the cells during dt, in cells."""
    nx, nz = w.shape[0], u.shape[1]
    x, z = 0.5 * dt / dx, 0.5 * dt / dz  # the halves: of the two surfaces
    for i in range(nx + 1):
        for k in range(nz):
            wetted = wetted_edge(phi_old[i, k], phi_old[i, k + 1])
            wetted += wetted_edge(phi_new[i, k], phi_new[i, k + 1])
            flux_x[i, k] = x * wetted * aperture[i, k] * u[i, k]
    for i in range(nx):
        for k in range(nz + 1):
            wetted = wetted_edge(phi_old[i, k], phi_old[i + 1, k])
            wetted += wetted_edge(phi_new[i, k], phi_new[i + 1, k])
            flux_z[i, k] = z * wetted * w[i, k]


@inner_jit()
def transport_cells(values, flow, dt):
    """The values (nx, nz) have moved with the grains for dt (s), in place; the surface has moved already.

    Parameters
    ----------
    values : (nx, nz) array
        Of every cell; in the air continued from the grains.
    flow : Flow
        Its level set is that of the end of the step.
    """
    u, w = flow.carrier.u, flow.carrier.w
    phi_old, phi_new = flow.before.level_set, flow.fields.level_set
    nx, nz = values.shape
    flux_x, flux_z = np.empty_like(u), np.empty_like(w)
    constants = flow.constants
    volume_fluxes(
        flux_x,
        flux_z,
        u,
        w,
        flow.geometry.aperture,
        phi_old,
        phi_new,
        dt,
        constants.dx,
        constants.dz,
    )
    inner = np.empty((nx - 1, nz))
    for i in range(nx - 1):
        for k in range(nz):
            inner[i, k] = flux_x[i + 1, k]
    filled = np.empty_like(values)
    fill_fractions(filled, phi_old)
    reach = rows_in_reach(phi_old, phi_new)
    passages = list_passages(inner, flux_z, flux_x[nx].copy(), filled, reach, 1, 0)
    first, second = np.empty_like(values), np.empty_like(values)
    transport(first, values, mirrored(values), passages, 1, 1.0)
    transport(second, values, mirrored(first), passages, 1, 1.0)
    average(first, second)
    fill_fractions(filled, phi_new)
    continue_to_air(first, filled)
    copy(values, first)
    repeat(flow.geometry, values)


@inner_jit()
def mirrored(values):
    """Copy of a field (nx, nz) with two more cells on each side, which mirror it: (nx + 4, nz + 4)."""
    nx, nz = values.shape
    padded = np.empty((nx + 4, nz + 4))
    for i in range(nx + 4):
        a = min(max(i - 2, 1 - i), 2 * nx + 1 - i)
        for k in range(nz + 4):
            b = min(max(k - 2, 1 - k), 2 * nz + 1 - k)
            padded[i, k] = values[a, b]
    return padded


@inner_jit()
def fill_fractions(filled, level_set):
    """Filled fraction of each cell (nx, nz), as if there were no gate."""
    for i in range(filled.shape[0]):
        for k in range(filled.shape[1]):
            filled[i, k] = polygon_moments(
                level_set[i, k], level_set[i + 1, k], level_set[i + 1, k + 1], level_set[i, k + 1]
            )[0]


@inner_jit()
def continue_to_air(values, filled):
    """The values (nx, nz) of the well-filled cells are continued to the others near the surface, in place."""
    known = np.zeros(values.shape, np.int64)
    low, high = math.inf, -math.inf
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            if filled[i, k] >= TRUSTED:
                known[i, k] = 1
                low, high = min(low, values[i, k]), max(high, values[i, k])
    if low > high:
        return
    continued = values.copy()
    extrapolate(continued, known, LAYERS)
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            if known[i, k] > 0:
                values[i, k] = min(max(continued[i, k], low), high)
