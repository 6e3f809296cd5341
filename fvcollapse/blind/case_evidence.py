"""Cases by the hundred through the evidence of the diagnosis; no label is read.

Cases with the same set-ups share the library of their runs, which is computed once, through the cache. Cases are
taken in batches, so that what has been read of the library serves a whole batch; those of one world, which have its
controls in common, follow one another.
"""

import json
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fvcollapse.blind.evidence_file import content_of
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.runner import Runner
from fvcollapse.errors import FvcollapseError, InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import SETTINGS, Experiment, load_experiment
from fvcollapse.studies.workers import HERE, Resources, run_all

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.measure.observables import Observations

BATCH = 15  # cases that a worker takes at once
CONTROLS = "controls"  # folder of a case that holds the controls of its laboratory


class RememberingRunner(Runner):
    """A `Runner` that holds the observations that it has read, for the next case of the same design."""

    def __init__(self, folder: str | Path | None = None, resources: Resources = HERE) -> None:
        super().__init__(folder, *resources)
        self.remembered: dict[tuple, Observations] = {}

    def observations(
        self, wanted: "Mapping[Any, tuple[Experiment, Case]]", phase: str = ""
    ) -> "tuple[dict[Any, Observations], dict[Any, FvcollapseError]]":
        """See `Runner.observations`."""
        keys = {
            label: (case, experiment.front_thickness, experiment.time_origin)
            for label, (experiment, case) in wanted.items()
        }
        missing = {
            label: wanted[label] for label, key in keys.items() if key not in self.remembered
        }
        seen, failures = super().observations(missing, phase) if missing else ({}, {})
        for label, observations in seen.items():
            self.remembered[keys[label]] = observations
        known = {
            label: self.remembered[key] for label, key in keys.items() if key in self.remembered
        }
        return known, failures


def study(
    folder: str | Path,
    out: str | Path,
    workers: int = 1,
    scheduler: str | None = None,
    quiet: bool = True,
    only: Collection[str] | None = None,
    **options: Any,
) -> dict[str, NumericalError]:
    """Write the evidence of every case of a folder; files that are there stay.

    Parameters
    ----------
    folder : str or Path
        As `make` leaves it.
    out : str or Path
        Gets `<case>.json`.
    workers, scheduler, quiet
        See `workers.run_all`.
    only : collection of str, optional
        Names of the cases; default all.
    **options
        `cache`, `cell_size`, `draws`, `effects`, `refinements` and `seed` of the diagnosis; `controls`: whether it
        gets the controls of the laboratory.

    Returns
    -------
    dict
        Case -> NumericalError, of those that could not be compared.
    """
    out = make_folder(Path(out).absolute())
    wanted = [case for case in case_folders(folder) if only is None or case.name in only]
    missing = [case for case in wanted if not (out / f"{case.name}.json").exists()]
    calls = {batch: (batch, out, options) for batch in in_batches(missing)}
    return each_batch(keep_batch, calls, Resources(workers, scheduler, quiet))


def in_batches(cases: Sequence[Path]) -> list[tuple[Path, ...]]:
    """Tuples of at most `BATCH` cases, in order."""
    return [tuple(cases[start : start + BATCH]) for start in range(0, len(cases), BATCH)]


def each_batch(
    task: Callable[..., dict[str, Any]], calls: dict[tuple[Path, ...], tuple], resources: Resources
) -> dict[str, Any]:
    """{name of a case: outcome} of a task that returns such a dictionary for every batch of cases.

    Parameters
    ----------
    task : function
    calls : dict
        Batch (tuple of Path) -> arguments of the task.
    resources : Resources

    Raises
    ------
    FvcollapseError
        Of a batch; a NumericalError becomes the outcome of its cases instead.
    """
    outcomes: dict[str, Any] = {}

    def finished(batch: tuple[Path, ...], outcome: dict[str, Any] | FvcollapseError) -> None:
        if isinstance(outcome, NumericalError):
            outcomes.update(dict.fromkeys((case.name for case in batch), outcome))
        elif isinstance(outcome, FvcollapseError):
            raise outcome
        else:
            outcomes.update(outcome)

    run_all(task, calls, finished, *resources)
    return outcomes


def case_folders(folder: str | Path) -> list[Path]:
    """Folders of the cases, in order.

    Raises
    ------
    InputError
        There is none.
    """
    folder = Path(folder).absolute()
    cases = sorted({path.parent.parent for path in folder.glob(f"*/*/{SETTINGS}")})
    if not cases:
        raise InputError(folder, "folder", "no cases", "a folder that blind make has written")
    return cases


def design_of(case: Path) -> tuple[str, ...]:
    """Names of the experiments of a case."""
    return tuple(sorted(path.parent.name for path in case.glob(f"*/{SETTINGS}")))


def runner_of(options: Mapping[str, Any], resources: Resources = HERE) -> RememberingRunner:
    """The runner of a design, with the cache of the options."""
    return RememberingRunner(options.get("cache"), resources)


def analysis_of(
    case: Path,
    runner: Runner,
    options: Mapping[str, Any],
    folders: Sequence[Path] | None = None,
) -> "Analysis":
    """The `Analysis` of a case, with the controls of its laboratory if the options say so.

    `folders` are its experiments; default those of the case.
    """
    options = {name: value for name, value in options.items() if name != "cache"}
    asked: dict[str, Any] = {
        name: options.pop(name) for name in ("cell_size", "seed") if name in options
    }
    folders = [case / name for name in design_of(case)] if folders is None else folders
    experiments = tuple(map(load_experiment, folders))
    if options.pop("controls", False):
        asked["controls"] = tuple(map(load_experiment, controls_of(case)))
    return analyse(Question(experiments, **asked), runner, **options)


def controls_of(case: Path) -> list[Path]:
    """Folders of the controls of the laboratory of a case."""
    return [path.parent for path in sorted((case / CONTROLS).glob(f"*/{SETTINGS}"))]


def keep_evidence(case: Path, out: Path, runner: Runner, options: Mapping[str, Any]) -> None:
    """Write the evidence of one case into a folder."""
    content = content_of(analysis_of(case, runner, options))
    write_atomic(out / f"{case.name}.json", (json.dumps(content) + "\n").encode())


def keep_batch(
    cases: Iterable[Path], out: Path, options: Mapping[str, Any]
) -> dict[str, NumericalError]:
    """Write the evidence of some cases; {case: NumericalError} of those that failed."""
    runner, failed = runner_of(options), {}
    for case in cases:
        try:
            keep_evidence(case, out, runner, options)
        except NumericalError as error:
            failed[case.name] = error
    return failed
