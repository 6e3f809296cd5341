"""A front that is read too far ahead, by a constant: the throw-away effect on the observation of `test_plug_in.py`."""

from typing import Annotated

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import OBSERVATION, Effect, Prior, Seeing


class FarFront(Section):
    """A front that is read too far ahead."""

    ahead: Annotated[float, key("m", "how far ahead the front is read", ge=-1, le=1)] = 0.0


def seen_ahead(section, case, time, front):
    """Front (n,) that is read, m."""
    return front + section.ahead


EFFECT = Effect(
    "far_front",
    OBSERVATION,
    FarFront,
    priors={"ahead": Prior("normal", 0.0, 0.01, "C", "a guess")},
    see=Seeing(front=seen_ahead),
    seen_keys=("ahead",),
)
