"""Values that an experiment leaves open although it describes its own grains: what follows from those it states.

Grains with another friction at rest than those of the default material are other grains: their mu(I) is not that of
the default with one number exchanged. What is not stated of mu(I) keeps its distance to mu_1, and is uncertain.
"""

from typing import Any, NamedTuple

from fvcollapse.case.case import Case
from fvcollapse.measure.uncertainty import DEFAULTS

RISE_SD = 0.08  # of mu_2 - mu_1: nine published sets of spheres have 0.05 about 0.27; bars and sand are none


class Assumed(NamedTuple):
    """A value in the unit of its key, its standard deviation, and the reason for both."""

    value: float
    sd: float
    reason: str


def assumed_of_grains(material: Any, base: Case | None = None) -> dict[str, Assumed]:
    """{key of `experiment.toml`: `Assumed`} of the mu(I) of an experiment that states mu_1 and not all of the rest.

    mu_2 follows mu_1 unless the case that is believed has another one than the default. The rise mu_2 - mu_1 is that
    of the default material, 0.25: Jop, Forterre & Pouliquen (2006), Nature 441, 727, have 0.26, and published sets
    of spheres lie between 0.21 and 0.35. I_0 stays as it is, with its wide standard deviation.

    Parameters
    ----------
    material : Material
    base : Case, optional
        The model as it is believed.
    """
    if material.mu_1 is None:
        return {}
    default, law = Case().rheology, (base or Case()).rheology
    found, rise = {}, default.mu_2 - default.mu_1
    if material.mu_2 is None:
        own = law.mu_2 != default.mu_2
        value = law.mu_2 if own else round(material.mu_1 + rise, 12)
        reason = "of the case file" if own else f"the stated mu_1 + {rise:.2g}, as of glass beads"
        found["material.mu_2"] = Assumed(value, RISE_SD, reason)
    if material.I_0 is None:
        reason = "of the case file" if law.I_0 != default.I_0 else "as of glass beads"
        found["material.I_0"] = Assumed(law.I_0, DEFAULTS["I_0"].value, reason)
    return found
