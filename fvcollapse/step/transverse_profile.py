"""A flow that is faster in the middle of the channel than at its lateral walls.

Averaged over the width, a velocity U(x, z) f(y) with the mean of f equal to 1 carries the momentum
beta U U, with the shape factor beta = mean of f^2 >= 1. Across the channel a parabola with slip at
the walls is taken,

    f = a (1 - c (2 y/w)^2),  c = 1 - 1/r,  a = 1/(1 - c/3),  r = velocity in the middle / at the wall.

The advection becomes beta (U . grad) U: div(beta U U) wherever the cells are full, since there
div U = 0. At the free surface, which moves with U itself, the conservative form would hand to each
newly wetted cell beta times the momentum of what fills it, at every cell anew: a thin front would
run away from its own grains. In the form used a uniform velocity stays uniform; the price is that
(beta - 1) times the momentum of the mass that enters or leaves a cell is not conserved there. For
r = 1.2 to 1.4 beta - 1 is 0.3 to 0.9 %: what counts is where the flow is seen.

Linearised, disturbances travel at up to (beta + sqrt(beta^2 - beta)) U; the explicit advection
itself moves momentum at beta U, which limits its time step (`limit_advection`).
"""

from fvcollapse.effects.transverse_profile import curvature, middle_factor


def shape_factor(velocity_ratio):
    """Mean of f^2: beta, 1 for a plug and 6/5 for a parabola that vanishes at the walls."""
    c = curvature(velocity_ratio)
    return middle_factor(velocity_ratio) ** 2 * (1.0 - 2.0 * c / 3.0 + c * c / 5.0)


def shape_factor_of(case):
    """Beta of a case, 1 without the effect."""
    effect = case.effects.transverse_profile
    return 1.0 if effect is None else shape_factor(effect.velocity_ratio)
