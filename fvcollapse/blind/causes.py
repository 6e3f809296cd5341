"""Which cause is hidden in a case, and how strong it is: drawn, not run."""

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from fvcollapse.blind.other_closure import FEW, MANY
from fvcollapse.blind.plain_values import Drawn
from fvcollapse.blind.set_ups import BLIND_DESIGNS, TRAINING_DESIGNS
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
    worlds : tuple of str
        Kinds of physics of the worlds; see `worlds.KINDS`.
    error_lengths : (float, float)
        Length [m] and time [s] over which the error of the believed model varies.
    designs : tuple of tuples of str
        Set-ups of the experiments of a case.
    form_waves : int
        Waves in the response to effects that act by another closure; see `other_closure`.
    slight_share : float
        Share of worlds whose own physics is slight.
    other_closures : float
        Share of the cases with effects in which these act by another closure.
    """

    cells: tuple[float, float]
    stretch: tuple[float, float]
    step: tuple[float, float]
    shear_rate_min: tuple[float, float]
    scheme: str
    first_closure: int
    unknowns: tuple[str, ...]
    worlds: tuple[str, ...]
    error_lengths: tuple[float, float]
    designs: tuple[tuple[str, ...], ...]
    form_waves: int
    slight_share: float = 0.5
    other_closures: float = 0.4


TRAINING = Style(
    cells=(10.0, 11.5),
    stretch=(0.85, 1.0),
    step=(1.0, 1.6),
    shear_rate_min=(5e-4, 2e-3),
    scheme="implicit",
    first_closure=0,
    unknowns=("linear_drag", "rough_strip", "sloping_surface", "clock", "grain_loss"),
    worlds=("thin_layers", "dilatant_grains", "slippery_bed", "uneven_bed"),
    error_lengths=(0.15, 0.30),
    designs=TRAINING_DESIGNS,
    form_waves=MANY,
)
BLIND = Style(
    cells=(14.5, 17.0),
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
    worlds=("thin_layers_without_fluidity", "hysteretic_grains", "rubbing_walls", "loose_bed"),
    error_lengths=(0.08, 0.20),
    designs=BLIND_DESIGNS,
    form_waves=FEW,
)


def known_effects() -> tuple[str, ...]:
    """Names of the effects that can be a cause."""
    return tuple(name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE)


def draw_classes(count: int, rng: np.random.Generator) -> list[str]:
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


def dealt(causes: Sequence[str], hidden: Sequence[Collection[str]]) -> list[str]:
    """Causes dealt to the worlds in turn, none of them an effect that its world has already.

    Parameters
    ----------
    causes : sequence of str
    hidden : sequence of collections of str
        Effects of the world of each case.

    Returns
    -------
    list of str
        The same causes in another order; one that no world without it is left for goes to the first that has room
        for it by an exchange.
    """
    causes = list(causes)
    for number, effects in enumerate(hidden):
        others = (*range(number, len(causes)), *range(number))
        for other in others:
            fits = not set(causes[other].split("+")) & set(effects)
            if fits and (
                other >= number or not set(causes[number].split("+")) & set(hidden[other])
            ):
                causes[number], causes[other] = causes[other], causes[number]
                break
    return causes


def draw_pair(rng: np.random.Generator) -> str:
    """Name of two effects together."""
    return "+".join(sorted(rng.choice(known_effects(), 2, replace=False).tolist()))


def draw_effect(name: str, style: Style, rng: np.random.Generator) -> Drawn:
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
