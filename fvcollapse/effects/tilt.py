"""Error of the slope: the bed of the laboratory is inclined by geometry.slope_angle_deg + angle_deg."""

from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import NUISANCE, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class Tilt(Section):
    """Error of the slope: the bed of the laboratory is not inclined as stated."""

    angle_deg: Annotated[float, key("deg", "added to geometry.slope_angle_deg", ge=-3, le=3)] = 0.0


def change_slope(case: "Case", section: Tilt) -> "Case":
    """Add the angle to the slope."""
    angle = case.geometry.slope_angle_deg + section.angle_deg
    case = replace(case, geometry=replace(case.geometry, slope_angle_deg=angle))
    return with_section(case, "tilt", None)


EFFECT = Effect(
    "tilt",
    NUISANCE,
    Tilt,
    priors={"angle_deg": Prior("normal", 0.0, 0.3, "C", "a spirit level over a channel of 3 m")},
    absorbed_in=("rheology.mu_1", "boundary.mu_bed"),
    change=change_slope,
)
