"""Cohesion between the grains: yield stress mu_1 p + kappa_0.

The walls stay cohesionless, and no cell pulls: the pressure remains >= 0.

Limits: a law without a yield stress is refused.
"""

from typing import Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, with_section


class Cohesion(Section):
    """Cohesion between the grains: a yield stress without pressure.

    The walls stay cohesionless, and no cell pulls: the pressure remains >= 0.
    """

    kappa_0: Annotated[
        float, key("Pa", "cohesion added to rheology.cohesion in the yield stress", ge=0, le=1e5)
    ] = 0.0


def raise_yield_stress(case, section):
    """Add kappa_0 to rheology.cohesion."""
    law = replace(case.rheology, cohesion=case.rheology.cohesion + section.kappa_0)
    return with_section(replace(case, rheology=law), "cohesion", None)


def without_yield_stress(case, section):
    """The law has a yield stress to which the cohesion adds."""
    if case.rheology.law == "newtonian":
        limit = 'absent with rheology.law = "newtonian", which has no yield stress'
        yield "effects.cohesion", "a table", limit


EFFECT = Effect(
    "cohesion",
    PHYSICAL,
    Cohesion,
    priors={
        "kappa_0": Prior(
            "loguniform",
            1.0,
            50.0,
            "C",
            "mu_1 times the tensile strength 6 nu F/(pi d2), F = 1-30 % of the capillary force pi gamma d",
        ),
    },
    absorbed_in=("rheology.mu_1",),
    refuse=without_yield_stress,
    change=raise_yield_stress,
)
