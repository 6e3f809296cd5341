"""Dilatancy: sheared grains expand or contract towards nu_eq(I), rub more or less, and conserve their mass.

    div u = shear_rate tan(psi),    tan(psi) = K (nu - nu_eq(I)),    nu_eq = nu_c - b min(I, 1)

The friction coefficient is mu(I) + F tan(psi), F = `friction_factor`. F = 1 is what the work of dilation takes. Dense
packings of beads computed one by one rub more: F = 2 (`runs/particle_laboratory/README.md`). Equations,
discretisation and limits stand in `fvcollapse/step/dilatancy.py`.

References
----------
Roux & Radjai (1998), in Physics of Dry Granular Media, 229; Pailha & Pouliquen (2009), J. Fluid Mech. 633, 115.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.conditions import needs_friction
from fvcollapse.effects.effect import PHYSICAL, Effect, Field, Prior

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


LOOSEST = 0.3  # the least solid fraction of grains that hold together


class Dilatancy(Section):
    """Sheared grains expand or contract towards an equilibrium packing and rub more or less; mass is conserved."""

    dilatancy_factor: Annotated[
        float, key("-", "K of tan(psi) = K (nu - nu_eq); 0 = incompressible", ge=0, le=20)
    ] = 0.0
    friction_factor: Annotated[
        float,
        key("-", "F of the friction mu(I) + F tan(psi); 1 = the work of dilation", ge=0, le=5),
    ] = 1.0
    solid_fraction_critical: Annotated[
        float, key("-", "nu_eq of slow shear, I = 0", ge=LOOSEST, le=0.74)
    ] = 0.60
    solid_fraction_slope: Annotated[
        float, key("-", "decrease of nu_eq from I = 0 to I = 1, and no further", ge=0, le=0.25)
    ] = 0.15
    solid_fraction_0: (
        Annotated[
            float,
            key(
                "-",
                "solid fraction at the start; absent = density_bulk / density_grain",
                ge=LOOSEST,
                le=0.74,
            ),
        ]
        | None
    ) = None


def without_suction_or_friction(case: "Case", section: Dilatancy) -> Iterator[tuple[str, str, str]]:
    """Grains under suction have no friction, so contracting against it would be a source of energy."""
    if section.dilatancy_factor > 0.0 and not case.numerics.unilateral:
        yield "numerics.unilateral", "false", "true (no suction) with effects.dilatancy"
    yield from needs_friction(case, "dilatancy")


EFFECT = Effect(
    "dilatancy",
    PHYSICAL,
    Dilatancy,
    priors={
        "dilatancy_factor": Prior(
            "loguniform",
            1.0,
            5.0,
            "A2",
            "4.0 in SedFoam; 4.09 of Pailha & Pouliquen (2009), order 1 of Roux & Radjai (1998) (C)",
        ),
        "friction_factor": Prior(
            "uniform",
            1.0,
            2.0,
            "A2",
            "1 is the work of dilation; 2 fits the fronts at rest of dense beads computed one by one, nu = 0.64",
        ),
        "solid_fraction_critical": Prior(
            "uniform", 0.585, 0.62, "A2", "0.60 (dry) and 0.585 (immersed) in SedFoam", "low"
        ),
        "solid_fraction_slope": Prior(
            "uniform", 0.1, 0.2, "C", "linear nu_eq(I) of dry discs and beads"
        ),
        "solid_fraction_0": Prior(
            "uniform",
            0.58,
            0.64,
            "A2",
            "0.62 (Mangeney et al. 2010), 0.59 from the bulk density of other beads",
        ),
    },
    absorbed_in=("rheology.mu_1", "rheology.mu_2", "rheology.density_bulk"),
    refuse=without_suction_or_friction,
    term="dilatancy",
    fields={
        "solid_fraction": Field("centre", "1", "volume of the grains over volume of the cell"),
        "dilation_rate": Field("centre", "1/s", "imposed rate of volume change, div u"),
    },
)
