"""A gate that is slow, late, or rubs against the grains.

    velocity of the gate  speed (1 - exp(-(t - delay)/time_constant)),  t > delay;
    friction on the grains behind it  mu_gate times the normal stress, against their velocity relative to it

`speed` and `time_constant` take the place of the keys of `[gate]`; delay and friction are terms of the step
(`fvcollapse/step/gate.py`).

Limits: the gate stays a plane normal to the bed; its friction has no memory.
"""

from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class Gate(Section):
    """A gate that is slow, late, or rubs against the grains."""

    speed: (
        Annotated[
            float,
            key(
                "m/s",
                "lifting speed instead of gate.speed; absent = that one",
                ge=0,
                inf=True,
                most=1e6,
            ),
        ]
        | None
    ) = None
    time_constant: (
        Annotated[
            float,
            key("s", "tau of its law instead of gate.time_constant; absent = that", ge=0, le=1000),
        ]
        | None
    ) = None
    mu_gate: Annotated[float, key("-", "friction of the grains on the gate", ge=0, le=10)] = 0.0
    delay: Annotated[float, key("s", "time from t = 0 to the start of the gate", ge=0, le=1000)] = (
        0.0
    )


def change_speed(case: "Case", section: Gate) -> "Case":
    """Put the speed law into the keys of the gate; delay and friction remain for the solver."""
    if section.speed is section.time_constant is None:
        return case
    speed = case.gate.speed if section.speed is None else section.speed
    tau = case.gate.time_constant if section.time_constant is None else section.time_constant
    case = replace(case, gate=replace(case.gate, speed=speed, time_constant=tau))
    return with_section(case, "gate", replace(section, speed=None, time_constant=None))


EFFECT = Effect(
    "gate",
    PHYSICAL,
    Gate,
    priors={
        "speed": Prior("loguniform", 0.5, 2.5, "A", "0.7 and 0.8 m/s; 2.3 m/s in the paper", "low"),
        "time_constant": Prior("uniform", 0.0, 0.15, "A", "0.06 s (gravel), 0.13 s (beads)"),
        "mu_gate": Prior("uniform", 0.0, 0.3, "A", "0.18, 0.23; none in the paper's model"),
        "delay": Prior("uniform", 0.0, 0.04, "C", "two frames at 50 Hz between trigger and motion"),
    },
    absorbed_in=("gate.speed", "gate.time_constant"),
    change=change_speed,
    zero=({}, {"speed": 2.3, "time_constant": 0.0}),
)
