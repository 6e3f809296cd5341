"""A flow that is faster in the middle of the channel than at its lateral walls.

    velocity across the channel  U f,  f = a (1 - c (2 y/w)^2),  c = 1 - 1/r,  a = 1/(1 - c/3)

r is the velocity in the middle over that at the walls. The advection of the mean momentum changes with the mean of
f^2 (`fvcollapse/step/transverse_profile.py`). A camera at the wall, or above the middle of the channel, sees
grains that moved slower or faster than the mean: what lies beyond the gate is seen at gate + factor x distance,
heights unchanged.

Limits: the view is a purely kinematic surrogate for a curved front, and an upper bound, since a real front is fed
from behind.
"""

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, Seeing

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class TransverseProfile(Section):
    """A flow that is faster in the middle of the channel than at its lateral walls."""

    velocity_ratio: Annotated[
        float, key("-", "velocity in the middle over that at the walls", ge=1, inf=True, most=1e6)
    ] = 1.0
    view: Annotated[
        Literal["average", "wall", "centre"],
        key("-", "what the measurement sees: the mean of the width, the wall, the middle"),
    ] = "average"


def curvature(velocity_ratio: float) -> float:
    """C of the parabola: 0 = plug, 1 = the grains stick to the walls."""
    return 1.0 - 1.0 / velocity_ratio


def middle_factor(velocity_ratio: float) -> float:
    """Velocity in the middle of the channel over its mean across the width."""
    return 1.0 / (1.0 - curvature(velocity_ratio) / 3.0)


def view_factor(velocity_ratio: float, view: str) -> float:
    """Velocity at the "wall", in the "centre" or its "average", over the mean across the width."""
    if view == "average":
        return 1.0
    middle = middle_factor(velocity_ratio)
    return middle if view == "centre" else middle / velocity_ratio


def seen_from_a_side(section: TransverseProfile, case: "Case", x: np.ndarray) -> np.ndarray:
    """Abscissae (n,) at which a camera sees the grains at x (n,), m."""
    excess = view_factor(section.velocity_ratio, section.view) - 1.0
    return x + excess * np.maximum(x - case.geometry.length_0, 0.0)


EFFECT = Effect(
    "transverse_profile",
    PHYSICAL,
    TransverseProfile,
    priors={
        "velocity_ratio": Prior(
            "uniform", 1.0, 1.5, "A2", "1.2-1.4 at the surface of a collapse in a channel"
        ),
    },
    absorbed_in=("rheology.mu_1",),
    variants=({"view": "average"}, {"view": "wall"}, {"view": "centre"}),
    see=Seeing(place=seen_from_a_side),
    seen_keys=("view",),
    needs_walls=True,
    zero=({}, {"view": "wall"}),
)
