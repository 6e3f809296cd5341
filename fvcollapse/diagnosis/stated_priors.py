"""Priors of the effects in a diagnosis: those of the catalogue, but for what the experiments state themselves.

A laboratory that measured the friction on its lateral walls knows it better than the catalogue does. One that measured
the angles at which its grains stop and start knows by how much they strengthen at rest.
"""

from collections.abc import Sequence
from math import cos, hypot, radians, sqrt, tan
from typing import TYPE_CHECKING

from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import Prior

if TYPE_CHECKING:
    from fvcollapse.measure.experiment import Experiment

FAR = 3.0  # standard deviations from zero at which a positive quantity may be normal
SD_LEAST = 1.0e-3  # of a friction coefficient: one that is stated without any error
GRADE = "stated"


def priors_of(effect: str, experiments: "Sequence[Experiment]" = ()) -> dict[str, Prior]:
    """{parameter: `Prior`} of an effect of the catalogue.

    What the experiments state replaces the prior of the catalogue if all of them state the same.

    Parameters
    ----------
    effect : str
    experiments : sequence of Experiment
        Those that are diagnosed together.
    """
    priors = dict(CATALOGUE[effect].priors)
    for (name, parameter), stated in STATED.items():
        found = {stated(experiment) for experiment in experiments} if name == effect else {None}
        if len(found) == 1 and None not in found:
            priors[parameter] = found.pop()
    return priors


def stated_mu_wall(experiment: "Experiment") -> Prior | None:
    """`Prior` of the friction on the lateral walls; None if it is not stated."""
    mu_wall = experiment.stated("material.mu_wall")
    if mu_wall is None:
        return None
    return around(mu_wall, experiment.standard_deviation("mu_wall", mu_wall), "material.mu_wall")


def stated_delta_mu(experiment: "Experiment") -> Prior | None:
    """`Prior` of the static friction above mu(I), tan(avalanche) - tan(repose); None if one angle is not stated."""
    names = ("avalanche_angle_deg", "repose_angle_deg")
    angles = [experiment.stated(f"material.{name}") for name in names]
    if None in angles:
        return None
    start, stop = (radians(angle) for angle in angles)
    errors = [
        radians(experiment.standard_deviation(name)) / cos(angle) ** 2
        for name, angle in zip(names, (start, stop), strict=True)
    ]
    source = "tan(material.avalanche_angle_deg) - tan(material.repose_angle_deg)"
    return around(tan(start) - tan(stop), hypot(*errors), source)


def around(mean: float, sd: float, source: str) -> Prior | None:
    """`Prior` of a positive number of a mean and a standard deviation: near zero uniform, cut at zero.

    None where all of it would be cut.
    """
    sd = max(sd, SD_LEAST)
    if mean > FAR * sd:
        return Prior("normal", mean, sd, GRADE, source)
    high = mean + sqrt(3.0) * sd
    return (
        Prior("uniform", max(0.0, mean - sqrt(3.0) * sd), high, GRADE, source)
        if high > 0.0
        else None
    )


# (effect, parameter): function (experiment) -> Prior, or None where the experiment does not state it
STATED = {
    ("lateral_friction", "mu_wall"): stated_mu_wall,
    ("friction_hysteresis", "delta_mu"): stated_delta_mu,
}
