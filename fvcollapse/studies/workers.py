"""Many runs at once: in processes of this machine, or on the workers of a Dask cluster.

Both are used through the interface of `concurrent.futures`. A call whose worker died is made again.
Calls that run a case can be repeated: a finished run is not run again, and an interrupted run
continues from its checkpoint (`run_member`). The workers of a cluster must see the folders of this
machine (a shared file system) and have the same solver.
"""

import asyncio
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections import Counter, deque
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from math import inf

from tqdm import tqdm

from fvcollapse.errors import FvcollapseError, InputError, NumericalError
from fvcollapse.output.fingerprint import solver_version

ATTEMPTS = 3  # a run whose worker dies this often is given up
DEAD = object()  # the outcome of a call whose worker died, or was told to stop
CONNECT = 10.0  # s to wait for a scheduler
TO_SAVE = 30.0  # s that a run has to finish its step and save; a second signal stops it at once
# libraries that start threads of their own read these when they are loaded
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def run_all(task, calls, finished, workers=1, scheduler=None, quiet=True):
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
        On Ctrl-C and SIGTERM, after the runs of this machine have saved their state.
    """
    refuse_workers(workers)
    queue, deaths = deque(calls), Counter()
    with runs_bar(len(calls), quiet) as bar:

        def end(name, outcome):
            """Report an outcome, or queue the call again if its worker died."""
            if outcome is DEAD:
                deaths[name] += 1
                if deaths[name] < ATTEMPTS:
                    queue.append(name)
                    return
                outcome = NumericalError(f"the worker died {ATTEMPTS} times (memory?)")
            bar.update()
            finished(name, outcome)

        while queue:
            with executor(workers, scheduler) as (pool, width):
                drain(pool, width, task, calls, queue, end)


def refuse_workers(workers):
    """Refuse a number of processes below one."""
    if workers < 1:
        raise InputError("command line", "--workers", f"{workers}", "a whole number >= 1")


def drain(pool, width, task, calls, queue, end):
    """Make the calls of the queue, `width` at a time; return early when the pool is broken."""
    running = {}
    while queue or running:
        try:
            while queue and len(running) < width:
                future = pool.submit(call, solver_version(), task, calls[queue[0]])
                running[future] = queue.popleft()
        except BrokenExecutor:  # what runs in it ends as DEAD
            width = 0
        if not running:
            return
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            end(running.pop(future), outcome_of(future))


def call(version, task, arguments):
    """Make one call inside a worker."""
    if solver_version() != version:
        found = f"a worker with solver {solver_version()}"
        raise InputError("command line", "--scheduler", found, f"workers with solver {version}")
    return task(*arguments)


def outcome_of(future):
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


def is_named(error, name):
    """Whether an error has a type of this name; its package need not be installed."""
    return type(error).__name__ == name


def runs_bar(total, quiet):
    """Bar over the runs, with ETA, on stderr."""
    return tqdm(
        total=total,
        unit="run",
        file=sys.stderr,
        disable=quiet or not sys.stderr.isatty(),
        dynamic_ncols=True,
    )


# -- where the calls are made --------------------------------------------------------------------


@contextmanager
def executor(workers, scheduler):
    """(executor, number of calls that it may hold) for a number of processes or a cluster."""
    if scheduler is not None:
        with cluster(scheduler) as client:
            yield client.get_executor(pure=False), inf
    elif workers == 1:
        yield InThisProcess(), 1
    else:
        with processes(workers) as pool:
            yield pool, workers


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
def processes(workers):
    """A pool of processes that compute with one thread each."""
    before = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")
    with one_thread(), interrupted_by_sigterm():
        pool = ProcessPoolExecutor(workers, context, begin_worker)
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in set(multiprocessing.active_children()) - before:
                child.terminate()  # a run that is marching saves its state first
            raise
        finally:
            pool.shutdown()


@contextmanager
def cluster(address):
    """A client of a Dask scheduler."""
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
    with client, interrupted_by_sigterm():
        if not client.scheduler_info()["workers"]:
            print(f"{address} has no workers yet: waiting for them", file=sys.stderr)
        yield client


@contextmanager
def one_thread():
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


@contextmanager
def interrupted_by_sigterm():
    """Let SIGTERM interrupt this process as Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def interrupt(number, frame):
    """Interrupt this process: the handler of SIGTERM."""
    raise KeyboardInterrupt


def begin_worker():
    """Shield a worker from Ctrl-C, and end it with its parent.

    The parent sends it one signal, after which it saves its run and ends.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if os.name == "posix":
        os.setpgid(0, 0)  # a marching run has its own handler of SIGINT, which this keeps idle
    threading.Thread(target=end_with_the_parent, daemon=True).start()


def end_with_the_parent():
    """Wait for the death of the parent, then let a marching run save its state and end the worker.

    A worker without a parent would wait for its next call for ever.
    """
    multiprocessing.parent_process().join()
    while True:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(TO_SAVE)
