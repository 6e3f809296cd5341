"""A layer of the same grains on the bed, under the column and down the slope.

The bed of the channel frame, z = 0, is the bottom of the layer; the column stands on it and the
gate reaches down to its surface, z = thickness. Front, profiles and static-flowing interface are
measured from that surface (`observables`), so an eroded place has a negative height.

The layer has no end: the domain holds a piece of it, closed by a free-slip wall, and is lengthened
as soon as grains move near that wall. What is added is at rest, with the pressure of the layer
before it; its volume and its potential energy are booked. It is part of the implicit solve and
limits no time step. The layer must rest by itself: tan(slope) < mu_1 and mu_bed.
"""

import numpy as np

from .compiled import inner_jit

SPEED_NEAR_END = 1.0e-3  # m/s; slower grains near the end of the domain are at rest


def layer_thickness(case):
    """Thickness of the erodible layer, m; 0 without one."""
    effect = case.effects.erodible_bed
    return 0.0 if effect is None else effect.thickness


def join_layer(column, top, beyond, above_layer):
    """Signed distance to the surface of column and layer together.

    Parameters
    ----------
    column : array
        Signed distance of the column alone, m.
    top, beyond, above_layer : arrays
        Height above the top of the column, abscissa beyond its front, height above the layer, m.

    Returns
    -------
    array
        The lesser distance, but behind and below the foot of the column's front, where its front and
        the surface of the layer are both hidden: there the foot itself or the top is nearest.
    """
    hidden = (beyond < 0.0) & (above_layer < 0.0)
    within = np.maximum(top, -np.hypot(beyond, above_layer))
    return np.where(hidden, within, np.minimum(column, above_layer))


@inner_jit()
def moves_near_end(fields, geometry, columns):
    """Whether grains of the last `columns` columns move."""
    nx, nz = geometry.filled.shape
    for i in range(nx + 1 - columns, nx + 1):
        for k in range(nz):
            if geometry.index_u[i, k] >= 0 and abs(fields.u[i, k]) > SPEED_NEAR_END:
                return True
    for i in range(nx - columns, nx):
        for k in range(nz + 1):
            if geometry.index_w[i, k] >= 0 and abs(fields.w[i, k]) > SPEED_NEAR_END:
                return True
    return False


def extend_layer(state, added, thickness, z_nodes, dx):
    """Fill the `added` columns at the end of a domain that has just grown with the layer at rest."""
    state.level_set[-added:] = z_nodes - thickness
    state.pressure_filled[-added:] = state.pressure_filled[-added - 1]
    state.volume_0 += added * dx * thickness
