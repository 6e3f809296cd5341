"""Adhesion: grains hold each other with a pressure p_c, which rubs as any pressure and is the tension that they bear.

    tau = mu(I) (p + p_c),  I of p + p_c;    0 <= p + p_c  perpendicular to  div u - s >= 0

The solver's pressure is that between the grains, P' = p + p_c. So every law, every friction and the condition P' >= 0
stay as they are, and tension down to p = -p_c is what P' >= 0 allows. Inside the grains grad P' = grad p. At the free
surface p = 0, so P' = p_c: the grains are held together as by a membrane that presses with p_c. With the filled
fraction v of a cell and the divergence B of the faces the force of the pressure is B^T (v p), which is
B^T (v P') - B^T (v p_c).
The second term is that membrane. It acts in partly filled cells only, and grains with v P' = v p_c feel no force, to
the last bit. Cells with v <= `WET` have no pressure, and no membrane.

Where a layer ends within a cell, nodes and bed feel p_c over their whole wetted area, not in proportion to the filled
fraction (`viscous.pressure_at_node`, `coulomb_walls`). So a layer of any thickness has the strength mu p_c on its bed.

A cell in which P' has fallen to zero opens and goes on pulling with p_c while it opens, as a ductile bond: the grains
pay p_c div u for it. Walls hold the grains as the grains do each other: friction on them is that of the normal force
between grains and wall, p + p_c.

References
----------
Rumpf (1970), Chem. Ing. Tech. 42, 538, for p_c of contact forces; Rognon, Roux, Naaim & Chevoir (2008), J. Fluid Mech.
596, 21, and Berger, Azema, Douce & Radjai (2015), EPL 112, 64004, for mu(I) and I of p + p_c.
"""

from .compiled import inner_jit
from .geometry import WET
from .viscous import divergence


def adhesion_law(case):
    """Pressure p_c of a case, Pa; 0 where the effect is off."""
    effect = case.effects.cohesion
    return 0.0 if effect is None else float(effect.adhesion)


@inner_jit()
def adhesion_of(response):
    """Pressure p_c of a `Response`, Pa; 0 where it is None."""
    if response is None:
        return 0.0
    return response.adhesion


@inner_jit()
def add_membrane(response, rhs, geometry, sign, dx, dz):
    """Add sign times the force of the membrane, -B^T (v p_c), Pa/m, to the faces (n,) in `rhs`."""
    if response is None:
        return
    if response.adhesion <= 0.0:
        return
    iu, iw, aperture = geometry.index_u, geometry.index_w, geometry.aperture
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] <= WET:
                continue
            p = sign * response.adhesion * geometry.filled[i, k]
            left, right = p * aperture[i, k] / dx, p * aperture[i + 1, k] / dx
            a, b, c, d = iu[i, k], iu[i + 1, k], iw[i, k], iw[i, k + 1]
            for n, force in ((a, left), (b, -right), (c, p / dz), (d, -p / dz)):
                if n >= 0:
                    rhs[n] += force


@inner_jit()
def opening_power(adhesion, u, w, geometry, dx, dz):
    """Power that the grains pay for opening, p_c div u summed over cells, Pa/s."""
    power = 0.0
    for i in range(geometry.first, geometry.last):
        for k in range(geometry.reach[i]):
            if geometry.filled[i, k] > WET:
                power += geometry.filled[i, k] * divergence(u, w, geometry.aperture, i, k, dx, dz)
    return adhesion * power
