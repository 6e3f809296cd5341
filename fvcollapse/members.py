"""The runs that make up a study: each in its own folder, in one process or several, resumable."""

import multiprocessing
import os
import signal
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path

from fvcollapse.errors import InputError, NumericalError
from fvcollapse.output import CHECKPOINT, RESULT, run_case
from fvcollapse.recorder import SAME_TIME


def run_member(case, folder, quiet=True):
    """Run a case into its folder, or continue it; nothing is done if it is finished.

    Raises
    ------
    InputError
        The folder holds a run of another case, or one to a later end.
    """
    begun = any((Path(folder) / name).exists() for name in (RESULT, CHECKPOINT))
    result = run_case(case, folder, resume=begun, quiet=quiet)
    if result.case.time.end > case.time.end + SAME_TIME:
        found = f"{case.time.end:g}"
        allowed = f"{result.case.time.end:g}, the end of the result there, or another folder"
        raise InputError(Path(folder) / RESULT, "time.end", found, allowed)


def run_members(cases, workers=1, quiet=True, run=run_member, tell=print):
    """Run what is not finished of {folder: case}; the first failure ends the study.

    What is finished is kept; a member that was running leaves its checkpoint. The next call
    continues both.
    """
    if workers == 1:
        for folder, case in cases.items():
            with named(folder):
                run(case, folder, quiet)
            tell(f"{folder}: done")
        return
    before = set(multiprocessing.active_children())
    handler = signal.signal(signal.SIGTERM, interrupt)
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, context, leave_interrupts_to_the_parent)
    try:
        # the finest takes longest: it starts first
        futures = {pool.submit(run, cases[folder], folder): folder for folder in reversed(cases)}
        for future in as_completed(futures):
            with named(futures[future]):
                future.result()
            tell(f"{futures[future]}: done")
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - before:
            child.terminate()  # a member that is marching saves its state first
        raise
    finally:
        pool.shutdown()
        signal.signal(signal.SIGTERM, handler)


@contextmanager
def named(folder):
    """Add the folder of a member to what failed in it."""
    try:
        yield
    except NumericalError as error:
        raise NumericalError(f"{folder}: {error.what}", error.where, error.time) from None
    except BrokenProcessPool:
        raise NumericalError(f"{folder}: the process was killed (memory?)") from None


def interrupt(number, frame):
    """End a study on SIGTERM as Ctrl-C does."""
    raise KeyboardInterrupt


def leave_interrupts_to_the_parent():
    """Keep Ctrl-C from a worker: it gets one signal, from the parent, that it answers by saving."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if os.name == "posix":
        os.setpgid(0, 0)  # a marching run has its own handler of SIGINT, which this keeps idle
