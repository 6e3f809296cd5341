"""The runs that a diagnosis needs, and their values on the points of comparison.

For every experiment: the baseline on two grids, an ensemble with calibrated parameters and set-up drawn
from their uncertainty, and every effect of the catalogue at a few quantiles of its priors, closure by
closure. None of them depends on the measured values, only on the points: they come from the cache of runs, and an
experiment with the same set-up has most of its runs there. Ensemble and effects are runs on the coarser grid;
only their differences to the baseline there are used, on top of the baseline on the finer grid, those of
effects after the correction that one level of each on both grids shows (`grid_correction`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.baseline import refined
from fvcollapse.diagnosis.calibration import sensitivities
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.levels import acts_in, applicable_effects, closures_of, effect_runs
from fvcollapse.diagnosis.nuisances import CALIBRATED, draw, ensemble_runs, nuisances, realised
from fvcollapse.diagnosis.points import Points
from fvcollapse.diagnosis.progress import FURTHER, LIBRARY
from fvcollapse.diagnosis.reading import Reading, measured_responses

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.grid_correction import GridCorrection
    from fvcollapse.diagnosis.levels import Closure
    from fvcollapse.diagnosis.nuisances import Nuisance
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.diagnosis.runner import Runner, Wanted
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations

DRAWS = 20  # of the ensemble


@dataclass(frozen=True)
class Library:
    """What the runs say on N points of comparison; SI units.

    Attributes
    ----------
    points : Points
        Of the experiments that are diagnosed, then of the controls.
    experiments : tuple of Experiment
        Those that are diagnosed.
    cases : dict
        Experiment -> `Case` on the coarser grid.
    coarse, fine : (N,) arrays
        Baseline on the two grids.
    seen : dict
        Experiment -> `Observations` of the baseline on the finer grid.
    quantities : tuple of Nuisance
    draws : (m, n) array
        Of the quantities, in standard deviations.
    samples : (m, N) array
        The ensemble, on the coarser grid.
    closures : dict
        Effect -> tuple of `Closure`.
    responses : dict
        Effect -> list of `Response`, one for each closure.
    corrections : dict
        (effect, number of the closure) -> `GridCorrection`, where the run on the finer grid did not fail.
    left_out : dict
        Effect -> why it is not compared.
    everywhere : dict
        Effect -> (m, N) array of its changes, over the root of their number m, if it acted in the controls as well;
        empty without controls.
    """

    points: Points
    experiments: "tuple[Experiment, ...]"
    cases: "dict[str, Case]"
    coarse: np.ndarray
    fine: np.ndarray
    seen: "dict[str, Observations]"
    quantities: "tuple[Nuisance, ...]"
    draws: np.ndarray
    samples: np.ndarray
    closures: "dict[str, tuple[Closure, ...]]"
    responses: dict[str, list[Response]]
    corrections: "dict[tuple[str, int], GridCorrection]"
    left_out: dict[str, str]
    everywhere: dict[str, np.ndarray]

    @cached_property
    def sensitivities(self) -> np.ndarray:
        """Change of the simulated values per standard deviation of each quantity, (n, N)."""
        return sensitivities(self)

    @cached_property
    def set_up_covariance(self) -> np.ndarray:
        """Part of Sigma_nu that comes from the set-up and not from the material, (N, N)."""
        from_set_up = [quantity.key not in CALIBRATED for quantity in self.quantities]
        slopes = self.sensitivities[from_set_up]
        return slopes.T @ slopes


def build_library(
    question: "Question", runner: "Runner", effects: Sequence[str] | None = None, draws: int = DRAWS
) -> Library:
    """Run what is missing and read everything on the points.

    Parameters
    ----------
    question : Question
        A hidden effect acts in its experiments, not in its controls; that it acts in all of them is what `everywhere`
        is for.
    runner : Runner
    effects : sequence of str, optional
        Only these effects of the catalogue.
    draws : int
        Size of the ensemble.

    Raises
    ------
    NumericalError
        A baseline fails, or too much of the ensemble. An effect whose runs fail is left out.
    """
    cases, simulated = question.cases, question.simulated
    closures, inapplicable = chosen_closures(question, effects)
    quantities = nuisances(simulated, cases)
    z = draw(quantities, draws, question.seed)
    drawn, undrawn = ensemble_runs(simulated, cases, quantities, z)
    levels, impossible = effect_runs(closures, simulated, cases)
    wanted = baseline_runs(simulated, cases) | drawn | levels
    seen, failures = runner.observations(wanted, LIBRARY)
    reading = Reading(question.all_points, seen, failures | undrawn, cases)
    samples, complete = reading.ensemble(draws)
    possible = {name: closures[name] for name in closures if name not in impossible}
    measured = measured_responses(reading, possible)
    return Library(
        points=reading.points,
        experiments=question.experiments,
        cases=cases,
        coarse=reading.coarse,
        fine=reading.fine,
        seen={name: reading.seen["fine", None, name] for name in reading.points.names},
        quantities=quantities,
        draws=realised(quantities, z[complete]),
        samples=samples,
        closures={name: closures[name] for name in measured.responses},
        responses=only_in(reading.points, question.experiments, measured.responses),
        corrections=measured.corrections,
        left_out=inapplicable | impossible | measured.left_out,
        everywhere=changes_of(measured.responses) if question.controls else {},
    )


def only_in(
    points: Points, experiments: "Sequence[Experiment]", responses: Mapping[str, Sequence[Response]]
) -> dict[str, list[Response]]:
    """The responses of effects that act in some experiments only."""
    inside = np.isin(points.experiment, [one.name for one in experiments])
    return {
        name: [
            replace(each, differences=each.differences * inside, errors=each.errors * inside)
            for each in variants
        ]
        for name, variants in responses.items()
    }


def changes_of(responses: Mapping[str, Sequence[Response]]) -> dict[str, np.ndarray]:
    """{effect: (m, N) changes at all levels of its closures, over the root of m}."""
    every = {
        name: np.vstack([each.differences for each in variants])
        for name, variants in responses.items()
    }
    return {name: rows / np.sqrt(len(rows)) for name, rows in every.items()}


def chosen_closures(
    question: "Question", effects: Sequence[str] | None
) -> "tuple[dict[str, tuple[Closure, ...]], dict[str, str]]":
    """({effect: its `Closure`s}, {effect: why it is not compared}) of a question."""
    cases = {
        experiment.name: question.cases[experiment.name] for experiment in question.experiments
    }
    chosen, inapplicable = applicable_effects(cases, effects)
    return {name: closures_of(name, question.experiments) for name in chosen}, inapplicable


def baseline_runs(experiments: "Sequence[Experiment]", cases: "Mapping[str, Case]") -> "Wanted":
    """{label: (experiment, case)} of the baseline on both grids, the finer first."""
    fine: Wanted = {
        ("fine", None, one.name): (one, refined(cases[one.name])) for one in experiments
    }
    return fine | {("coarse", None, one.name): (one, cases[one.name]) for one in experiments}


def add_levels(
    library: Library, wanted: Sequence[tuple[str, int, np.ndarray]], runner: "Runner"
) -> Library:
    """The library with further levels of some closures; one whose run fails stays as it is.

    Parameters
    ----------
    library : Library
    wanted : list of (str, int, (d,) array)
        Effect, number of the closure, and quantiles of its parameters.
    runner : Runner
    """
    reading = Reading(library.points, *runner.observations(further_runs(library, wanted), FURTHER))
    responses = dict(library.responses)
    for effect, number, u in wanted:
        labels = [((effect, number), 0, experiment.name) for experiment in library.experiments]
        if any(label in reading.failures for label in labels):
            continue
        difference = reading.vector((effect, number), 0, library.coarse) - library.coarse
        if (effect, number) in library.corrections:
            difference = library.corrections[effect, number](difference)
        before = responses[effect][number]
        responses[effect] = [*responses[effect]]
        responses[effect][number] = Response.fit(
            np.vstack([before.levels, u]), np.vstack([before.differences, difference])
        )
    return replace(library, responses=responses)


def further_runs(library: Library, wanted: Sequence[tuple[str, int, np.ndarray]]) -> "Wanted":
    """{label: (experiment, case)} of further levels, `wanted` as for `add_levels`."""
    runs: Wanted = {}
    for effect, number, u in wanted:
        section = library.closures[effect][number].section(u)
        for experiment in library.experiments:
            base = library.cases[experiment.name]
            if acts_in(effect, base):
                case = base.replace(**{f"effects.{effect}": section})
                runs[(effect, number), 0, experiment.name] = (experiment, case)
    return runs
