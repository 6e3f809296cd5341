"""Thin layers: grains a few diameters above a rough bed need more friction than a thick layer to flow.

A uniform layer of thickness h stops below the angle at which

    tan(angle) = mu_stop(h) = mu_1 + (mu_2 - mu_1)/(1 + h/L)        closure "thickness"
               = mu_1 + (pi A d/(2 h))^2                            closure "nonlocal"

L = `length` grain diameters. The closure "thickness" puts mu_stop(h) under the friction of the grains as its least
value, the closure "nonlocal" is nonlocal granular fluidity with no fluidity on the bed, from which its mu_stop(h)
follows. Its A is that for which both closures agree at h = L: A = (2/pi) sqrt((mu_2 - mu_1)/2) `length`; beside
the effect `nonlocal` it is the A of that effect. A bed on which grains slide (finite mu_bed) has mu_stop(h) - mu_1 more
friction in either closure; one without friction stays so.

Discretisation and limits stand in `fvcollapse/step/thin_layer.py`, `nonlocal_fluidity.py` and
`fluidity_relaxation.py` beside it.

References
----------
Pouliquen (1999), Phys. Fluids 11, 542; Pouliquen & Forterre (2002), J. Fluid Mech. 453, 133; Jop, Forterre &
Pouliquen (2005), J. Fluid Mech. 541, 167, for L = 1.65 d of beads; Kamrin & Henann (2015), Soft Matter 11, 179;
Liu & Henann (2018), Soft Matter 14, 5294.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.conditions import needs_friction
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class ThinLayer(Section):
    """Layers a few grains thick on a rough bed need more friction to flow."""

    length: Annotated[
        float,
        key("-", "L in grain diameters: at h = L half of mu_2 - mu_1 is added", gt=0, le=100),
    ] = 1.65
    closure: Annotated[
        Literal["thickness", "nonlocal"],
        key("-", "friction that rises as the layer thins, or no granular fluidity on the bed"),
    ] = "thickness"


def without_friction(case: "Case", section: ThinLayer) -> Iterator[tuple[str, str, str]]:
    """The law has a friction coefficient, which rises as a layer thins."""
    return needs_friction(case, "thin_layer")


EFFECT = Effect(
    "thin_layer",
    PHYSICAL,
    ThinLayer,
    priors={
        "length": Prior(
            "loguniform",
            0.8,
            4.0,
            "A2",
            "1.65 of glass beads in chutes (mu_1 = 0.382, mu_2 = 0.643); 2.3 of beads computed one by one, whose "
            "layers of 18 diameters stop at 26 deg; a factor of 2 below and 1.7 above is C",
        ),
    },
    absorbed_in=("rheology.mu_1", "rheology.mu_2", "boundary.mu_bed"),
    variants=({"closure": "thickness"}, {"closure": "nonlocal"}),
    refuse=without_friction,
    zero=({"length": 1e-30},),
)
