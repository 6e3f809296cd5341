"""Residual of the momentum balance after the sweeps of a step."""

import math

from .adhesion import add_membrane
from .arrays import larger
from .compiled import inner_jit, kernel_jit
from .geometry import MASS_FLOOR, last_face


@inner_jit()
def add_stresses(residual, work, u, w, geometry, dx, dz):
    """Subtract viscous stress and pressure of cells and nodes from the residual of their faces."""
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            e = (
                4.0
                * work.weight_centre[i, k]
                * 0.5
                * (
                    (aperture[i + 1, k] * u[i + 1, k] - aperture[i, k] * u[i, k]) / dx
                    - (w[i, k + 1] - w[i, k]) / dz
                )
            )
            p = work.multiplier[i, k]
            _add(residual, iu[i, k], (-0.5 * e + p) * aperture[i, k] / dx)
            _add(residual, iu[i + 1, k], (0.5 * e - p) * aperture[i + 1, k] / dx)
            _add(residual, iw[i, k], (0.5 * e + p) / dz)
            _add(residual, iw[i, k + 1], (-0.5 * e - p) / dz)
            if work.weight_node[i, k] > 0.0:
                g = work.weight_node[i, k] * (
                    (u[i, k] - u[i, k - 1]) / dz + (w[i, k] - w[i - 1, k]) / dx
                )
                _add(residual, iu[i, k - 1], -g / dz)
                _add(residual, iu[i, k], g / dz)
                _add(residual, iw[i - 1, k], -g / dx)
                _add(residual, iw[i, k], g / dx)


@inner_jit()
def add_inertia(residual, work, u, w, u_star, w_star, geometry, balance, dx, dz):
    """Add inertia, friction and weight to the residual of every face."""
    iu, iw = geometry.index_u, geometry.index_w
    inertia = balance.density / balance.dt
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            if iu[i, k] >= 0:
                mass = geometry.mass_x[i, k]
                friction = work.sink_x[i, k] * u[i, k]
                if k == 0:
                    friction += (work.k_bed[i] * u[i, k] + work.bed_drag[i]) / dz
                residual[iu[i, k]] += (
                    inertia * max(mass, MASS_FLOOR) * (u[i, k] - u_star[i, k])
                    + friction
                    - balance.density * balance.gx * mass
                )
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if iw[i, k] >= 0:
                mass = geometry.mass_z[i, k]
                friction = work.sink_z[i, k] + (work.k_wall[k] / dx if i == 0 else 0.0)
                residual[iw[i, k]] += (
                    inertia * max(mass, MASS_FLOOR) * (w[i, k] - w_star[i, k])
                    + friction * w[i, k]
                    - balance.density * balance.gz * mass
                    - work.side[i, k]
                )
                if i == balance.gate_column - 1:
                    residual[iw[i, k]] += work.k_gate[k] / dx * (w[i, k] - balance.gate_speed)


@kernel_jit()
def momentum_residual(residual, work, u, w, u_star, w_star, geometry, balance, dx, dz):
    """Largest residual of the momentum balance, relative to the weight; independent of the factorisation."""
    residual[:] = 0.0
    add_stresses(residual, work, u, w, geometry, dx, dz)
    add_membrane(balance.response, residual, geometry, -1.0, dx, dz)
    add_inertia(residual, work, u, w, u_star, w_star, geometry, balance, dx, dz)
    weight = balance.density * math.sqrt(balance.gx**2 + balance.gz**2)
    largest = 0.0
    for n in range(residual.size):
        largest = larger(largest, abs(residual[n]))
    return largest / weight if weight > 0.0 else largest


@inner_jit()
def _add(vector, n, value):
    if n >= 0:
        vector[n] += value
