"""Which cause is hidden in a case, and how strong it is: drawn, not run."""

from typing import NamedTuple

import numpy as np

from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE

QUANTILES = (0.02, 0.98)  # of the priors, from which causes are drawn


class Style(NamedTuple):
    """How the truths of a suite are made; a training suite and a blind suite differ in it.

    Attributes
    ----------
    cells : (float, float)
        Range of the number of cells in the height of the column.
    stretch : (float, float)
        Range of the cell size normal to the bed over that along it.
    step : (float, float)
        Range of the longest time step over its default.
    shear_rate_min : (float, float)
        Range of the regularisation [1/s].
    scheme : str
        Of the lateral friction, where it is a sink.
    first_closure : int
        Every second closure of an effect, from this one on; an effect with one keeps it.
    unknowns : tuple of str
        Kinds of causes outside the catalogue.
    """

    cells: tuple
    stretch: tuple
    step: tuple
    shear_rate_min: tuple
    scheme: str
    first_closure: int
    unknowns: tuple


TRAINING = Style(
    cells=(10.0, 11.5),
    stretch=(0.85, 1.0),
    step=(1.0, 1.6),
    shear_rate_min=(5e-4, 2e-3),
    scheme="implicit",
    first_closure=0,
    unknowns=("linear_drag", "rough_strip", "sloping_surface", "clock", "grain_loss"),
)
BLIND = Style(
    cells=(17.0, 20.0),
    stretch=(1.0, 1.15),
    step=(0.6, 1.0),
    shear_rate_min=(1e-4, 5e-4),
    scheme="split",
    first_closure=1,
    unknowns=(
        "quadratic_drag",
        "slippery_strip",
        "slumped_column",
        "magnification",
        "short_channel",
    ),
)


def known_effects():
    """Names of the effects that can be a cause."""
    return tuple(name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE)


def draw_classes(count, rng):
    """Classes of a blind suite; their frequencies are drawn as well and not published.

    About three in ten are none, two in ten unknown, one in twenty a pair; the others are single effects
    of unequal frequency.
    """
    none = round(count * rng.uniform(0.28, 0.34))
    unknown = round(count * rng.uniform(0.17, 0.22))
    pairs = round(count * rng.uniform(0.04, 0.08))
    single = max(count - none - unknown - pairs, 0)
    effects = list(known_effects())
    shares = rng.dirichlet(np.full(len(effects), 8.0))
    classes = [NONE] * none + [UNKNOWN] * unknown
    classes += [draw_pair(rng) for _ in range(pairs)]
    classes += rng.choice(effects, single, p=shares).tolist()
    return rng.permutation(classes[:count]).tolist()


def draw_pair(rng):
    """Name of two effects together."""
    return "+".join(sorted(rng.choice(known_effects(), 2, replace=False).tolist()))


def draw_effect(name, style, rng):
    """{"closure": index, "section": keys of `[effects.<name>]`, "quantiles": {parameter: u}}."""
    effect = CATALOGUE[name]
    closures = range(len(effect.variants))[style.first_closure :: 2] or (0,)
    closure = int(rng.choice(closures))
    variant = effect.variants[closure]
    section = {key: value for key, value in variant.items() if value is not None}
    quantiles = {}
    for parameter, prior in effect.priors.items():
        if variant.get(parameter, "") is None:
            continue
        quantiles[parameter] = float(rng.uniform(*QUANTILES))
        section[parameter] = float(prior.distribution().ppf(quantiles[parameter]))
    if name == "lateral_friction" and section.get("closure", "sink") != "friction_increase":
        section["scheme"] = style.scheme
    return {"closure": closure, "section": section, "quantiles": quantiles}
