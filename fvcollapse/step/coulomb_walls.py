"""Coulomb friction with stick and slip on the bed and on the back wall (equations 12-14).

The half cell between the wall and the first velocity u_0 is solved exactly: if the traction tau of
the no-slip state, shear rate 2|u_0|/h, stays below mu_f times the normal reaction N, the grains
stick and tau acts; else they slip and the traction is mu_f N. N is the discrete reaction of the
wall itself: pressure at the first centre, the weight carried by the half cell below it, and the
viscous normal stress. It is handed to the faces by the same lever rule as the mass, so a plug of
any thickness, down to a fraction of a cell, feels exactly mu_f N. mu = inf is no slip, mu = 0 free
slip.
"""

import math

from .compiled import inner_jit, kernel_jit
from .geometry import WET
from .rheology import effective_viscosity, shear_rate_at_stress, with_extra_friction


@kernel_jit()
def bed_reaction(pressure_filled, weight_centre, e_centre, geometry, i, gz, density, dz):
    """Normal reaction of the bed under cell (i, 0), Pa averaged over the cell, >= 0."""
    carried = density * gz * dz * (geometry.filled[i, 0] - geometry.lever_z[i, 0])
    carried *= geometry.packing[i, 0]
    return max(pressure_filled[i, 0] + 2.0 * weight_centre[i, 0] * e_centre[i, 0] - carried, 0.0)


@kernel_jit()
def back_wall_reaction(pressure_filled, weight_centre, e_centre, geometry, k, gx, density, dx):
    """Normal reaction of the back wall on cell (0, k), Pa averaged over the cell, >= 0."""
    carried = density * gx * dx * (geometry.filled[0, k] - geometry.lever_x[0, k])
    carried *= geometry.packing[0, k]
    return max(pressure_filled[0, k] - 2.0 * weight_centre[0, k] * e_centre[0, k] - carried, 0.0)


@inner_jit()
def wall_traction(speed, half_width, reaction, coverage, mu_wall, material):
    """Traction and slip of one half cell.

    Parameters
    ----------
    speed : float
        |u_0|, m/s, at `half_width` (m) from the wall.
    reaction : float
        Normal reaction, Pa, averaged over the face's share of the wall.
    coverage : float
        Part of that share which is wet, (0, 1].
    mu_wall : float
        Friction coefficient; inf = no slip.

    Returns
    -------
    traction, slip : float
        Pa averaged over the share; slip speed in m/s, between 0 and `speed`.
    """
    rate = speed / half_width
    pressure = reaction / coverage
    stuck = coverage * rate * effective_viscosity(rate, pressure, material)
    if mu_wall == math.inf or stuck <= mu_wall * reaction:
        return stuck, 0.0
    traction = mu_wall * reaction
    sheared = shear_rate_at_stress(traction / coverage, pressure, rate, material)
    return traction, speed - half_width * sheared


@inner_jit()
def friction_coefficient(speed, half_width, reaction, coverage, mu_wall, material):
    """Friction coefficient traction / |u_0| (Pa s/m) and slip speed; at rest the no-slip limit, which then is exact."""
    if coverage <= 0.0 or mu_wall == 0.0:
        return 0.0, speed
    if speed < 1e-300:
        eta = effective_viscosity(0.0, reaction / coverage, material)
        return coverage * eta / half_width, 0.0
    traction, slip = wall_traction(speed, half_width, reaction, coverage, mu_wall, material)
    return traction / speed, slip


@inner_jit()
def bed_friction(
    k_bed,
    bed_slip,
    u,
    pressure_filled,
    weight_centre,
    e_centre,
    extra_friction,
    bed_excess,
    geometry,
    material,
    gz,
    density,
    mu_bed,
    adhesion,
    dz,
):
    """Friction coefficients (nx + 1,) of the bed faces in Pa s/m, and their slip velocities in m/s.

    `extra_friction` (nx, nz) is friction of the grains themselves, not of the bed; `bed_excess` (nx,) is added to
    the friction of a bed that has any. `adhesion` is p_c, Pa, which acts on all of the wetted bed (`adhesion`).
    """
    nx = pressure_filled.shape[0]
    k_bed[:] = 0.0
    for i in range(1, nx + 1):
        if geometry.index_u[i, 0] < 0:
            bed_slip[i] = u[i, 0]
            continue
        reaction = coverage = extra = excess = shares = 0.0
        for cell in range(i - 1, min(i + 1, nx)):
            v = geometry.filled[cell, 0]
            if v > WET:
                share = geometry.lever_x[cell, 0] / v
                if cell == i:
                    share = 1.0 - share
                reaction += share * bed_reaction(
                    pressure_filled, weight_centre, e_centre, geometry, cell, gz, density, dz
                )
                reaction += share * adhesion * (geometry.bed_cover[cell] - v)
                coverage += share * geometry.bed_cover[cell]
                extra += share * extra_friction[cell, 0]
                excess += share * bed_excess[cell]
                shares += share
        extra = extra / shares if shares > 0.0 else 0.0
        excess = excess / shares if shares > 0.0 and mu_bed > 0.0 else 0.0
        grains = with_extra_friction(material, extra)
        k_bed[i], slip = friction_coefficient(
            abs(u[i, 0]), 0.5 * dz, reaction, coverage, mu_bed + excess, grains
        )
        bed_slip[i] = math.copysign(slip, u[i, 0])


@inner_jit()
def back_wall_friction(
    k_wall,
    wall_slip,
    w,
    pressure_filled,
    weight_centre,
    e_centre,
    extra_friction,
    geometry,
    material,
    gx,
    density,
    mu_wall,
    dx,
):
    """Friction coefficients (nz + 1,) of the z-faces beside the back wall, Pa s/m, and slip speeds, m/s."""
    nz = pressure_filled.shape[1]
    k_wall[:] = 0.0
    wall_slip[:] = 0.0
    for k in range(1, nz):
        if geometry.index_w[0, k] < 0:
            continue
        reaction = coverage = extra = shares = 0.0
        for cell in range(k - 1, k + 1):
            v = geometry.filled[0, cell]
            if v > WET:
                share = geometry.lever_z[0, cell] / v
                if cell == k:
                    share = 1.0 - share
                reaction += share * back_wall_reaction(
                    pressure_filled, weight_centre, e_centre, geometry, cell, gx, density, dx
                )
                coverage += share * geometry.wall_cover[cell]
                extra += share * extra_friction[0, cell]
                shares += share
        extra = extra / shares if shares > 0.0 else 0.0
        grains = with_extra_friction(material, extra)
        k_wall[k], wall_slip[k] = friction_coefficient(
            abs(w[0, k]), 0.5 * dx, reaction, coverage, mu_wall, grains
        )
