"""A bed weaker than the user believes: grains slide on it where mu_bed is below their own friction.

    traction on the bed <= mu_bed times the normal stress

Limits: the friction of the bed has no memory and does not depend on the slip speed.

References
----------
Martin et al. (2017), equation 12.
"""

from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class BedFriction(Section):
    """A bed weaker than the user believes: grains slide on it, or it is a smooth plate."""

    mu_bed: (
        Annotated[
            float,
            key("-", "friction on the bed instead of boundary.mu_bed; 0 = free slip", ge=0, le=10),
        ]
        | None
    ) = None


def change_bed(case: "Case", section: BedFriction) -> "Case":
    """Put the friction into boundary.mu_bed."""
    if section.mu_bed is not None:
        case = replace(case, boundary=replace(case.boundary, mu_bed=section.mu_bed))
    return with_section(case, "bed_friction", None)


EFFECT = Effect(
    "bed_friction",
    PHYSICAL,
    BedFriction,
    priors={
        "mu_bed": Prior(
            "uniform",
            0.18,
            0.48,
            "A",
            "smooth plate, as beads on a lateral wall (0.18-0.25), to the friction of the grains",
            "low",
        ),
    },
    absorbed_in=("rheology.mu_1", "boundary.mu_bed"),
    change=change_bed,
    zero=({}, {"mu_bed": 0.48}),
)
