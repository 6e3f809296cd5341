"""Where simulation and experiment differ, which effect causes it, and how far the gap shrinks with it.

Six stages: `ask` reads and checks the question, `analyse` runs and compares, `judge` gives the verdict, `climb` adds
the effect to the solver, `choices` plans the next experiment, `report_of` writes down the results.
"""

import dataclasses
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace
from threadpoolctl import threadpool_limits

from fvcollapse.case.case import Case, load_case
from fvcollapse.console.rounds_bar import RoundsBar
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.ladder import climb
from fvcollapse.diagnosis.library import DRAWS
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.new_effects import merged
from fvcollapse.diagnosis.next_experiment import choices
from fvcollapse.diagnosis.oddities import coarse_grid, oddities_of, tell
from fvcollapse.diagnosis.progress import expected_costs
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.record import recorded
from fvcollapse.diagnosis.report.findings import partial_answers, report_of
from fvcollapse.diagnosis.report.made import made
from fvcollapse.diagnosis.report.page import FIGURES, NEXT_CASE, PAGE, write_page
from fvcollapse.diagnosis.report.painter import Painter
from fvcollapse.diagnosis.report.report_file import FILE_NAME, read_report, write_report
from fvcollapse.diagnosis.report.run_table import RUNS_FILE, run_groups, run_rows, write_runs
from fvcollapse.diagnosis.report.schema import Cost
from fvcollapse.diagnosis.runner import StandingRunner
from fvcollapse.diagnosis.sequence import sequence
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.diagnosis.verdict_model import VerdictModel
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import Experiment, load_experiment
from fvcollapse.output.question import claim_folder
from fvcollapse.studies.standing import StandingWorkers
from fvcollapse.studies.workers import refuse_workers

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.evidence import Evidence
    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.run_table import RunRow
    from fvcollapse.diagnosis.report.schema import Report
    from fvcollapse.diagnosis.runner import Runner
    from fvcollapse.diagnosis.verdict import Verdict

FILMED = 50  # measured values from which the verdict layer, fitted to films of hundreds, is asked


