"""Level or law of the viscosity: eta_I scaled by `factor`, or a constant `eta_constant` in its place.

    eta_I = (mu_2 - mu_1) p / (I_0 sqrt(p)/k + shear rate)

is scaled by scaling mu_2 - mu_1; a constant-viscosity law, by scaling rheology.viscosity. With a constant eta_c in
its place mu(I) becomes the Drucker-Prager law.

Limits: the partially regularised law has no viscous part to scale, and is refused.

References
----------
Martin et al. (2017), equation 8.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class Viscosity(Section):
    """Level or law of the viscosity: eta_I scaled, or a constant instead of it."""

    factor: Annotated[
        float, key("-", "factor on eta_I, or on rheology.viscosity", ge=0, le=1000)
    ] = 1.0
    eta_constant: (
        Annotated[
            float, key("Pa s", "constant viscosity in place of eta_I; absent = none", ge=0, le=1e6)
        ]
        | None
    ) = None


def change_law(case: "Case", section: Viscosity) -> "Case":
    """Scale eta_I, or put a constant viscosity in its place."""
    law = case.rheology
    if section.eta_constant is not None:
        kind = "drucker_prager" if law.law == "mu_I" else law.law
        law = replace(law, law=kind, viscosity=section.eta_constant)
    elif law.law == "mu_I":
        law = replace(law, mu_2=law.mu_2 + (section.factor - 1.0) * (law.mu_2 - law.mu_1))
    else:
        law = replace(law, viscosity=section.factor * law.viscosity)
    return with_section(replace(case, rheology=law), "viscosity", None)


def without_viscous_part(case: "Case", section: Viscosity) -> Iterator[tuple[str, str, str]]:
    """The effect has a viscous part to act on, and one way to act."""
    if case.rheology.law == "mu_I_regularised":
        limit = "absent with rheology.law = mu_I_regularised, whose viscosity is no part of its own"
        yield "effects.viscosity", "a table", limit
    if section.eta_constant is not None and section.factor != 1.0:
        yield "effects.viscosity.factor", f"{section.factor:g}", "absent beside eta_constant"


EFFECT = Effect(
    "viscosity",
    PHYSICAL,
    Viscosity,
    priors={
        "factor": Prior(
            "loguniform",
            0.5,
            5.0,
            "comp",
            "eta_I goes as (mu_2 - mu_1)/I_0 at low I; 0.20-0.30 and 0.069-0.40 in the literature",
        ),
        "eta_constant": Prior(
            "loguniform", 0.1, 2.0, "A", "range of eta_I and trials of Martin et al. (2017)"
        ),
    },
    absorbed_in=("rheology.mu_2", "rheology.I_0"),
    variants=({"eta_constant": None}, {"factor": None}),
    refuse=without_viscous_part,
    change=change_law,
    zero=({}, {"factor": 1.0}),
)
