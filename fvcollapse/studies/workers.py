"""Many runs at once: in processes of this machine, or on the workers of a Dask cluster.

Both are used through the interface of `concurrent.futures`. A call whose worker died is made again.
Calls that run a case can be repeated: a finished run is not run again, and an interrupted run
continues from its checkpoint (`run_member`). The workers of a cluster must see the folders of this
machine (a shared file system) and have the same solver.
"""

import os
import sys
from collections import Counter, deque
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from functools import partial
from math import inf
from typing import Any, NamedTuple

from fvcollapse.console.bars import runs_bar
from fvcollapse.console.interruption import Interrupted, deferred_interrupt, raised_interrupt
from fvcollapse.errors import FvcollapseError, InputError, NumericalError
from fvcollapse.output.compilation import tell_compilation
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.studies.pool import ProcessPool
from fvcollapse.studies.unfinished import until_the_end

ATTEMPTS = 3  # a run whose worker dies this often is given up
DEAD = object()  # the outcome of a call whose worker died, or was told to stop
CONNECT = 10.0  # s to wait for a scheduler
POLL = 0.1  # s between two looks for a signal
# libraries that start threads of their own read these when they are loaded
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


class Resources(NamedTuple):
    """Where many runs are made: `workers`, `scheduler` and `quiet` of `run_all`."""

    workers: int = 1
    scheduler: str | None = None
    quiet: bool = True


HERE = Resources()  # one after the other, in this process


def run_all(
    task: Callable,
    calls: dict,
    finished: Callable,
    workers: int = 1,
    scheduler: str | None = None,
    quiet: bool = True,
) -> None:
    """Call `task(*arguments)` for every {name: arguments}, several at a time.

    Parameters
    ----------
    task : function
        At the top of a module, so that a worker can import it.
    calls : dict
        Started in this order.
    finished : function
        Called here with a name and the outcome as each ends: what the task returned, or the
        `FvcollapseError` that it raised. What `finished` raises ends the rest.
    workers : int
        Processes; 1 = this process.
    scheduler : str, optional
        Address of a Dask scheduler; then its workers are used, however many they are.
    quiet : bool
        No progress bar (there is none either when stderr is not a terminal).

    Raises
    ------
    InputError
        No such scheduler, a worker with another solver, fewer than one worker.
    NumericalError
        The scheduler was lost.
    KeyboardInterrupt
        On Ctrl-C, SIGTERM and SIGHUP, after the runs of this machine have saved their state.
    """
    refuse_workers(workers)
    if calls and scheduler is None:
        tell_compilation(quiet)
    with runs_bar(len(calls), quiet) as bar:

        def end(name, outcome):
            """Count a call that has ended."""
            bar.update()
            finished(name, outcome)

        with executor(workers, scheduler) as place:
            make_calls(place, task, calls, end)


def make_calls(place: "Place", task: Callable, calls: dict, finished: Callable) -> None:
    """Call `task(*arguments)` for every {name: arguments} at a `Place`; see `run_all`."""
    queue, deaths = deque(calls), Counter()  # type: ignore[var-annotated]

    def end(name, outcome):
        """Report an outcome, or queue the call again if its worker died."""
        if outcome is DEAD:
            deaths[name] += 1
            if deaths[name] < ATTEMPTS:
                queue.append(name)
                return
            outcome = NumericalError(f"the worker died {ATTEMPTS} times (memory?)")
        finished(name, outcome)

    drain(place, partial(place.call, solver_version(), task), calls, queue, end)


def refuse_workers(workers: int) -> None:
    """Refuse a number of processes below one."""
    if workers < 1:
        raise InputError("command line", "--workers", f"{workers}", "a whole number >= 1")


class Place(NamedTuple):
    """Where and how calls are made.

    Attributes
    ----------
    pool : Executor
    width : float
        How many calls it may hold.
    interrupted : function
        () -> number of the signal that came, or 0.
    call : function
        Makes one call inside a worker; see `call`.
    """

    pool: Executor
    width: float
    interrupted: Callable[[], int]
    call: Callable


