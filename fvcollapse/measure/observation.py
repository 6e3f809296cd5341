"""What is seen of a collapse: effects that change the observation and not the flow.

`observe` applies their operators (`Effect.see`) to what it reads off a result, in the order of the catalogue:
first where the grains are seen, then which front is measured, then what the clock shows.

None of them changes the flow, so that one run serves all their strengths: that of `flow_case`,
given to `observe` together with the case itself.
"""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.effects.catalogue import effects_on
from fvcollapse.effects.effect import with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def flow_case(case: "Case") -> "Case":
    """The case whose run serves `case` as well: without what only the observation knows of.

    An effect that leaves the flow as it is, whatever its keys, is switched off; of the others the keys that only
    the observation knows of have their defaults. Without any of them it is the case itself.
    """
    changed = case
    for effect, section in effects_on(case):
        if not effect.seen_keys:
            continue
        default = effect.section()
        flowing = {
            name: getattr(default if name in effect.seen_keys else section, name)
            for name in section.__struct_fields__
        }
        section = None if effect.only_seen else effect.section(**flowing)
        changed = with_section(changed, effect.name, section)
    return case if changed == case else changed


def operators(case: "Case", part: str) -> Iterator[tuple[Callable, Any]]:
    """The operators of one part of the observation (`Seeing`) of the effects that are on, with their sections."""
    for effect, section in effects_on(case):
        operator = getattr(effect.see, part, None)
        if operator is not None:
            yield operator, section


def seen_place(x: np.ndarray, case: "Case") -> np.ndarray:
    """Abscissae at which the grains at `x` are seen, m."""
    for operator, section in operators(case, "place"):
        x = operator(section, case.resolved, x)
    return x


def seen_front(time: np.ndarray, front: np.ndarray, case: "Case") -> np.ndarray:
    """Front that is measured, (n,), m, of a front at `front` (n,) at the times `time` (n,), s."""
    front = seen_place(front, case)
    for operator, section in operators(case, "front"):
        front = operator(section, case.resolved, time, front)
    return front


def seen_time_origin(case: "Case") -> float:
    """Simulated time at which the clock of the measurement shows zero, s."""
    return sum((operator(section) for operator, section in operators(case, "clock")), 0.0)
