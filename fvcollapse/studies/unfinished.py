"""A worker of a cluster that has lost its scheduler ends, although a call is unfinished.

Dask makes calls in daemon threads. A worker that has lost its scheduler ends in the midst of one. If the thread is
inside HDF5 then, the interpreter waits for the lock of that library for ever as it ends, and the run keeps the lock of
its folder.
"""

import atexit
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

UNFINISHED: set[object] = set()  # one object for each call that goes on
CHANGES = threading.Lock()  # of the handler and of the set


@contextmanager
def until_the_end() -> Iterator[None]:
    """While a call goes on, this process ends without cleaning up, with exit status 1.

    What is written atomically, such as checkpoints, is whole; handlers of `atexit` registered before do not run. A call
    that begins while the interpreter is ending already is not covered.
    """
    this = object()
    with CHANGES:
        if not UNFINISHED:
            atexit.unregister(end_at_once)
            atexit.register(end_at_once)
        UNFINISHED.add(this)
    try:
        yield
    finally:
        with CHANGES:
            UNFINISHED.discard(this)


def end_at_once() -> None:
    """End this process if a call goes on."""
    if not UNFINISHED:
        return
    try:
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):
                stream.flush()
    finally:
        os._exit(1)
