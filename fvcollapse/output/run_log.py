"""The log of a run: run.log in its folder, which one run at a time may hold.

What is logged also goes to the logger "fvcollapse" of the process, if somebody listens there.
"""

import logging
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fvcollapse.errors import InputError, OutputError
from fvcollapse.files.locks import exclusive, fcntl, try_lock
from fvcollapse.version import __version__

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


LOG, LOCK = "run.log", ".run.lock"  # the second is used where a log cannot be locked
SAID: set[str] = set()  # warnings of this process that are given once


class LogFile(logging.FileHandler):
    """A log that a full disk does not stop: the results will report it."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (name fixed by logging)
        """Drop the record."""

    def close(self) -> None:
        """Close the file; what it could not take is dropped."""
        with suppress(OSError):
            super().close()


@contextmanager
def run_log(folder: Path) -> Iterator[logging.Logger]:
    """Make the folder and append to its run.log, which only one run at a time may hold.

    Raises
    ------
    OutputError
        The folder cannot be written.
    InputError
        Another run is writing there.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handler = LogFile(folder / LOG, encoding="utf-8")
    except OSError as error:
        raise OutputError(folder, error, running=False) from None
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    log = logging.Logger("fvcollapse.run", logging.INFO)  # one per run, below the registered one
    log.parent = logging.getLogger("fvcollapse")
    log.addHandler(handler)
    try:
        with only_writer(folder, handler.stream, log):
            yield log
    finally:
        handler.close()


@contextmanager
def only_writer(folder: Path, stream: Any, log: logging.Logger) -> Iterator[None]:
    """Refuse a folder in which another run holds its log; the system frees it when that run dies."""
    if fcntl is None:
        with exclusive(folder / LOCK, wait=False):
            yield
        return
    try:
        free = try_lock(stream)
    except OSError as error:
        free = True
        log.warning("nothing keeps another run out of this folder: no locks (%s)", error)
    if not free:
        raise InputError(folder, "folder", "another run that writes there", "a free one")
    yield


def log_start(log: logging.Logger, case: "Case", stored: Any) -> None:
    """The first lines of a run: versions, case, and where it starts."""
    log.info(
        "fvcollapse %s, Python %s, %s", __version__, platform.python_version(), platform.machine()
    )
    log.info("case\n%s", case.to_toml())
    if stored is None:
        log.info("start from t = 0")
        return
    log.info("resumed from t = %.6f s, step %d", stored.state.time, stored.state.step)
    if stored.code_version != __version__:
        log.warning("the checkpoint was written by version %s", stored.code_version)


def tell(log: logging.Logger, message: str) -> None:
    """Write a warning to the log and to stderr."""
    log.warning("%s", message)
    print(message, file=sys.stderr)


def tell_once(log: logging.Logger, message: str) -> None:
    """Warn in the log and on the terminal, once in a process."""
    if message not in SAID:
        SAID.add(message)
        tell(log, message)
