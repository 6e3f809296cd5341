"""How a report was made: the command, the date and the versions."""

import shlex
from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from fvcollapse.case.case import Case
from fvcollapse.diagnosis.report.schema_origin import Made
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.version import __version__

if TYPE_CHECKING:
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.measure.experiment import Experiment


def made(
    question: "Question",
    case: Case | str | Path | None,
    effects: Sequence[str] | None,
    folder: str | Path | None,
) -> Made:
    """The `Made` of a diagnosis that ends now.

    Parameters
    ----------
    question : Question
    case : Case or path, optional
        What is believed, as it was given.
    effects : sequence of str, optional
    folder : str or Path, optional
        Of the report.
    """
    now = datetime.now().astimezone().isoformat(timespec="seconds")
    command = command_of(question, case, effects, folder)
    return Made(command=command, date=now, version=__version__, solver=solver_version())


def command_of(
    question: "Question",
    case: Case | str | Path | None,
    effects: Sequence[str] | None,
    folder: str | Path | None,
) -> str:
    """A command line that asks the same question; a `Case` made in Python stands as `case.toml`."""
    words = ["fvcollapse", "diagnose", *folders(question.experiments)]
    for option, group in (("--hold-out", question.held_out), ("--controls", question.controls)):
        words += [option, *folders(group)] if group else []
    if case is not None:
        words += ["--case", "case.toml" if isinstance(case, Case) else str(case)]
    words += ["--effects", ",".join(effects)] if effects else []
    words += [] if question.cell_size is None else ["--cell-size", f"{question.cell_size:g}"]
    words += ["--seed", str(question.seed)] if question.seed else []
    words += ["--out", str(Path(folder))] if folder is not None else []
    return shlex.join(words)


def folders(experiments: "Iterable[Experiment]") -> list[str]:
    """Folders of experiments as they were given."""
    return [str(experiment.folder) for experiment in experiments]
