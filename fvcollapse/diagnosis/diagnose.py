"""Where simulation and experiment differ, which effect causes it, and how far the gap shrinks with it."""

import dataclasses
import time
from hashlib import sha256
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from fvcollapse.case.case import Case, load_case
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.effect_library import (
    DRAWS,
    Runner,
    applicable_effects,
    baseline_cases,
)
from fvcollapse.diagnosis.findings import report_of
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.new_effects import merged
from fvcollapse.diagnosis.next_experiment import choices
from fvcollapse.diagnosis.oddities import oddities_of, tell
from fvcollapse.diagnosis.points import choose_points
from fvcollapse.diagnosis.reduction import climb
from fvcollapse.diagnosis.report import FILE_NAME, Cost, read_report, write_report
from fvcollapse.diagnosis.report_page import FIGURES, PAGE, write_page
from fvcollapse.diagnosis.verdict import VerdictModel, verdict
from fvcollapse.errors import InputError
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import Experiment, load_experiment
from fvcollapse.output.question import case_question, claim_folder
from fvcollapse.studies.workers import refuse_workers

FILMED = 50  # measured values from which the verdict layer, fitted to films of hundreds, is asked


def diagnose(
    experiments,
    case=None,
    hold_out=(),
    effects=None,
    workers=2,
    scheduler=None,
    folder=None,
    cell_size=None,
    seed=0,
    *,
    controls=(),
    cache=None,
    draws=DRAWS,
    quiet=True,
    force=False,
):
    """Diagnose the gap between experiments and the model that is believed.

    All runs go through the cache of runs: an interrupted diagnosis continues where it was with the same
    call, and the next one with the same set-up finds most of its runs done. What is odd about an experiment
    is one line on stderr, before anything is run, and stands in the report.

    Parameters
    ----------
    experiments, hold_out, controls : sequences of Experiment, or of folders
        Those to fit; those that only test what was found; those in which nothing is hidden, which teach
        the discrepancy of the model.
    case : Case or path, optional
        What is believed; without it the defaults with the set-up of each experiment, no effects.
    effects : sequence of str, optional
        Only these effects of the catalogue; default all.
    workers, scheduler, quiet
        See `workers.run_all`.
    folder : str or Path, optional
        Gets `report.json`, `report.html` and `figures/`.
    cell_size : float, optional
        Of the coarser of the two grids [m]; default height / 12 (length / 6 if that is less).
    seed : int
    cache : str or Path, optional
        Folder of the cache of runs; default that of the user.
    draws : int
        Size of the ensemble of calibrated parameters.
    force : bool
        Take `folder` over from the report of another question; see `fvcollapse.output.question`.

    Returns
    -------
    Report

    Raises
    ------
    InputError
        Bad input, before anything is run.
    NumericalError
        The baseline fails.
    """
    start = time.perf_counter()
    experiments, hold_out, controls = map(load_all, (experiments, hold_out, controls))
    if not experiments:
        raise InputError("command line", "EXPERIMENT", "none", "one experiment or more")
    if seed < 0:
        raise InputError("command line", "--seed", str(seed), "0, 1, 2, …")
    choose_points((*experiments, *hold_out, *controls))  # refuses what is given twice
    warnings = oddities_of((*experiments, *hold_out, *controls))
    if case is not None and not isinstance(case, Case):
        case = load_case(case)
    if folder is not None:
        refuse_workers(workers)
        asked = question(experiments, hold_out, controls, case, effects, cell_size)
        claim_folder(folder, "diagnose", asked | {"seed": seed, "draws": draws}, force)
        make_folder(folder, FILE_NAME, PAGE)
        make_folder(Path(folder) / FIGURES)
    tell(warnings)
    runner = Runner(cache, workers, scheduler, quiet)
    analysis = analyse(
        experiments,
        runner,
        case,
        effects=effects,
        controls=controls,
        cell_size=cell_size,
        draws=draws,
        seed=seed,
    )
    model = verdict_model_for(analysis)
    analysis, known = with_known(analysis, model)
    answer = verdict(analysis.evidence, model, analysis.separability, known)
    winner, runner_up = contenders(analysis, answer)
    ladder = climb(analysis, runner, winner, runner_up, hold_out, case, cell_size)
    following = choices(analysis, answer.probability, runner)
    first = experiments[0]
    coarse = analysis.library.cases[first.name].grid.cell_size
    cost = Cost(
        solver_runs=len(runner.asked),
        wall_time_s=time.perf_counter() - start,
        cell_size=coarse,
        cached_runs=len(runner.asked - runner.computed),
    )
    baseline = baseline_cases([first], case, cell_size)[first.name]
    report = report_of(analysis, answer, ladder, following, baseline, cost, model)
    report = replace(report, warnings=warnings)
    if folder is not None:
        report = read_report(write_report(report, folder))
        write_page(report, folder)
    return report


def verdict_model_for(analysis):
    """The `VerdictModel` if it was fitted to data like these: films, no controls, some of these effects; else None."""
    values = np.count_nonzero(analysis.points.kind == "value")
    if analysis.controls or values < FILMED:
        return None
    model = VerdictModel.load()
    return model if model is not None and model.judges(analysis.evidence) else None


def with_known(analysis, model):
    """(`Analysis`, `Evidence` of the effects that the model knows); None without a new effect.

    The pairs of effects that only the latter opened are added to the evidence of the analysis.
    """
    if model is None or model.covers(analysis.evidence):
        return analysis, None
    known = analysis.evidence_of(model.classes)
    return dataclasses.replace(analysis, evidence=merged(analysis.evidence, known)), known


def load_all(experiments):
    """Experiments, read where a folder is given."""
    return tuple(
        one if isinstance(one, Experiment) else load_experiment(one) for one in experiments
    )


def question(experiments, hold_out, controls, case, effects, cell_size):
    """What a diagnosis depends on, beside numbers; see `fvcollapse.output.question`.

    Raises
    ------
    InputError
        There is no effect, or no grid, of this kind.
    """
    baseline_cases(controls, case, cell_size)
    applicable_effects(baseline_cases(experiments, case, cell_size), effects)
    groups = {"experiments": experiments, "hold_out": hold_out, "controls": controls}
    told = {name: [[one.name, digest(one)] for one in group] for name, group in groups.items()}
    told |= {"effects": effects and list(effects), "cell_size": cell_size}
    return told | ({} if case is None else case_question(case))


def digest(experiment):
    """Digest of all that an experiment states and measured."""
    found = sha256(repr((experiment.settings, experiment.scalars)).encode())
    for name, curve in sorted(experiment.curves.items()):
        found.update(name.encode())
        for column in curve:
            found.update(b"" if column is None else np.ascontiguousarray(column).tobytes())
    return found.hexdigest()[:16]


def contenders(analysis, answer):
    """(winner, runner-up) for the ladder: names of hypotheses, None where there is none.

    Where nothing is missing there is no winner; where the cause is unknown the best effects of the
    catalogue show how little they explain. A rival lacks something of the winner: with a second effect
    beside it, it fits what the winner fits.
    """
    ranked = [
        name
        for name in sorted(answer.probability, key=lambda name: -answer.probability[name])
        if name not in (NONE, UNKNOWN) and name in analysis.evidence.hypotheses
    ]
    if answer.kind == NONE or not ranked:
        return None, None
    pair = "+".join(sorted(answer.effects))
    winner = pair if pair in analysis.evidence.hypotheses else ranked[0]
    parts = set(winner.split("+"))
    return winner, next((name for name in ranked if not parts <= set(name.split("+"))), None)
