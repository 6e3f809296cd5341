"""The catalogue of effects: one name a line, in the order in which the effects act.

An effect that is no more than a change of a key the user believes is applied by `with_effects`; the
others are terms of the solver (`fvcollapse/step`) or act on what is observed
(`fvcollapse/measure/observation.py`). Which is which stands in the file of the effect.
"""

from collections.abc import Iterator
from importlib import import_module
from typing import TYPE_CHECKING, Any

from fvcollapse.effects.effect import Effect, section_of

if TYPE_CHECKING:
    from fvcollapse.case.case import Case

NAMES = (
    "lateral_friction",
    "gate",
    "viscosity",
    "bed_friction",
    "dilatancy",
    "friction_hysteresis",
    "nonlocal",
    "thin_layer",
    "cohesion",
    "erodible_bed",
    "transverse_profile",
    "front_saltation",
    "tilt",
    "column_size",
    "time_origin",
)
CATALOGUE: dict[str, Effect] = {
    name: import_module(f"fvcollapse.effects.{name}").EFFECT for name in NAMES
}


def effects_on(case: "Case") -> list[tuple[Effect, Any]]:
    """The effects of a case that are on: (Effect, its section), in the order of the catalogue."""
    pairs = ((effect, section_of(case, name)) for name, effect in CATALOGUE.items())
    return [(effect, section) for effect, section in pairs if section is not None]


def with_effects(case: "Case") -> "Case":
    """The case that the solver runs: effects that change a key are put into that key.

    They leave `[effects]` with it, so that a second call changes nothing; without such an effect the
    case itself is returned.
    """
    for effect, section in effects_on(case):
        if effect.change is not None:
            case = effect.change(case, section)
    return case


def refusals(case: "Case") -> Iterator[tuple[str, str, str]]:
    """Triples (key, what was found, what is allowed) of what the effects of a case exclude."""
    for effect, section in effects_on(case):
        if effect.refuse is not None:
            yield from effect.refuse(case, section)
