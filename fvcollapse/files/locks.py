"""Locks between processes: one process at a time holds a file, and the system frees it when that process dies."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from fvcollapse.errors import InputError, OutputError

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

LOCK = "lock"  # name of the lock file of a folder; it stays there, and is empty


@contextmanager
def exclusive(path: Path, wait: bool = True) -> Iterator[None]:
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


def try_lock(handle: Any) -> bool:
    """Whether this process now holds an open file; always where the system has no locks (Windows).

    Parameters
    ----------
    handle : int or file

    Raises
    ------
    OSError
        The file system has no locks.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