def diagnose(
    experiments: Sequence[Experiment | str | Path],
    case: Case | str | Path | None = None,
    hold_out: Sequence[Experiment | str | Path] = (),
    effects: Sequence[str] | None = None,
    workers: int = 2,
    scheduler: str | None = None,
    folder: str | Path | None = None,
    cell_size: float | None = None,
    seed: int = 0,
    *,
    controls: Sequence[Experiment | str | Path] = (),
    cache: str | Path | None = None,
    draws: int = DRAWS,
    quiet: bool = True,
    force: bool = False,
) -> "Report":
    """Diagnose the gap between experiments and the model that is believed.

    All runs go through the cache of runs: an interrupted diagnosis continues where it was with the same
    call, and the next one with the same set-up reuses most of its runs. Each implausible number of an experiment
    is one line on stderr, before anything is run, and stands in the report.

    Parameters
    ----------
    experiments, hold_out, controls : sequences of Experiment, or of folders
        Those to fit; those that only test the answer; those in which nothing is hidden, which calibrate
        the model error.
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
    question = ask(experiments, hold_out, controls, case, cell_size, seed)
    warnings = oddities_of((*question.experiments, *question.held_out, *question.controls))
    if folder is not None:
        refuse_workers(workers)
        claim_folder(folder, "diagnose", recorded(question, effects, draws), force)
        make_folder(folder, FILE_NAME, PAGE, RUNS_FILE, NEXT_CASE)
        make_folder(Path(folder) / FIGURES)
    tell([*warnings, *coarse_grid(question)])
    with (
        StandingWorkers(workers, scheduler) as standing,
        closing(RoundsBar(expected_costs(question), quiet)) as bar,
        threadpool_limits(1),  # the matrices are small: two threads take three times as long
    ):
        runner = StandingRunner(cache, standing, bar)
        painter = None if folder is None else Painter(standing)
        analysis = analyse(question, runner, effects=effects, draws=draws)
        analysis, judged, model = judge(analysis)
        ladder = climb(analysis, runner, *contenders(analysis, judged))
        following = choices(analysis, judged.probability, runner)
        bar.close()
        cost = cost_of(question, runner, time.perf_counter() - start)
        report = report_of(analysis, judged, ladder, following, cost, model)
        rows = run_rows(runner, question)
        origin = made(question, case, effects, folder)
        parts = partial_answers(sequence(analysis, judge))
        details = replace(report.details, runs=run_groups(rows), made=origin, sequence=parts)
        report = replace(report, warnings=warnings, details=details)
        return report if folder is None else written(report, rows, folder, painter.draw)  # type: ignore[union-attr]


def written(
    report: "Report",
    rows: "Sequence[RunRow]",
    folder: str | Path,
    draw: "Callable[[Report, int], list[Picture]] | None" = None,
) -> "Report":
    """The report as it stands in its folder, with its page, its runs and the case of the next experiment.

    Parameters
    ----------
    report : Report
    rows : list of RunRow
    folder : str or Path
    draw : function, optional
        See `figures.pictures`.

    Raises
    ------
    OutputError
    """
    report = read_report(write_report(report, folder))
    write_runs(rows, folder)
    following = Path(folder) / NEXT_CASE
    if report.next_experiment is None:
        following.unlink(missing_ok=True)  # of an earlier answer to the same question
    else:
        write_atomic(following, report.next_experiment.case.encode())
    write_page(report, folder, draw)
    return report


def ask(
    experiments: Sequence[Experiment | str | Path],
    hold_out: Sequence[Experiment | str | Path],
    controls: Sequence[Experiment | str | Path],
    case: Case | str | Path | None,
    cell_size: float | None,
    seed: int,
) -> Question:
    """The `Question`, its input read and checked; parameters as for `diagnose`.

    Raises
    ------
    InputError
    """
    experiments, hold_out, controls = map(load_all, (experiments, hold_out, controls))
    if not experiments:
        raise InputError("command line", "EXPERIMENT", "none", "one experiment or more")
    if seed < 0:
        raise InputError("command line", "--seed", str(seed), "0, 1, 2, …")
    if case is not None and not isinstance(case, Case):
        case = load_case(case)
    question = Question(experiments, hold_out, controls, case, cell_size, seed)
    question.check()
    return question


def judge(analysis: "Analysis") -> "tuple[Analysis, Verdict, VerdictModel | None]":
    """(`Analysis` with all pairs that were opened, its `Verdict`, the `VerdictModel` or None)."""
    model = verdict_model_for(analysis)
    analysis, known = with_known(analysis, model)
    return analysis, verdict(analysis.evidence, model, analysis.separability, known), model


def cost_of(question: Question, runner: "Runner", seconds: float) -> Cost:
    """The `Cost` of a diagnosis that took some seconds."""
    return Cost(
        solver_runs=len(runner.asked),
        wall_time_s=seconds,
        cell_size=question.baseline.grid.cell_size,
        cached_runs=len(runner.asked - runner.computed),
    )


def verdict_model_for(analysis: "Analysis") -> VerdictModel | None:
    """The `VerdictModel` if it was fitted to data like these; else None.

    It was fitted to films, on cells of `usual_cell_size`, with some of the effects; diagnoses with controls have a
    model of their own.
    """
    values = np.count_nonzero(analysis.points.kind == "value")
    if values < FILMED or analysis.question.coarse_cells:
        return None
    model = VerdictModel.load(controls=bool(analysis.controls))
    return model if model is not None and model.judges(analysis.evidence) else None


def with_known(
    analysis: "Analysis", model: VerdictModel | None
) -> "tuple[Analysis, Evidence | None]":
    """(`Analysis`, `Evidence` of the effects that the model knows); None without a new effect.

    The pairs of effects that only the latter opened are added to the evidence of the analysis.
    """
    if model is None or model.covers(analysis.evidence):
        return analysis, None
    known = analysis.evidence_of(model.classes)
    return dataclasses.replace(analysis, evidence=merged(analysis.evidence, known)), known


def load_all(experiments: Sequence[Experiment | str | Path]) -> tuple[Experiment, ...]:
    """Experiments, read where a folder is given."""
    return tuple(
        given if isinstance(given, Experiment) else load_experiment(given) for given in experiments
    )


def contenders(analysis: "Analysis", answer: "Verdict") -> tuple[str | None, str | None]:
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
