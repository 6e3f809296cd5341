"""The runs of a study, each in its own folder; unfinished runs are continued, whichever process began them."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fvcollapse.errors import FvcollapseError, InputError, NumericalError, failures_named
from fvcollapse.files.locks import LOCK, exclusive
from fvcollapse.studies.workers import run_all

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def run_member(case: "Case", folder: str | Path, quiet: bool = True, force: bool = False) -> None:
    """Run a case into its folder, or continue it; nothing is done if it is finished.

    Another process that works in the folder is waited for. `force` replaces a run of another case.

    Raises
    ------
    InputError
        The folder holds a run of another case, or one to a later end.
    NumericalError
        The run fails for any other reason.
    """
    from fvcollapse.output.recorder import SAME_TIME  # these load the compiler
    from fvcollapse.output.run import run_case
    from fvcollapse.output.run_folder import CHECKPOINT, RESULT

    folder = Path(folder)
    with failures_named(), exclusive(folder / LOCK):
        started = (folder / RESULT).exists() or (folder / CHECKPOINT).exists()
        result = run_case(case, folder, resume=started, quiet=quiet, force=force)
    if result.case.time.end > case.time.end + SAME_TIME:
        found = f"{case.time.end:g}"
        allowed = f"{result.case.time.end:g}, the end of the result there, or another folder"
        raise InputError(folder / RESULT, "time.end", found, allowed)


def run_members(
    cases: "Mapping[Any, Case]",
    workers: int = 1,
    quiet: bool = True,
    run: Callable = run_member,
    tell: Callable[[str], object] = print,
    failed: Callable | None = None,
) -> None:
    """Run the unfinished cases of {folder: case}; `tell` gets one line of text for every finished run.

    Finished runs are retained, and a run that was stopped leaves its checkpoint: the next call
    continues from there.

    Parameters
    ----------
    failed : function, optional
        Called with the folder and the NumericalError of a member that fails, while the others go on;
        without it the first failure ends the study.

    Raises
    ------
    NumericalError, OutputError, InputError
    """

    def finished(folder, outcome):
        if isinstance(outcome, NumericalError):
            if failed is None:
                raise NumericalError(f"{folder}: {outcome.what}", outcome.where, outcome.time)
            failed(folder, outcome)
        elif isinstance(outcome, FvcollapseError):
            raise outcome
        else:
            tell(f"{folder}: done")

    # the finest takes longest: among several it starts first
    folders = list(cases) if workers == 1 else list(reversed(cases))
    calls = {folder: (cases[folder], folder, quiet or workers > 1) for folder in folders}
    run_all(run, calls, finished, workers, quiet=quiet)
