"""Friction hysteresis: grains that have settled need more than mu(I) to start; once they flow mu(I) holds.

    friction coefficient  mu(I) + delta_mu L,  L = settled share of the contacts, 1 at rest and 0 in flow

Evolution of L, discretisation and limits stand in `fvcollapse/step/friction_hysteresis.py`.

References
----------
Pouliquen & Forterre (2002), J. Fluid Mech. 453, 133; Edwards, Russell, Johnson & Gray (2019), J. Fluid Mech.
875, 1058.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.conditions import needs_friction
from fvcollapse.effects.effect import PHYSICAL, Effect, Field, Prior

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class FrictionHysteresis(Section):
    """Grains that have settled need more than mu(I) to start; once they flow mu(I) holds."""

    delta_mu: Annotated[float, key("-", "static friction above mu(I)", ge=0, le=1)] = 0.0
    I_start: Annotated[
        float, key("-", "inertial number above which contacts break", gt=0, le=1)
    ] = 0.01
    strain: Annotated[
        float, key("-", "shear strain that breaks them, by a factor 1/e", gt=0, le=10)
    ] = 0.05


def without_friction(case: "Case", section: FrictionHysteresis) -> Iterator[tuple[str, str, str]]:
    """The law has a friction coefficient for the contacts to raise."""
    return needs_friction(case, "friction_hysteresis")


EFFECT = Effect(
    "friction_hysteresis",
    PHYSICAL,
    FrictionHysteresis,
    priors={
        "delta_mu": Prior(
            "uniform",
            0.01,
            0.06,
            "A2",
            "start angle 0.5-2.5 deg above the stop angle; 5.4 deg (Lajeunesse et al. 2005) and the "
            "0.05-0.20 tried in sand6 lie outside",
        ),
        "I_start": Prior("loguniform", 0.005, 0.01, "A", "values tried in sand6"),
        "strain": Prior("loguniform", 0.01, 0.1, "C", "some per cent of strain to the peak"),
    },
    absorbed_in=("rheology.mu_1",),
    refuse=without_friction,
    term="friction_hysteresis",
    fields={
        "settled_share": Field(
            "centre", "1", "share of the contacts that have settled: 1 at rest, 0 in flow"
        ),
    },
)
