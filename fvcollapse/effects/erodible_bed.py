"""A layer of the same grains, at rest on the bed under the column and down the slope.

The layer is part of the mass that the solve moves; how the domain continues it stands in
`fvcollapse/step/erodible_bed.py`.

Limits: the layer must rest by itself, tan(slope) < mu_1 and mu_bed, and must be no film; the domain grows, and
the column is a rectangle.
"""

from collections.abc import Iterator
from math import atan, degrees, radians, tan
from typing import TYPE_CHECKING, Annotated

from fvcollapse.case.grammar import Section, key, show
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class ErodibleBed(Section):
    """A layer of the same grains, at rest on the bed under the column and down the slope."""

    thickness: Annotated[float, key("m", "thickness of the layer", ge=0, le=1000)] = 0.0


def without_rest(case: "Case", section: ErodibleBed) -> Iterator[tuple[str, str, str]]:
    """The layer rests by itself, is no film, and has nothing but itself at its end."""
    if section.thickness == 0.0:
        return
    film = case.numerics.film_thickness
    if section.thickness < film:
        limit = f"0, or >= numerics.film_thickness = {film:g}"
        yield "effects.erodible_bed.thickness", f"{section.thickness:g}", limit
    for name, found, allowed in (
        ("boundary.right_end", case.boundary.right_end, "grow"),
        ("boundary.ends", case.boundary.ends, "walls"),
        ("geometry.polygon", "a polygon" if case.geometry.polygon else "absent", "absent"),
    ):
        if found != allowed:
            yield name, show(found), f"{show(allowed)} with effects.erodible_bed"
    slope = case.geometry.slope_angle_deg
    friction = max(min(friction_at_rest(case), case.boundary.mu_bed), 0.0)
    if tan(radians(abs(slope))) >= friction:
        limit = f"below {degrees(atan(friction)):.4g}, where a layer on the bed rests by itself"
        yield "geometry.slope_angle_deg", f"{slope:g}", limit


def friction_at_rest(case: "Case") -> float:
    """Friction coefficient inside the layer at rest: loose grains rub less until they are compacted."""
    inside, dilatancy = case.rheology.mu_1, case.effects.dilatancy
    if dilatancy is not None:
        fraction = (
            dilatancy.solid_fraction_0 or case.rheology.density_bulk / case.rheology.density_grain
        )
        loose = min(fraction - dilatancy.solid_fraction_critical, 0.0)
        inside += dilatancy.dilatancy_factor * loose
    return inside


EFFECT = Effect(
    "erodible_bed",
    PHYSICAL,
    ErodibleBed,
    priors={
        "thickness": Prior(
            "loguniform", 0.002, 0.014, "C", "3 to 20 grain diameters; 1.4 cm in one study (A)"
        ),
    },
    absorbed_in=("boundary.mu_bed",),
    refuse=without_rest,
)
