"""Cohesion between the grains: they hold each other with a pressure p_c, and pack more loosely.

    tau = mu(I) (p + p_c) + kappa_0,  I of p + p_c,  p >= -p_c;    nu_eq(I) less by `solid_fraction_loss`

`adhesion` is p_c. It strengthens the grains by mu(I) p_c, and they bear tension down to -p_c. At the free surface
p = 0, so the grains there rub with p_c. Walls hold the grains as these do each other. Equations and discretisation
stand in `fvcollapse/step/adhesion.py`.

Adhesive grains flow, and come to rest, more loosely packed. `solid_fraction_loss` is what nu_eq loses: sheared grains
expand towards it as those of `dilatancy` do, and rub more until they are there. Beside `dilatancy` it is taken from the
critical solid fraction of that effect. Without, nu_eq is the solid fraction of density_bulk less the loss at any I, and
K is `DILATANCY_FACTOR`.

`kappa_0` is a yield stress alone, mu_1 p + kappa_0: no cell pulls and the walls stay cohesionless.

Limits: a law without a yield stress is refused. So is a loss that leaves nu_eq below `dilatancy.LOOSEST`. p_c and the
loss need a law with friction and no suction (`numerics.unilateral = true`); p_c needs walls that act in the solve. A
bond is ductile: a cell pulls with p_c as long as it opens. The loss does not depend on p_c/p.

References
----------
Rumpf (1970), Chem. Ing. Tech. 42, 538: p_c = nu Z F/(pi d2), with the pull-off force F of Z contacts a grain;
Rognon, Roux, Naaim & Chevoir (2008), J. Fluid Mech. 596, 21; Berger, Azema, Douce & Radjai (2015), EPL 112, 64004.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.conditions import needs_friction
from fvcollapse.effects.dilatancy import LOOSEST, Dilatancy
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case

DILATANCY_FACTOR = 4.0  # K where no effect `dilatancy` says it, its value in SedFoam


class Cohesion(Section):
    """Grains hold each other with a pressure, bear tension, and pack more loosely; or a yield stress alone."""

    kappa_0: Annotated[
        float, key("Pa", "cohesion added to rheology.cohesion in the yield stress", ge=0, le=1e5)
    ] = 0.0
    adhesion: Annotated[
        float, key("Pa", "p_c of mu(I) (p + p_c); tension down to -p_c", ge=0, le=1e5)
    ] = 0.0
    solid_fraction_loss: Annotated[
        float, key("-", "what nu_eq of sheared grains loses", ge=0, le=0.2)
    ] = 0.0


def put_into_keys(case: "Case", section: Cohesion) -> "Case":
    """Add kappa_0 to rheology.cohesion, take the loss from nu_eq of `dilatancy`; p_c stays in the section."""
    if section.kappa_0 > 0.0:
        law = replace(case.rheology, cohesion=case.rheology.cohesion + section.kappa_0)
        case = replace(case, rheology=law)
    if section.solid_fraction_loss > 0.0:
        case = with_section(case, "dilatancy", looser(case, section.solid_fraction_loss))
    left = Cohesion(adhesion=section.adhesion) if section.adhesion > 0.0 else None
    return with_section(case, "cohesion", left)


def looser(case: "Case", loss: float) -> Dilatancy:
    """The section `dilatancy` of a case, its nu_eq less by `loss`."""
    section = case.effects.dilatancy
    if section is None or section.dilatancy_factor == 0.0:
        bulk = case.rheology.density_bulk / case.rheology.density_grain
        start = None if section is None else section.solid_fraction_0
        section = Dilatancy(
            dilatancy_factor=DILATANCY_FACTOR,
            solid_fraction_critical=bulk,
            solid_fraction_slope=0.0,
            solid_fraction_0=start,
        )
    return replace(section, solid_fraction_critical=section.solid_fraction_critical - loss)


def refusals(case: "Case", section: Cohesion) -> Iterator[tuple[str, str, str]]:
    """What a case with cohesion may not be; see its two parts."""
    yield from without_yield_stress(case, section)
    yield from too_loose(case, section)


def too_loose(case: "Case", section: Cohesion) -> Iterator[tuple[str, str, str]]:
    """Loosened grains keep a nu_eq of `LOOSEST` at least."""
    loss = section.solid_fraction_loss
    critical = looser(case, loss).solid_fraction_critical
    if loss > 0.0 and critical < LOOSEST:
        limit = (
            f"<= {max(critical + loss - LOOSEST, 0.0):.3g}, so that nu_eq stays {LOOSEST} or more"
        )
        yield "effects.cohesion.solid_fraction_loss", f"{loss:g}", limit


def without_yield_stress(case: "Case", section: Cohesion) -> Iterator[tuple[str, str, str]]:
    """The law has a yield stress to which the cohesion adds; adhesion needs friction and the unilateral pressure."""
    if case.rheology.law == "newtonian":
        limit = 'absent with rheology.law = "newtonian", which has no yield stress'
        yield "effects.cohesion", "a table", limit
    if section.adhesion == section.solid_fraction_loss == 0.0:
        return
    yield from needs_friction(case, "cohesion (adhesion, solid_fraction_loss)")
    if not case.numerics.unilateral:
        limit = "true (tension ends at -p_c) with effects.cohesion.adhesion"
        yield "numerics.unilateral", "false", limit
    walls = case.effects.lateral_friction
    if section.adhesion > 0.0 and walls is not None and walls.scheme == "split":
        limit = '"implicit" with effects.cohesion.adhesion'
        yield "effects.lateral_friction.scheme", '"split"', limit


EFFECT = Effect(
    "cohesion",
    PHYSICAL,
    Cohesion,
    priors={
        "adhesion": Prior(
            "loguniform",
            3.0,
            600.0,
            "C",
            "6 nu F/(pi d2): F from 1 % of the capillary force pi gamma d of 0.7 mm beads (4 Pa) to five weights of "
            "7 mm beads (500 Pa)",
        ),
        "solid_fraction_loss": Prior(
            "uniform",
            0.0,
            0.06,
            "A2",
            "0.044 lost by adhesive beads computed one by one, F = 5 weights; none by weakly adhesive ones; a margin "
            "of a third is C",
        ),
    },
    absorbed_in=("rheology.mu_1",),
    refuse=refusals,
    change=put_into_keys,
)
