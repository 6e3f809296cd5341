"""Velocity beyond the surface: continued outwards layer by layer, for the advection of surface and momentum."""
from numba import njit

LAYERS = 7  # the level-set band plus the reach of the advection stencils
SOLENOIDAL_LAYERS = 2  # empty cells beyond the surface in which the continued velocity is made divergence-free


@njit(cache=True)
def extrapolate(field, known, layers):
    """Fill the faces where `known` is 0, outwards, with the mean of the neighbours known one layer further in.

    Parameters
    ----------
    field : 2-D float array
        One velocity component; faces beyond the last layer are set to zero.
    known : 2-D int array of the same shape
        1 where the value stands, 0 where it is to be found; overwritten with the layer number.
    """
    nx, nz = field.shape
    for layer in range(1, layers + 1):
        for i in range(nx):
            for k in range(nz):
                if known[i, k] != 0:
                    continue
                total = 0.0
                count = 0
                for di in range(-1, 2):
                    for dk in range(-1, 2):
                        a, b = i + di, k + dk
                        if 0 <= a < nx and 0 <= b < nz and 0 < known[a, b] <= layer:
                            weight = 2 if di == 0 or dk == 0 else 1
                            total += weight * field[a, b]
                            count += weight
                if count > 0:
                    field[i, k] = total / count
                    known[i, k] = layer + 1
    for i in range(nx):
        for k in range(nz):
            if known[i, k] == 0:
                field[i, k] = 0.0


@njit(cache=True)
def mark_known(known_u, known_w, geometry, least):
    """Faces whose own velocity is trusted: walls, closed gate, and unknowns with at least `least` of a full mass."""
    nx, nz = geometry.filled.shape
    for i in range(nx + 1):
        for k in range(nz):
            solid = i == 0 or geometry.aperture[i, k] == 0.0
            known_u[i, k] = 1 if solid or (geometry.index_u[i, k] >= 0 and geometry.mass_x[i, k] >= least) else 0
    for i in range(nx):
        for k in range(nz + 1):
            known_w[i, k] = 1 if k == 0 or (geometry.index_w[i, k] >= 0 and geometry.mass_z[i, k] >= least) else 0


@njit(cache=True)
def close_divergence(u, w, known_u, known_w, filled, layers, dx, dz):
    """Make the continued velocity solenoidal in the first empty cells beyond the surface, layer by layer.

    The outer faces of each empty cell (known later than the others) share the correction that closes its divergence.
    """
    nx, nz = filled.shape
    for layer in range(2, layers + 2):
        for i in range(1, nx):
            for k in range(nz):
                if filled[i, k] > 1.0e-8:
                    continue
                top = max(max(known_u[i, k], known_u[i + 1, k]), max(known_w[i, k], known_w[i, k + 1]))
                low = min(min(known_u[i, k], known_u[i + 1, k]), min(known_w[i, k], known_w[i, k + 1]))
                if top != layer or low == 0:
                    continue
                div = (u[i + 1, k] - u[i, k]) / dx + (w[i, k + 1] - w[i, k]) / dz
                total = 0.0
                if known_u[i, k] == layer:
                    total += 1.0 / dx**2
                if known_u[i + 1, k] == layer:
                    total += 1.0 / dx**2
                if known_w[i, k] == layer:
                    total += 1.0 / dz**2
                if known_w[i, k + 1] == layer:
                    total += 1.0 / dz**2
                if known_u[i, k] == layer:
                    u[i, k] += div / dx / total
                if known_u[i + 1, k] == layer:
                    u[i + 1, k] -= div / dx / total
                if known_w[i, k] == layer:
                    w[i, k] += div / dz / total
                if known_w[i, k + 1] == layer:
                    w[i, k + 1] -= div / dz / total