def drain(place: Place, task: Callable, calls: dict, queue: Any, end: Callable) -> Any:
    """Make the calls of the queue, as many at a time as the place holds; `end` gets each outcome."""
    running: dict[Future, Any] = {}
    while queue or running:
        while queue and len(running) < place.width:
            future = place.pool.submit(task, calls[queue[0]])
            running[future] = queue.popleft()
        for future in wait(running, POLL, FIRST_COMPLETED).done:
            end(running.pop(future), outcome_of(future))
        if number := place.interrupted():
            raise Interrupted(number)


def call(version: str, task: Callable, arguments: tuple) -> Any:
    """Make one call inside a worker."""
    if solver_version() != version:
        found = f"a worker with solver {solver_version()}"
        raise InputError("command line", "--scheduler", found, f"workers with solver {version}")
    return task(*arguments)


def call_in_a_thread(version: str, task: Callable, arguments: tuple) -> Any:
    """Make one call inside a worker of a cluster, which makes it in a daemon thread."""
    with until_the_end():
        return call(version, task, arguments)


def outcome_of(future: Future) -> Any:
    """What a call returned, its `FvcollapseError`, or `DEAD`; other errors are raised."""
    try:
        error = future.exception()
    except CancelledError:  # nothing here cancels: Dask does when it loses the scheduler
        lost = "the scheduler is gone; what is finished is kept, the same command continues"
        raise NumericalError(lost) from None
    if isinstance(error, FvcollapseError):
        return error
    # KeyboardInterrupt: the worker was told to stop; KilledWorker is the word of Dask
    if isinstance(error, BrokenExecutor | KeyboardInterrupt) or is_named(error, "KilledWorker"):
        return DEAD
    return future.result()


def is_named(error: BaseException | None, name: str) -> bool:
    """Whether an error has a type of this name; its package need not be installed."""
    return type(error).__name__ == name


# -- where the calls are made --------------------------------------------------------------------


@contextmanager
def executor(workers: int, scheduler: str | None) -> Iterator[Place]:
    """The `Place` of processes of this machine, or of a cluster."""
    if scheduler is not None:
        with cluster(scheduler) as client:
            yield Place(client.get_executor(pure=False), inf, no_signal, call_in_a_thread)
    elif workers == 1:
        yield Place(InThisProcess(), 1, no_signal, call)
    else:
        with processes(workers) as (pool, interrupted):
            yield Place(pool, workers, interrupted, call)


def no_signal() -> int:
    """Signals are raised where they come, or heeded by the run that is made."""
    return 0


class InThisProcess(Executor):
    """An executor that makes the call when it is submitted."""

    def submit(self, fn, /, *args, **kwargs):
        """A future that is done."""
        future = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@contextmanager
def processes(workers: int) -> Iterator[tuple]:
    """(pool of processes that compute with one thread each, whether a signal came)."""
    with one_thread(), deferred_interrupt(inf) as interrupted:
        pool = ProcessPool(workers)
        try:
            yield pool, interrupted
        except BaseException:
            pool.stop()
            raise
        pool.shutdown()


@contextmanager
def cluster(address: str) -> Iterator[Any]:
    """A client of a Dask scheduler."""
    import asyncio  # for this alone

    try:
        from distributed import Client
        from distributed.comm import connect
        from distributed.security import Security
    except ImportError:
        found = "no package distributed"
        allowed = 'after pip install "fvcollapse[cluster]"'
        raise InputError("command line", "--scheduler", found, allowed) from None

    async def knock():
        """Connect first without a client: one that fails may hang when it is collected."""
        keys = Security().get_connection_args("client")
        await (await connect(address, timeout=CONNECT, **keys)).close()

    try:
        with ThreadPoolExecutor(1) as thread:  # here an event loop may be running (notebooks)
            thread.submit(asyncio.run, knock()).result()
        client = Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:  # a TimeoutError is an OSError
        found = f"{address!r} ({str(error) or type(error).__name__})"
        allowed = "the address of a running Dask scheduler, such as tcp://host:8786"
        raise InputError("command line", "--scheduler", found, allowed) from None
    with client, raised_interrupt():
        if not client.scheduler_info()["workers"]:
            print(f"{address} has no workers yet: waiting for them", file=sys.stderr)
        yield client


@contextmanager
def one_thread() -> Iterator[None]:
    """Let the processes that start now use one thread each: the runs share the cores."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
