"""Log file, progress bar and interruption of a run."""

import logging
import platform
import shutil
import signal
import sys
import threading
from contextlib import contextmanager, suppress

from tqdm import tqdm

try:
    import fcntl
except ImportError:  # not on Windows, where an open log cannot be shared anyway
    fcntl = None

from fvcollapse.errors import InputError, OutputError
from fvcollapse.version import __version__

LOG = "run.log"


class LogFile(logging.FileHandler):
    """A log file that ignores a full disk, which is reported when the results are saved."""

    def handleError(self, record):  # noqa: N802 (name fixed by logging)
        """Drop the record."""

    def close(self):
        """Close the file; records that could not be written are lost."""
        with suppress(OSError):
            super().close()


@contextmanager
def run_log(folder):
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
    try:
        if fcntl is not None:
            fcntl.flock(handler.stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        handler.close()
        raise InputError(folder, "folder", "another run that writes there", "a free one") from None
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    log = logging.Logger("fvcollapse", logging.INFO)  # not registered: one per run
    log.addHandler(handler)
    try:
        yield log
    finally:
        handler.close()


def log_start(log, case, stored):
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


def progress_bar(case, start, quiet):
    """Bar over the simulated time with step, dt and ETA, on stderr."""
    layout = "{percentage:3.0f}% |{bar}| t = {n:.3f}/{total:.3f} s [{elapsed}<{remaining}{postfix}]"
    terminal = shutil.get_terminal_size()  # never zero, which tqdm would take for no room
    return tqdm(
        total=max(case.time.end, start),
        initial=start,
        file=sys.stderr,
        bar_format=layout,
        ncols=terminal.columns,
        nrows=terminal.lines,
        leave=None,  # a bar below that of several runs is removed at its end
        disable=quiet or not sys.stderr.isatty(),
    )


@contextmanager
def deferred_interrupt():
    """Defer Ctrl-C and SIGTERM to the end of the step.

    Yields a function that returns whether a signal has arrived. A second signal stops at once and
    leaves the last checkpoint.
    """
    came = []

    def handle(number, frame):
        if came:
            raise KeyboardInterrupt
        came.append(number)

    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: bool(came)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
