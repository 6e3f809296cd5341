"""Upwind reconstructions, shared by the advection of the level set and of the momentum."""

from .compiled import inner_jit

SMOOTH = 0.1


@inner_jit(error_model="numpy")
def upwind_weno3(behind, here, ahead):
    """Third-order WENO value at the side towards `ahead` of the cell whose mean is `here`; Jiang & Shu (1996).

    Differences well below `SMOOTH` of the value itself count as smooth: without that floor the
    weights drop the order to one beside every extremum.
    """
    back, front = here - behind, ahead - here
    smooth = SMOOTH**2 * (behind * behind + here * here + ahead * ahead) + 1e-99
    r = (smooth + back * back) / (smooth + front * front)
    weight = 1.0 / (1.0 + 2.0 * r * r)  # of the one-sided value, 1/3 where smooth
    return here + 0.5 * (weight * back + (1.0 - weight) * front)


@inner_jit(error_model="numpy")
def derivative_weno5(v1, v2, v3, v4, v5):
    """Fifth-order WENO combination of five divided differences, upwind first; Jiang & Peng (2000)."""
    s1 = 13.0 / 12.0 * (v1 - 2.0 * v2 + v3) ** 2 + 0.25 * (v1 - 4.0 * v2 + 3.0 * v3) ** 2
    s2 = 13.0 / 12.0 * (v2 - 2.0 * v3 + v4) ** 2 + 0.25 * (v2 - v4) ** 2
    s3 = 13.0 / 12.0 * (v3 - 2.0 * v4 + v5) ** 2 + 0.25 * (3.0 * v3 - 4.0 * v4 + v5) ** 2
    epsilon = 1e-6 * max(v1 * v1, v2 * v2, v3 * v3, v4 * v4, v5 * v5) + 1e-99
    a1, a2, a3 = 0.1 / (s1 + epsilon) ** 2, 0.6 / (s2 + epsilon) ** 2, 0.3 / (s3 + epsilon) ** 2
    p1 = v1 / 3.0 - 7.0 * v2 / 6.0 + 11.0 * v3 / 6.0
    p2 = -v2 / 6.0 + 5.0 * v3 / 6.0 + v4 / 3.0
    p3 = v3 / 3.0 + 5.0 * v4 / 6.0 - v5 / 6.0
    return (a1 * p1 + a2 * p2 + a3 * p3) / (a1 + a2 + a3)


@inner_jit(error_model="numpy")
def minmod(a, b):
    """The smaller of two slopes, zero if they differ in sign; without branches, which no processor foresees."""
    smaller = a if abs(a) < abs(b) else b
    return smaller if a * b > 0.0 else 0.0


@inner_jit()
def cubic(a, b, c, d, t):
    """Catmull-Rom interpolation a share t of the way from b to c, of equally spaced values a, b, c, d."""
    slope = 0.5 * (c - a)
    return b + t * (
        slope + t * (a - 2.5 * b + 2.0 * c - 0.5 * d + t * (1.5 * (b - c) + 0.5 * (d - a)))
    )
