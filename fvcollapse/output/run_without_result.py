"""Runs by the hundred, of which no result is wanted but what is made of it.

A checkpoint, a result and their fields take 0.15 s to write and to read. That is a third of a run on coarse cells.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from fvcollapse.output.compilation import prepare_kernels
from fvcollapse.output.run import Job, begun, march_on
from fvcollapse.output.run_folder import ready, tidy, usable_checkpoint
from fvcollapse.output.run_log import run_log

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def run_without_result(case: "Case", folder: Path, keep: Callable, quiet: bool = True) -> None:
    """Run a case of which no result is wanted, or continue it from the checkpoint in `folder`.

    The folder gets the log, and a checkpoint every 20 s and when the run is interrupted; of a run that fails the
    result as well, without fields. A run of another case there is replaced.

    Parameters
    ----------
    case : Case
    folder : str or Path
        Made if need be; nobody else may work in it.
    keep : function
        Gets the finished `Job`, and keeps of it what is wanted.
    quiet : bool
        No progress bar (there is none either when stderr is not a terminal).

    Raises
    ------
    OutputError
        The folder is not writable, or the disk is full.
    NumericalError, KeyboardInterrupt
        After the last good state was saved.
    """
    folder = Path(folder)
    with run_log(folder) as log:
        tidy(folder)
        stored = usable_checkpoint(folder, log) if ready(case, folder, False, True) else None
        prepare_kernels(case, quiet)
        keeper = begun(case, folder, log, stored, partial(Job, fields=False))
        keeper.keep = keep
        march_on(keeper, quiet)
        log.info("done\nstep %d at t = %g s", keeper.job.state.step, keeper.job.state.time)
