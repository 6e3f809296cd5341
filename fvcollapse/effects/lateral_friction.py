"""Friction of the grains on the lateral walls of the channel, which acts only where channel_width is finite.

    sink of momentum  -(2/w) mu_wall K_w [p]+ u/|u|

K_w p is the pressure on the walls. The closure `sink_weakening` lets the friction fall with the depth below
the surface, from mu_wall to deep_ratio mu_wall; `friction_increase` is the older closure, which raises
mu_1 and mu_2 by mu_wall K_w flowing_thickness / w instead.

Limits: width-averaged; both walls are alike. The discretisation stands in `fvcollapse/step/lateral_friction.py`.

References
----------
Martin et al. (2017), equations 19 and 21; Richard et al. (2008), Phys. Rev. Lett. 101, 248002, and Artoni &
Richard (2015), Phys. Rev. Lett. 115, 158001, for the weakening.
"""

from typing import Annotated, Literal

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior


class LateralFriction(Section):
    """Friction on the lateral walls; acts only where channel_width is finite."""

    mu_wall: Annotated[
        float, key("-", "friction coefficient on the lateral walls", ge=0, le=10)
    ] = 0.18
    pressure_ratio: Annotated[
        float, key("-", "K_w: the pressure on the lateral walls is K_w p", ge=0, le=10)
    ] = 1.0
    closure: Annotated[
        Literal["sink", "sink_weakening", "friction_increase"],
        key("-", "sink of momentum, it weakening with depth, or an increase of mu_1 and mu_2"),
    ] = "sink"
    deep_ratio: Annotated[
        float, key("-", "sink_weakening: friction far below the surface over mu_wall", ge=0, le=1)
    ] = 0.5
    weakening_depth: Annotated[
        float, key("m", "sink_weakening: depth over which it falls by 1/e", gt=0, le=1000)
    ] = 0.02
    scheme: Annotated[
        Literal["implicit", "split"],
        key("-", "closures with a sink: in the solve, or before the projection"),
    ] = "implicit"
    flowing_thickness: Annotated[
        float,
        key(
            "m",
            "friction_increase: mu_1, mu_2 += mu_wall flowing_thickness / channel_width",
            gt=0,
            le=1000,
        ),
    ] = 0.05


EFFECT = Effect(
    "lateral_friction",
    PHYSICAL,
    LateralFriction,
    priors={
        "mu_wall": Prior(
            "uniform",
            0.15,
            0.30,
            "A",
            "0.18-0.25 for beads on plexiglas, 0.30 for gravel; the margin below is C, and 0.46 "
            "(Lajeunesse et al. 2005, one channel) lies outside",
        ),
        "pressure_ratio": Prior(
            "uniform",
            0.5,
            1.1,
            "C",
            "isotropic flow 1; a pile at rest about 0.75: horizontal over vertical stress is "
            "1 - sin(angle of repose) = 0.57, but p is their mean; and a margin",
        ),
        "deep_ratio": Prior(
            "uniform", 0.2, 1.0, "C", "weakening seen in experiments and simulations"
        ),
        "weakening_depth": Prior(
            "loguniform", 0.005, 0.05, "C", "7 to 70 grain diameters, the depth of flow"
        ),
    },
    absorbed_in=("rheology.mu_1", "boundary.mu_bed"),
    variants=(
        {"closure": "sink", "deep_ratio": None, "weakening_depth": None},
        {"closure": "sink_weakening"},
        {"closure": "friction_increase", "deep_ratio": None, "weakening_depth": None},
    ),
    term="lateral_friction",
    needs_walls=True,
    zero=({"mu_wall": 0.0},),
)
