"""The shear on upright sides beside the surface, which the planes of the nodes leave out.

The stress at a node (`shear_planes`) is that of its level plane. On the faces above and below it acts in full, but on
the grains to its left and right it stands for the mean over a whole row, from half a row below the node to half a row
above. Below a surface a part f of a row above the node the shear stress falls linearly to zero, by t a row, so on these
sides the nodes of a column count less than the stress acts on, by

    t (1/2 - f)^2 / 2,

the trapezoidal rule of a ramp that ends between its points. It is the same for all rows of a lying surface. Where the
surface crosses the rows it changes along the slope, with a jump of its derivative at each crossing: without it the
vertical force on the grains, and with it the pressure of all rows below, has a sawtooth, and resting surfaces step.
"""

from .compiled import inner_jit, kernel_jit


@kernel_jit(error_model="numpy")
def fill_cuts(cut_row, cut_part, level_set):
    """Where the surface crosses each upright grid line.

    Parameters
    ----------
    cut_row : (nx + 1,) int64 array
        Result: row of the highest wet node below air; -1 without one.
    cut_part : (nx + 1,) array
        Result: part f of the edge above it that is wet.
    level_set : (nx + 1, nz + 1) array
        m.
    """
    for i in range(cut_row.size):
        k = level_set.shape[1] - 1
        while k >= 0 and level_set[i, k] >= 0.0:
            k -= 1
        cut_row[i], cut_part[i] = -1, 0.0
        if 0 <= k < level_set.shape[1] - 1:
            cut_row[i] = k
            cut_part[i] = level_set[i, k] / (level_set[i, k] - level_set[i, k + 1])


@inner_jit(error_model="numpy")
def _lacking(weight_node, g_node, geometry, i):
    """Shear stress that is lacking at upright line i, Pa, and the row of z-faces beside it that lack it.

    Row -1 where no node below the surface shows how the stress rises: in a layer of less than two rows.
    """
    k, part = geometry.cut_row[i], geometry.cut_part[i]
    if k < 2 or not geometry.interior[i, k - 1]:
        return 0.0, -1
    per_row = weight_node[i, k - 1] * g_node[i, k - 1] / (1.0 + part)
    share = geometry.lying[i, k] if k < geometry.reach[i] else 1.0
    return 0.5 * share * (0.5 - part) ** 2 * per_row, k if part < 0.5 else k + 1


@kernel_jit()
def side_shear(side, weight_node, g_node, geometry, dx):
    """Force on the z-faces that the stress of the nodes leaves out, N/m3, of the present stress.

    Parameters
    ----------
    side : (nx, nz + 1) array
        Result.
    weight_node, g_node : (nx + 1, nz + 1) arrays
        Viscosity times wetted part, Pa s, and shear rate, 1/s.
    """
    side[:] = 0.0
    for i in range(geometry.first, geometry.last):
        left, left_row = _lacking(weight_node, g_node, geometry, i)
        right, right_row = _lacking(weight_node, g_node, geometry, i + 1)
        if left_row < 0 or right_row < 0:
            continue
        side[i, left_row] -= left / dx
        side[i, right_row] += right / dx


@inner_jit()
def side_power(side, w, geometry):
    """Power of this force, summed over faces, Pa/s."""
    power = 0.0
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if side[i, k] != 0.0 and geometry.index_w[i, k] >= 0:
                power += side[i, k] * w[i, k]
    return power
