"""Locks between processes: a file that one process at a time may hold, freed when that process dies."""

from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from fvcollapse.errors import InputError, OutputError

LOCK = "lock"  # name of the lock file of a folder; it stays there, and is empty


@contextmanager
def exclusive(path, wait=True):
    """Hold the lock file at `path`, made with its folder if need be.

    Parameters
    ----------
    path : str or Path
    wait : bool
        Wait for whoever holds it; else refuse.

    Raises
    ------
    OutputError
        The folder cannot be written, or its file system has no locks.
    InputError
        Somebody holds it, and `wait` is False.
    """
    path = Path(path)
    lock = FileLock(path, timeout=-1 if wait else 0)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout:
        allowed = "a folder that no other process works in"
        raise InputError(path.parent, "folder", "another run that writes there", allowed) from None
    except (OSError, NotImplementedError) as error:
        raise OutputError(path.parent, error, running=False) from None
    try:
        yield
    finally:
        lock.release()
