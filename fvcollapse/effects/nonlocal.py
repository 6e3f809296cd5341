"""Nonlocal granular fluidity: grains beside a flow creep below their yield stress, grains beside rest are held.

    mu_loc(I, p) g - (A d)^2 lap g = shear_rate,    fluidity g = shear_rate / mu

Discretisation and limits stand in `fvcollapse/step/nonlocal_fluidity.py`.

References
----------
Kamrin & Koval (2012), Phys. Rev. Lett. 108, 178301; Henann & Kamrin (2014), Phys. Rev. Lett. 113, 178001.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.conditions import needs_friction
from fvcollapse.effects.effect import PHYSICAL, Effect, Field, Prior

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class Nonlocal(Section):
    """Granular fluidity: grains beside a flow creep below their yield stress, grains beside rest are held."""

    A: Annotated[
        float, key("-", "nonlocal amplitude; A grain_diameter is the length", ge=0, le=10)
    ] = 0.0


def without_friction(case: "Case", section: Nonlocal) -> Iterator[tuple[str, str, str]]:
    """The law has a friction coefficient to be made nonlocal."""
    return needs_friction(case, "nonlocal")


EFFECT = Effect(
    "nonlocal",
    PHYSICAL,
    Nonlocal,
    priors={
        "A": Prior("uniform", 0.4, 0.9, "A2", "0.5 in a code of the model; 0.48 for beads (C)")
    },
    absorbed_in=("rheology.mu_1", "rheology.I_0"),
    refuse=without_friction,
    term="nonlocal_fluidity",
    fields={"fluidity": Field("centre", "1/s", "granular fluidity, shear rate over tau/p")},
)
