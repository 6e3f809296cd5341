"""Cells of which two opposite corners are wet and two are dry: whether their grains are one piece or two.

The four edges alone do not tell. The bilinear surface through the corner values does: the wet corners
a, c are joined if the value at its saddle point is negative, which is a c > b d for the dry corners b, d
(the asymptotic decider of Nielson & Hamann 1991, Proc. IEEE Visualization, 83). Always
joined, a cell gained half of its volume at once when one corner of the surface passed a node.
"""

from .compiled import inner_jit


@inner_jit()
def is_parted(phi_00, phi_10, phi_11, phi_01):
    """Whether two opposite corners are wet and not joined through the middle of the cell."""
    wet = phi_00 < 0.0
    if (phi_11 < 0.0) != wet or (phi_10 < 0.0) == wet or (phi_01 < 0.0) == wet:
        return False
    main, other = phi_00 * phi_11, phi_10 * phi_01
    return main <= other if wet else other < main


@inner_jit(error_model="numpy")
def parted_moments(phi_00, phi_10, phi_11, phi_01):
    """Area and first moments of the two wet corner triangles of such a cell; corners as in `polygon_moments`."""
    if phi_00 < 0.0:
        p, q = phi_00 / (phi_00 - phi_10), phi_00 / (phi_00 - phi_01)
        r, s = phi_11 / (phi_11 - phi_01), phi_11 / (phi_11 - phi_10)
        x_first, z_first, x_second, z_second = p / 3.0, q / 3.0, 1.0 - r / 3.0, 1.0 - s / 3.0
    else:
        p, q = phi_10 / (phi_10 - phi_00), phi_10 / (phi_10 - phi_11)
        r, s = phi_01 / (phi_01 - phi_11), phi_01 / (phi_01 - phi_00)
        x_first, z_first, x_second, z_second = 1.0 - p / 3.0, q / 3.0, r / 3.0, 1.0 - s / 3.0
    first, second = 0.5 * p * q, 0.5 * r * s
    return (
        first + second,
        first * x_first + second * x_second,
        first * z_first + second * z_second,
    )
