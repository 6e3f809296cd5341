"""A material property of the grains, one value per cell, carried with the flow: q_t + u . grad q = 0.

The volume that crosses the sides of a cell during the step follows, as that of the momentum, from
the wetted part of each side in the old and the new surface; it carries the value reconstructed
upwind (third-order WENO, two-stage TVD Runge-Kutta), and the new value is content over volume, both
transported by the same fluxes. So a uniform property stays uniform to the last bit, and inside the
grains the content of the cells is conserved. Cells that hold few grains, and the air next to the
surface, take the mean of their neighbours.
"""

import numpy as np

from .compiled import kernel_jit
from .extrapolation import LAYERS, extrapolate
from .geometry import cell_fractions, wetted_edge
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


def transport_cells(values, u, w, aperture, phi_old, phi_new, dt, dx, dz):
    """The values (nx, nz) after the grains have moved for dt.

    Parameters
    ----------
    values : (nx, nz) array
        Of every cell; in the air continued from the grains.
    u, w : (nx + 1, nz), (nx, nz + 1) arrays
        Velocity, continued beyond the surface, m/s.
    aperture : (nx + 1, nz) array
        Open part of each x-face.
    phi_old, phi_new : (nx + 1, nz + 1) arrays
        Level set at the nodes at both ends of the step, m.
    """
    flux_x, flux_z = np.empty_like(u), np.empty_like(w)
    volume_fluxes(flux_x, flux_z, u, w, aperture, phi_old, phi_new, dt, dx, dz)
    reach = rows_in_reach(phi_old, phi_new)
    inner, end = flux_x[1:-1].copy(), flux_x[-1].copy()
    passages = list_passages(inner, flux_z, end, cell_fractions(phi_old), reach, 1, 0)
    first, second = np.empty_like(values), np.empty_like(values)
    transport(first, values, np.pad(values, 2, mode="symmetric"), passages, 1, 1.0)
    transport(second, values, np.pad(first, 2, mode="symmetric"), passages, 1, 1.0)
    return continue_to_air(0.5 * (first + second), cell_fractions(phi_new))


def continue_to_air(values, filled):
    """The values (nx, nz) of the well-filled cells, continued to the others near the surface."""
    known = (filled >= TRUSTED).astype(np.int64)
    if not known.any():
        return values
    inside = values[known == 1]
    continued = values.copy()
    extrapolate(continued, known, LAYERS)
    return np.where(known > 0, np.clip(continued, inside.min(), inside.max()), values)
