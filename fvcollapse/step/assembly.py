"""The banded system of a nonlinear sweep: inertia, weight, friction, viscous stress and pressure."""

from .adhesion import add_membrane
from .compiled import inner_jit, kernel_jit
from .geometry import MASS_FLOOR, last_face
from .grain_response import add_source
from .viscous import add_cells, add_nodes


@kernel_jit()
def add_diagonal(band, rhs, work, u_star, w_star, geometry, balance, dx, dz):
    """Inertia, weight and wall frictions: the diagonal of the band and the right-hand side."""
    inertia = balance.density / balance.dt
    for i in range(geometry.first, last_face(geometry)):
        for k in range(geometry.reach[i]):
            n = geometry.index_u[i, k]
            if n >= 0:
                mass = geometry.mass_x[i, k]
                m = inertia * max(mass, MASS_FLOOR)
                band[n, 0] += m + work.sink_x[i, k]
                if k == 0:
                    band[n, 0] += work.k_bed[i] / dz
                rhs[n] = m * u_star[i, k] + balance.density * balance.gx * mass
                if k == 0:
                    rhs[n] -= work.bed_drag[i] / dz
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            n = geometry.index_w[i, k]
            if n >= 0:
                mass = geometry.mass_z[i, k]
                m = inertia * max(mass, MASS_FLOOR)
                band[n, 0] += m + work.sink_z[i, k]
                if i == 0:
                    band[n, 0] += work.k_wall[k] / dx
                rhs[n] = m * w_star[i, k] + balance.density * balance.gz * mass + work.side[i, k]
                if i == balance.gate_column - 1:
                    band[n, 0] += work.k_gate[k] / dx
                    rhs[n] += work.k_gate[k] / dx * balance.gate_speed


@inner_jit()
def add_pressure_force(rhs, pressure_filled, geometry, dx, dz):
    """Rhs += B^T P: minus the discrete pressure gradient."""
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            p = pressure_filled[i, k]
            if p != 0.0:
                if iu[i, k] >= 0:
                    rhs[iu[i, k]] -= p * aperture[i, k] / dx
                if iu[i + 1, k] >= 0:
                    rhs[iu[i + 1, k]] += p * aperture[i + 1, k] / dx
                if iw[i, k] >= 0:
                    rhs[iw[i, k]] -= p / dz
                if iw[i, k + 1] >= 0:
                    rhs[iw[i, k + 1]] += p / dz


@kernel_jit()
def assemble(band, rhs, work, pressure_filled, u_star, w_star, geometry, balance, dx, dz):
    """Matrix and right-hand side of one sweep, from the coefficients in `work`; released cells lose their pressure.

    `band` is zero before, as `solve_factorised` leaves it.
    """
    add_diagonal(band, rhs, work, u_star, w_star, geometry, balance, dx, dz)
    add_cells(band, work.weight_centre, work.constrained, work.response.penalty, geometry, dx, dz)
    add_nodes(band, work.weight_node, geometry, dx, dz)
    for i in range(work.constrained.shape[0]):
        for k in range(work.constrained.shape[1]):
            if not work.constrained[i, k]:
                pressure_filled[i, k] = 0.0
    add_pressure_force(rhs, pressure_filled, geometry, dx, dz)
    add_membrane(balance.response, rhs, geometry, 1.0, dx, dz)
    add_source(balance.response, rhs, work.response, work.constrained, geometry, dx, dz)
