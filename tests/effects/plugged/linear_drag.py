"""A drag -c u on the grains, as that of a surrounding fluid: the throw-away term of `test_plug_in.py`."""

from typing import Annotated

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior


class LinearDrag(Section):
    """A drag in proportion to the velocity."""

    c: Annotated[float, key("1/s", "rate at which the velocity fades", ge=0, le=100)] = 0.0


EFFECT = Effect(
    "linear_drag",
    PHYSICAL,
    LinearDrag,
    priors={"c": Prior("uniform", 0.0, 5.0, "C", "a guess")},
    absorbed_in=("rheology.mu_1",),
    term="linear_drag",
)
