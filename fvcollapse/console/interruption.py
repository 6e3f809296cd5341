"""What Ctrl-C, SIGTERM and SIGHUP do: nothing that is worth keeping is lost, and the exit status says which.

There are three states of a process.

- Nothing is worth keeping (imports, reading, drawing): a signal ends the process at once, with one
  word on stderr. Files are replaced atomically, so none is left half written (`ended_at_once`).
- A run is marching, or other processes compute for this one: the signal is noted and heeded at the
  end of the step (`deferred_interrupt`). A step that does not end within `GRACE`, such as one that
  still compiles, is cut short. A second Ctrl-C cuts it short at once.
- Processes must be ended but nothing saved: the signal is raised where it comes
  (`raised_interrupt`).

The exit status is 128 plus the number of the signal: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP
(the terminal was closed). SIGTERM and SIGHUP that were ignored when the process began (`nohup`) stay
ignored. SIGINT does not: a shell script ignores it for what it starts in the background.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from math import inf
from typing import Any

GRACE = 3.0  # s that a step has to end by itself
ASKED = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
FROM_OUTSIDE = tuple(number for number in ASKED if number != signal.SIGINT)
DEAF: set[int] = set()  # signals that this process leaves to the one that started it


class Interrupted(KeyboardInterrupt):
    """A signal asked the process to end.

    Parameters
    ----------
    number : int
        Of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = int(number)


def exit_status(error: BaseException) -> int:
    """Exit status after a `KeyboardInterrupt`: 128 plus the number of its signal."""
    return 128 + getattr(error, "number", int(signal.SIGINT))


@contextmanager
def handled(
    handle: Callable[[int, Any], object], numbers: tuple[int, ...] = ASKED
) -> Iterator[bool]:
    """Let `handle(number, frame)` answer signals that are not ignored; in the main thread only.

    Yields whether it does.
    """
    if threading.current_thread() is not threading.main_thread():
        yield False
        return
    before = {number: signal.getsignal(number) for number in numbers if is_answered(number)}
    for number in before:
        signal.signal(number, handle)
    try:
        yield True
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def is_answered(number: int) -> bool:
    """Whether this process answers a signal."""
    handler = signal.getsignal(number)
    if handler is None or number in DEAF:  # None: somebody answers it who is not of Python
        return False
    return handler != signal.SIG_IGN or number == signal.SIGINT


def leave_to_parent(numbers: Iterable[int]) -> None:
    """Ignore signals in this process from now on, whatever it does."""
    DEAF.update(numbers)
    for number in numbers:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def deferred_interrupt(grace: float = GRACE) -> Iterator[Callable[[], int]]:
    """Let Ctrl-C, SIGTERM and SIGHUP wait until they are asked for.

    Parameters
    ----------
    grace : float
        Time [s] after which a signal that nobody asked for is raised wherever the process is; inf:
        never.

    Yields
    ------
    function
        Returns the number of the signal that came, or 0.

    Raises
    ------
    Interrupted
        At a second Ctrl-C, after `grace`, and at the end if a signal came that nobody asked for.
    """
    came, heard = [], []

    def handle(number, frame):
        came.append(number)
        if len(came) == 1:
            alarm.start()
        elif number == signal.SIGINT:  # batch systems send SIGTERM several times
            heard.append(number)
            raise Interrupted(number)

    def interrupted():
        if came and not heard:
            heard.extend(came)
            alarm.stop()
        return came[0] if came else 0

    def cut_short(number, frame):
        if not heard:
            heard.extend(came)
            raise Interrupted(came[0])

    alarm = Alarm(grace)
    with handled(handle) as here, alarm.answered_by(cut_short if here else None):
        yield interrupted
    if came and not heard:
        raise Interrupted(came[0])


class Alarm:
    """The timer of the system, where there is one (not on Windows)."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds

    def start(self) -> None:
        """Let SIGALRM come in `seconds`."""
        if hasattr(signal, "setitimer") and self.seconds < inf:
            signal.setitimer(signal.ITIMER_REAL, self.seconds)

    def stop(self) -> None:
        """Let it not come."""
        if hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, 0.0)

    @contextmanager
    def answered_by(self, handle: Callable[[int, Any], object] | None) -> Iterator[None]:
        """Let `handle` answer SIGALRM; None: nobody."""
        if handle is None or not hasattr(signal, "SIGALRM"):
            yield
            return
        before = signal.signal(signal.SIGALRM, handle)
        try:
            yield
        finally:
            self.stop()
            signal.signal(signal.SIGALRM, before)


@contextmanager
def raised_interrupt() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end what goes on here as Ctrl-C does."""
    with handled(raise_interrupted, FROM_OUTSIDE):
        yield


def raise_interrupted(number: int, frame: object) -> None:
    """Raise `Interrupted`; a handler."""
    raise Interrupted(number)


@contextmanager
def ended_at_once() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end the process at once, with one word and the status of the signal.

    Ctrl-C raises KeyboardInterrupt, as ever.
    """
    with (
        handled(end_at_once, FROM_OUTSIDE),
        handled(signal.default_int_handler, (signal.SIGINT,)),
    ):
        yield


def end_at_once(number: int, frame: object) -> None:
    """End this process as the signal itself would; a handler."""
    with suppress(OSError, ValueError, RuntimeError):  # what was printed, as far as it can be
        sys.stdout.flush()
    with suppress(OSError):
        os.write(2, f"ended by {signal.Signals(number).name}\n".encode())
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
