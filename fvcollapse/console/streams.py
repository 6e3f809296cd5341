"""What is printed: a place that is closed, full or cannot show a letter stops no command.

A reader that has seen enough (`| head`) and a stream that was closed (`>&-`) are no errors: what would
be printed further is dropped. A stream that cannot take what is printed (`> /dev/full`) is told in one
line at the end, with exit status 1 where there was none. Letters that the encoding of the stream does
not have are written as their code.
"""

import codecs
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from fvcollapse.errors import OutputError

LETTERS = "fvcollapse-letters"  # name of the way in which unknown letters are written


def write_code(error: UnicodeError) -> tuple[str | bytes, int]:
    """Bytes of a file name as they are, other letters as their code; a handler of codecs."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    found = error.object[error.start]
    if "\udc80" <= found <= "\udcff":  # a byte of a name that is no text here
        return bytes([ord(found) - 0xDC00]), error.start + 1
    return found.encode("ascii", "backslashreplace").decode(), error.start + 1


codecs.register_error(LETTERS, write_code)


class Guarded:
    """A stream that never fails; the first failure is kept in `problem`.

    Parameters
    ----------
    stream : text stream
    """

    def __init__(self, stream: Any) -> None:
        self.stream, self.dropped = stream, False
        self.problem: OSError | None = None

    def __getattr__(self, name):
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        """Write, or drop the text once the stream has failed."""
        if not self.dropped:
            self.attempt(self.stream.write, text)
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def flush(self) -> None:
        """Write what waits to be written."""
        if not self.dropped:
            self.attempt(self.stream.flush)

    def attempt(self, action: Callable, *arguments: object) -> None:
        """Do it; after a failure everything is dropped, also what waits in the stream itself."""
        try:
            action(*arguments)
        except BrokenPipeError:  # the reader has seen enough
            self.drop()
        except OSError as error:
            self.problem = error
            self.drop()

    def drop(self) -> None:
        """Send what is still to come nowhere."""
        self.dropped = True
        with suppress(OSError, ValueError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.stream.fileno())
            os.close(nowhere)


@contextmanager
def guarded_streams() -> Iterator[Callable[[int], int]]:
    """Guard stdout and stderr while a command runs.

    Yields
    ------
    function
        status -> status: that of the command, or 1 where it would be 0 and stdout took not all of it,
        which is then told.
    """
    occupy_closed_handles()
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (Guarded(opened(stream)) for stream in before)

    def final(status):
        sys.stdout.flush()
        if sys.stdout.problem is not None:
            print(OutputError("stdout", sys.stdout.problem, running=True), file=sys.stderr)
            status = status or 1
        sys.stderr.flush()
        return status

    try:
        yield final
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        sys.stdout, sys.stderr = before


def occupy_closed_handles() -> None:
    """Open the first three handles that are closed: a result must not become the standard output."""
    for handle in range(3):
        try:
            os.fstat(handle)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest that is free


def opened(stream: Any) -> Any:
    """The stream, with a way to write every letter; one that goes nowhere for one that is closed."""
    if stream is None:
        return open(os.devnull, "w", encoding="utf-8", errors=LETTERS)
    if hasattr(stream, "reconfigure"):
        stream.reconfigure(errors=LETTERS)
    return stream
