"""What can go wrong, named: every failure is one line that says what and where."""

import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class FvcollapseError(Exception):
    """Base of all errors raised on purpose; the command line returns `exit_status`."""

    exit_status = 1


class InputError(FvcollapseError):
    """Bad input, refused before anything is computed or written (exit status 2).

    Parameters
    ----------
    file : str or Path
        File (or "command line") that holds the input.
    key : str
        Dotted key, e.g. "geometry.height_0"; "file" when it is the file as a whole.
    found : str
        What was found there.
    allowed : str
        What would be accepted instead.
    """

    exit_status = 2

    def __init__(self, file: str | Path, key: str, found: str, allowed: str) -> None:
        super().__init__(str(file), key, found, allowed)
        self.file, self.key, self.found, self.allowed = str(file), key, found, allowed

    def __str__(self) -> str:
        return one_line(f"{self.file}: {self.key}: found {self.found}; allowed: {self.allowed}")


class UnreadableError(InputError):
    """A file that may be sound, but cannot be read now: locked, or not permitted."""


class CaseError(InputError):
    """A case file, or a `--set` on top of it, that is refused."""


class NumericalError(FvcollapseError):
    """The computation failed; what was computed so far is kept (exit status 1).

    Parameters
    ----------
    what : str
        The physics or the solver that failed, and the cure if there is one.
    where : str
        Place, e.g. "at x = 0.93 m, z = 0.01 m" or "in the pressure solve".
    time : float
        Simulated time [s].
    """

    def __init__(self, what: str, where: str = "", time: float = float("nan")) -> None:
        super().__init__(what, where, time)
        self.what, self.where, self.time = what, where, time

    def __str__(self) -> str:
        moment = f"at t = {self.time:.6g} s" if self.time == self.time else ""
        return one_line(", ".join(part for part in (self.what, self.where, moment) if part))


class LimitReached(NumericalError):
    """A run that is sound so far but outgrows a stated limit; what was computed is kept (exit status 1)."""


class OutputError(FvcollapseError):
    """A file cannot be written: folder not writable, disk full, ...

    Parameters
    ----------
    path : str or Path
        File or folder that could not be written.
    problem : str or OSError
        What went wrong.
    running : bool
        True when the computation had begun (exit status 1, what was written is kept);
        False when nothing was computed yet (exit status 2).
    """

    def __init__(self, path: str | Path, problem: str | Exception, running: bool = False) -> None:
        super().__init__(str(path), problem, running)
        self.path, self.problem, self.running = str(path), problem, running
        self.exit_status = 1 if running else 2

    def __str__(self) -> str:
        problem = getattr(self.problem, "strerror", None) or self.problem
        return one_line(f"{self.path}: cannot be written: {problem}")


def named_failure(error: BaseException, time: float = float("nan")) -> FvcollapseError:
    """Whatever ended a computation as an error on purpose: itself if it is one, else a NumericalError.

    Parameters
    ----------
    error : Exception
    time : float
        Simulated time [s].

    Returns
    -------
    FvcollapseError
    """
    if isinstance(error, FvcollapseError):
        return error
    if isinstance(error, MemoryError):
        what = "the memory is exhausted; a coarser grid or fewer outputs need less"
        return NumericalError(what, time=time)
    message = f": {error}" if str(error) else ""
    return NumericalError(f"unexpected {type(error).__name__}{message}", origin(error), time)


def origin(error: BaseException) -> str:
    """File and line that raised an error, "" if unknown."""
    frames = traceback.extract_tb(error.__traceback__)
    return f"in {Path(frames[-1].filename).name}, line {frames[-1].lineno}" if frames else ""


@contextmanager
def failures_named() -> Iterator[None]:
    """Raise whatever goes wrong inside as an error on purpose (see `named_failure`).

    For one run among many: an unexpected error of one must not end the others.
    """
    try:
        yield
    except FvcollapseError:
        raise
    except Exception as error:
        raise named_failure(error) from error


def as_output_error(error: BaseException, path: str | Path, running: bool) -> OutputError:
    """The error of a file at `path` that could not be written: a MemoryError leaves the previous one."""
    if isinstance(error, OutputError):
        return error
    return OutputError(path, "no memory to build the file; the previous one is kept", running)


def one_line(text: object) -> str:
    """The text on one line: runs of blanks and line breaks as one blank, what cannot be printed escaped."""
    words = " ".join(str(text).split())
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in words)
