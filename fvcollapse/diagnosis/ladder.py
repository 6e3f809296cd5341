"""How far the gap shrinks when an effect is added to the solver: a ladder of models, each run.

    G0 baseline as given,  G1 re-calibrated,  G2 winner and re-calibrated,  G2' runner-up and re-calibrated

One true run of every experiment verifies each re-calibration (`recalibration`). Held-out experiments take no part
in it. Without any, each experiment is left out in turn.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.analysis import ORDER
from fvcollapse.diagnosis.baseline import REFINEMENT
from fvcollapse.diagnosis.closing import Group, one_fraction, remaining, with_simulated
from fvcollapse.diagnosis.covariance import measurement_covariance, numerical_covariance
from fvcollapse.diagnosis.names import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.diagnosis.progress import MODELS
from fvcollapse.diagnosis.reading import Reading
from fvcollapse.diagnosis.recalibration import Recalibration, Refit
from fvcollapse.errors import CaseError

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.nuisances import Nuisance
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.diagnosis.runner import Failures, Label, Runner, Wanted
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations


@dataclass(frozen=True)
class Ladder:
    """The models and what they give.

    Attributes
    ----------
    fits : dict
        Model (key of `names.RUNGS`) -> `Refit`; a model whose runs failed is not there.
    names : dict
        Model -> name of its hypothesis ("" for the first two).
    quantities : tuple of Nuisance
        The calibrated parameters that `Refit.z` is of.
    fitted : Group
    held_out : Group or None
    predicted : dict
        Model -> (n,) values of the emulator on the points that were fitted.
    left_out : dict
        Experiment -> {model: (n,) values} of models calibrated without it.
    failures : tuple of str
    """

    fits: dict[str, Refit]
    names: dict[str, str]
    quantities: "tuple[Nuisance, ...]"
    fitted: Group
    held_out: Group | None
    predicted: dict[str, np.ndarray]
    left_out: dict[str, dict[str, np.ndarray]]
    failures: tuple[str, ...]


def climb(
    analysis: "Analysis", runner: "Runner", winner: str | None = None, runner_up: str | None = None
) -> Ladder:
    """The `Ladder` of the question of an analysis.

    Parameters
    ----------
    analysis : Analysis
    runner : Runner
    winner, runner_up : str, optional
        Names of hypotheses of the evidence; without a winner there are the first two models only.

    Raises
    ------
    NumericalError
        The baseline of a held-out experiment fails.
    """
    question, problem = analysis.question, Recalibration(analysis)
    names = {BASELINE: "", RECALIBRATED: ""}
    names |= {model: name for model, name in ((WINNER, winner), (RUNNER_UP, runner_up)) if name}
    fits = refits(problem, names)
    wanted, refused = true_runs(problem, fits, question)
    for model in refused:
        del fits[model], names[model]
    folds = folds_of(question)
    left_out, impossible = fold_runs(problem, names, folds)
    seen, failures = runner.observations(wanted | left_out, MODELS)
    failures = failures | impossible
    reading = Reading(analysis.points, seen, failures)
    return Ladder(
        fits=fits,
        names=names,
        quantities=problem.quantities,
        fitted=fitted_group(problem, reading, fits),
        held_out=held_out_group(question, seen, failures, fits) if question.held_out else None,
        predicted={model: problem.predicted(fit)[analysis.own] for model, fit in fits.items()},
        left_out=left_out_values(reading, folds, names),
        failures=failure_lines(refused, failures),
    )


def refits(problem: Recalibration, names: Mapping[str, str]) -> dict[str, Refit]:
    """{model: `Refit`} of the models on all points; the baseline stays as given."""
    everything = np.ones(len(problem.library.points), bool)
    fits = {model: problem.fit(name, everything) for model, name in names.items()}
    return fits | {BASELINE: Refit({}, np.zeros(len(problem.quantities)))}


def folds_of(question: "Question") -> "tuple[Experiment, ...]":
    """Experiments that are left out in turn: all, where none is held out."""
    alone = question.held_out or len(question.experiments) == 1
    return () if alone else question.experiments


def failure_lines(refused: Mapping[str, CaseError], failures: "Failures") -> tuple[str, ...]:
    """One line for each model that cannot be run and for each run that failed."""
    lines = [f"{model}: {error}" for model, error in refused.items()]
    lines += [f"{model} ({name}): {error}" for (model, _, name), error in failures.items()]
    return tuple(lines)


def true_runs(
    problem: Recalibration, fits: Mapping[str, Refit], question: "Question"
) -> "tuple[Wanted, dict[str, CaseError]]":
    """({label: (experiment, case)} of all models, {model: CaseError} of effects that cannot be together)."""
    cases = question.cases | question.held_out_cases
    wanted, refused = {}, {}  # type: ignore[var-annotated]
    for model, fit in fits.items():
        try:
            wanted |= {
                (model, None, experiment.name): (
                    experiment,
                    problem.case(fit, experiment, cases[experiment.name]),
                )
                for experiment in (*question.experiments, *question.held_out)
            }
        except CaseError as error:
            refused[model] = error
    wanted |= {
        ("coarse", None, experiment.name): (experiment, cases[experiment.name])
        for experiment in question.held_out
    }
    return wanted, refused


def fold_runs(
    problem: Recalibration, names: Mapping[str, str], folds: "Sequence[Experiment]"
) -> "tuple[Wanted, dict[Label, CaseError]]":
    """Runs of the models calibrated without each experiment in turn, and why others cannot be.

    Returns
    -------
    (dict, dict)
        {label: (experiment, case)}, {label: CaseError}.
    """
    points, wanted, refused = problem.library.points, {}, {}
    for experiment in folds:
        others = np.ones(len(points), bool)
        others[points.of(experiment)] = False
        for model, name in names.items():
            if model != BASELINE:
                fit = problem.fit(name, others)
                label = without(model, experiment)
                try:
                    wanted[label] = (
                        experiment,
                        problem.case(fit, experiment, problem.library.cases[experiment.name]),
                    )
                except CaseError as error:
                    refused[label] = error
    return wanted, refused


def without(model: str, experiment: "Experiment") -> "Label":
    """Label of the run of an experiment with a model calibrated without it."""
    return f"{model} without", None, experiment.name


def fitted_group(problem: Recalibration, reading: Reading, fits: Mapping[str, Refit]) -> Group:
    """The `Group` of the experiments that were fitted."""
    shifts, covariance = problem.after_controls(fits)
    simulated = simulated_by(reading, fits, reading.failures)
    return Group(reading.points, problem.library.cases, shifts, covariance, simulated)


def simulated_by(
    reading: Reading, models: Iterable[str], failures: "Failures"
) -> dict[str, np.ndarray]:
    """{model: values on the points} of the models of which no run failed."""
    broken = {model for model, _, name in failures if name in reading.parts}
    return {model: reading.vector(model, None) for model in models if model not in broken}


def left_out_values(
    reading: Reading, folds: "Sequence[Experiment]", names: Collection[str]
) -> dict[str, dict[str, np.ndarray]]:
    """{experiment: {model: values on its points}} of the models calibrated without it."""
    return {
        experiment.name: {
            model: reading.parts[experiment.name].simulated(
                {experiment.name: reading.seen[without(model, experiment)]}
            )
            for model in names
            if without(model, experiment) in reading.seen
        }
        for experiment in folds
    }


def held_out_group(
    question: "Question",
    seen: "Mapping[Label, Observations]",
    failures: "Failures",
    fits: Collection[str],
) -> Group:
    """The `Group` of the experiments that were held out."""
    points = question.held_out_points
    reading = Reading(points, seen, failures)
    fine, coarse = reading.vector(BASELINE, None), reading.vector("coarse", None)
    baseline = {name: seen[BASELINE, None, name] for name in points.names}
    covariance = measurement_covariance(points, points.sensitivity(baseline))
    covariance += numerical_covariance(points, coarse, fine, 1.0 / REFINEMENT, ORDER)
    simulated = simulated_by(reading, fits, failures)
    shifts = {model: np.zeros(len(points)) for model in fits}
    return Group(points, question.held_out_cases, shifts, covariance, simulated)


def fold_fractions(ladder: Ladder) -> dict[tuple[str, bool], dict[str, float]]:
    """{(experiment, held out): {model: fraction closed}} of all experiments that took no part."""
    return by_fold(ladder, one_fraction)


def fold_remainders(ladder: Ladder) -> dict[tuple[str, bool], dict[str, float]]:
    """{(experiment, held out): {model: gap that is left}} of all experiments that took no part; see `remaining`."""
    return by_fold(ladder, remaining)


def by_fold(
    ladder: Ladder, measure: Callable[[Group, slice, str], float]
) -> dict[tuple[str, bool], dict[str, float]]:
    """{(experiment, held out): {model: measure(group, rows, model)}} of all experiments that took no part."""
    measured: dict[tuple[str, bool], dict[str, float]] = {}
    for name, values in ladder.left_out.items():
        rows = ladder.fitted.points.of(name)
        measured[name, False] = {}
        for model, left_out in values.items():
            simulated = {model: ladder.fitted.simulated[BASELINE].copy()}
            simulated[model][rows] = left_out
            group = with_simulated(ladder.fitted, simulated)
            measured[name, False][model] = measure(group, rows, model)
    if ladder.held_out is not None:
        group = ladder.held_out
        for name in group.points.names:
            rows = group.points.of(name)
            models = [model for model in group.simulated if model != BASELINE]
            measured[name, True] = {model: measure(group, rows, model) for model in models}
    return measured
