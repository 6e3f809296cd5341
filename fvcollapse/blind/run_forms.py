"""The forms of one run of a label: its truth, forces, wrong readings, and the form of the response to its effects."""

from collections.abc import Sequence
from typing import Annotated

import msgspec

Whole = Annotated[int, msgspec.Meta(ge=0, le=2**63 - 1)]
Share = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
Positive = Annotated[float, msgspec.Meta(gt=0.0)]


def refuse_unpaired(waves: Sequence[object], phases: Sequence[float]) -> None:
    """Refuse another number of phases than of waves."""
    if len(waves) != len(phases):
        raise ValueError("as many phases as waves")


class LinearDrag(msgspec.Struct, tag_field="kind", tag="linear_drag"):
    """See `outside.linear_drag`."""

    rate: float


class QuadraticDrag(msgspec.Struct, tag_field="kind", tag="quadratic_drag"):
    """See `outside.quadratic_drag`."""

    length: Positive


class Strip(msgspec.Struct, tag_field="kind", tag="strip"):
    """See `outside.strip`."""

    friction: float
    first: float
    last: float


class UnevenFriction(msgspec.Struct, tag_field="kind", tag="uneven_friction"):
    """See `outside.uneven_friction`."""

    friction: float
    waves: Annotated[list[float], msgspec.Meta(min_length=1, max_length=1000)]
    phases: Annotated[list[float], msgspec.Meta(min_length=1, max_length=1000)]

    def __post_init__(self) -> None:
        refuse_unpaired(self.waves, self.phases)


class Pattern(msgspec.Struct):
    """Waves along the bed and in time, each with its phase."""

    waves: Annotated[list[tuple[float, float]], msgspec.Meta(min_length=1, max_length=1000)]
    phases: Annotated[list[float], msgspec.Meta(min_length=1, max_length=1000)]

    def __post_init__(self) -> None:
        refuse_unpaired(self.waves, self.phases)


class SmoothError(Pattern, tag_field="kind", tag="smooth_error"):
    """See `outside.smooth_error`."""

    height: Share
    reach: Share


class Magnification(msgspec.Struct, tag_field="kind", tag="magnification"):
    """See `outside.magnification`."""

    error: Annotated[float, msgspec.Meta(gt=-1.0, le=1.0)]


class Clock(msgspec.Struct, tag_field="kind", tag="clock"):
    """See `outside.clock`."""

    error: Annotated[float, msgspec.Meta(gt=-1.0, le=1.0)]


class GrainLoss(msgspec.Struct, tag_field="kind", tag="grain_loss"):
    """See `outside.grain_loss`."""

    lost: Share


class FallenGrains(msgspec.Struct, tag_field="kind", tag="fallen_grains"):
    """See `outside.fallen_grains`."""


class Form(Pattern):
    """See `other_closure.draw_form`."""

    share: Share


class Run(msgspec.Struct):
    """One experiment of a label."""

    case: str
    forces: list[LinearDrag | QuadraticDrag | Strip | UnevenFriction]
    readings: list[SmoothError | Magnification | Clock | GrainLoss | FallenGrains]
    noise: Whole
    without: str | msgspec.UnsetType = msgspec.UNSET
    form: Form | msgspec.UnsetType = msgspec.UNSET

    def __post_init__(self) -> None:
        if (self.without is msgspec.UNSET) != (self.form is msgspec.UNSET):
            raise ValueError("`without` and `form` together")
