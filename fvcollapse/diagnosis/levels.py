"""Levels of the effects: the quantiles of their priors at which they are run, closure by closure."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fvcollapse.diagnosis.baseline import refined
from fvcollapse.diagnosis.grid_correction import reference_level
from fvcollapse.diagnosis.scatter import labels, realisations
from fvcollapse.diagnosis.stated_priors import priors_of
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE
from fvcollapse.errors import CaseError, InputError

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.runner import Wanted
    from fvcollapse.effects.effect import Prior
    from fvcollapse.measure.experiment import Experiment

LEVELS_1D = (0.05, 0.35, 0.65, 0.95)
KEPT = 16384  # cases
LEVELS_RANGE = (0.06, 0.94)  # of the quantiles in more dimensions


class Closure(NamedTuple):
    """One closure of an effect: its parameters, the other keys of its section, and what is known of the parameters.

    `priors` {parameter: Prior} are those of the diagnosis, see `stated_priors`.
    """

    effect: str
    parameters: tuple[str, ...]
    keys: dict[str, Any]
    priors: "dict[str, Prior]"

    def values(self, u: np.ndarray) -> dict[str, float]:
        """{parameter: value} at the quantiles u (d,)."""
        pairs = zip(self.parameters, np.atleast_1d(u), strict=True)
        return {name: float(self.priors[name].distribution().ppf(share)) for name, share in pairs}

    def section(self, u: np.ndarray) -> dict[str, Any]:
        """The keys of `[effects.<name>]` at the quantiles u."""
        return self.keys | self.values(u)

    def levels(self) -> np.ndarray:
        """The quantiles (m, d) at which the effect is run."""
        return design(len(self.parameters))


def closures_of(name: str, experiments: "Sequence[Experiment]" = ()) -> tuple[Closure, ...]:
    """The closures of an effect of the catalogue, with what the experiments that are diagnosed state of it."""
    effect, priors = CATALOGUE[name], priors_of(name, experiments)
    return tuple(
        Closure(
            name,
            tuple(key for key in effect.priors if variant.get(key, "") is not None),
            {key: value for key, value in variant.items() if value is not None},
            priors,
        )
        for variant in effect.variants
    )


def design(dimension: int) -> np.ndarray:
    """Points (m, d) that fill the unit cube: four levels, or an additive recurrence (Roberts 2018)."""
    if dimension == 1:
        return np.array(LEVELS_1D)[:, None]
    count = 2 * dimension + 3
    root = 2.0  # of root^(d + 1) = root + 1, the golden ratio for d = 1
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (dimension + 1.0))
    steps = root ** -np.arange(1.0, dimension + 1.0)
    points = (0.5 + np.outer(np.arange(count), steps)) % 1.0
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0)
    low, high = LEVELS_RANGE
    return low + (high - low) * points


def applicable_effects(
    cases: "Mapping[str, Case]", names: Sequence[str] | None = None
) -> tuple[list[str], dict[str, str]]:
    """(names of the effects to compare, {name: why not} of the others).

    Parameters
    ----------
    cases : dict
        Of the experiments that are diagnosed.
    names : sequence of str, optional
        Only these.

    Raises
    ------
    InputError
        A name that is no effect of the catalogue.
    """
    known = [name for name, effect in CATALOGUE.items() if effect.kind != NUISANCE]
    for name in names or ():
        if name not in known:
            raise InputError("command line", "--effects", repr(name), ", ".join(known))
    chosen, left_out = [], {}
    for name in known:
        if names and name not in names:
            continue
        if any(getattr(case.effects, name) is not None for case in cases.values()):
            left_out[name] = "the baseline has it already"
        elif not any(acts_in(name, case) for case in cases.values()):
            left_out[name] = "no experiment states a channel width"
        else:
            chosen.append(name)
    return chosen, left_out


def acts_in(name: str, case: "Case") -> bool:
    """Whether an effect can act in the set-up of a case."""
    return not CATALOGUE[name].needs_walls or case.geometry.channel_width < inf


def effect_runs(
    closures: Mapping[str, Sequence[Closure]],
    experiments: "Sequence[Experiment]",
    cases: "Mapping[str, Case]",
) -> "tuple[Wanted, dict[str, str]]":
    """Runs of all levels of the effects, and why the others cannot be.

    Returns
    -------
    (dict, dict)
        {label: (experiment, case)}, and {effect: reason} of those that a case cannot have.
    """
    wanted, refused = {}, {}  # type: ignore[var-annotated]
    for name, variants in closures.items():
        levels: Wanted = {}
        try:
            for experiment in experiments:
                if acts_in(name, cases[experiment.name]):
                    levels |= level_cases(variants, experiment, cases[experiment.name])
        except CaseError as error:
            refused[name] = f"{error.key} cannot be {error.found} in this case"
            continue
        wanted |= levels
    return wanted, refused


@lru_cache(maxsize=KEPT)
def with_effect(case: "Case", effect: str, keys: tuple[tuple[str, Any], ...]) -> "Case":
    """The case with an effect of these `keys` (pairs); kept, for many diagnoses have the same set-ups."""
    return case.replace(**{f"effects.{effect}": dict(keys)})


def level_cases(closures: Sequence[Closure], experiment: "Experiment", case: "Case") -> "Wanted":
    """{label: (experiment, case)} of an effect at all levels of its closures, and at one on the finer grid."""
    found: Wanted = {}
    for number, closure in enumerate(closures):
        key = closure.effect, number
        levels = [
            with_effect(case, closure.effect, tuple(closure.section(u).items()))
            for u in closure.levels()
        ]
        fine = refined(levels[reference_level(closure.levels())])
        for level, each in (*enumerate(levels), ("fine", fine)):
            names = labels(closure.effect, level)  # type: ignore[arg-type]
            for number, one in zip(names, realisations(closure.effect, each), strict=True):  # type: ignore[assignment]
                found[key, number, experiment.name] = (experiment, one)
    return found
