"""Error of the clock of the measurement: it shows t - offset at the simulated time t."""

from typing import Annotated

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import NUISANCE, Effect, Prior, Seeing


class TimeOrigin(Section):
    """Error of the clock of the measurement."""

    offset: Annotated[
        float, key("s", "simulated time at which the clock shows zero", ge=-1000, le=1000)
    ] = 0.0


def start_of_clock(section: TimeOrigin) -> float:
    """Simulated time at which the clock shows zero, s."""
    return section.offset


EFFECT = Effect(
    "time_origin",
    NUISANCE,
    TimeOrigin,
    priors={"offset": Prior("normal", 0.0, 0.01, "C", "half a frame at 50 Hz")},
    see=Seeing(clock=start_of_clock),
    seen_keys=("offset",),
)
