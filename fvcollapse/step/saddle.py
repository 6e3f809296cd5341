"""Cells of which two opposite corners are wet and two are dry: one piece of grains, or two.

The four edges alone do not tell. The bilinear surface through the corner values a, b, c, d (a and c wet)
joins the wet corners if a c > b d (the asymptotic decider of Nielson & Hamann 1991, Proc. IEEE
Visualization, 83). Cut by straight lines, the two cases differ by up to half a cell, and always one of
them, the volume would jump when a corner of the surface passes a node. The moments are therefore the
mean of both, joined with the weight a c/(a c + b d): they are continuous in all four values, and grains
and air together fill the cell.
"""

from .compiled import inner_jit


@inner_jit()
def is_saddle(phi_00, phi_10, phi_11, phi_01):
    """Whether two opposite corners are wet and the other two dry."""
    wet = phi_00 < 0.0
    return (phi_11 < 0.0) == wet and (phi_10 < 0.0) != wet and (phi_01 < 0.0) != wet


@inner_jit(error_model="numpy")
def saddle_moments(phi_00, phi_10, phi_11, phi_01):
    """Area and first moments of the grains in such a cell; corners as in `polygon_moments`."""
    rising = _triangles(phi_00, phi_10, phi_11, phi_01)  # at the corners 00 and 11
    area, x, z = _triangles(phi_10, phi_00, phi_01, phi_11)  # at 10 and 01, mirrored in x
    falling = area, area - x, z
    main, other = phi_00 * phi_11, phi_10 * phi_01
    share = main / (main + other)  # of the joined piece at 00 and 11
    wet, dry = rising, falling
    if phi_00 >= 0.0:
        wet, dry, share = falling, rising, 1.0 - share
    return (
        (1.0 - share) * wet[0] + share * (1.0 - dry[0]),
        (1.0 - share) * wet[1] + share * (0.5 - dry[1]),
        (1.0 - share) * wet[2] + share * (0.5 - dry[2]),
    )


@inner_jit(error_model="numpy")
def _triangles(a, b, c, d):
    """Area and moments of the triangles cut off at the corners of a (0, 0) and c (1, 1)."""
    p, q = a / (a - b), a / (a - d)
    r, s = c / (c - d), c / (c - b)
    first, second = 0.5 * p * q, 0.5 * r * s
    return (
        first + second,
        first * p / 3.0 + second * (1.0 - r / 3.0),
        first * q / 3.0 + second * (1.0 - s / 3.0),
    )
