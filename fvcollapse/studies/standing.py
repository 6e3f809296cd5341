"""Workers that stay while a command makes several rounds of calls.

A process takes a second to start and to load the kernels. A diagnosis asks for runs five times, and each round
would pay for it again.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from math import inf
from typing import Any

from fvcollapse.console.interruption import deferred_interrupt, raised_interrupt
from fvcollapse.studies.pool import ProcessPool
from fvcollapse.studies.workers import Place, call, executor, make_calls, one_thread, refuse_workers


class StandingWorkers:
    """The workers of a command that makes several rounds of calls; a context manager.

    The processes of this machine start with the first round that needs them and end with the block. Between two
    rounds SIGTERM and SIGHUP are raised where they come, as Ctrl-C is, so that the block ends the processes. In a
    round they are heeded as in `workers.run_all`. The workers of a cluster stay anyway.

    Parameters
    ----------
    workers : int
        Processes; 1 = this process.
    scheduler : str, optional
        Address of a Dask scheduler, whose workers are used instead.

    Raises
    ------
    InputError
        Fewer than one worker.
    """

    def __init__(self, workers: int = 1, scheduler: str | None = None) -> None:
        refuse_workers(workers)
        self.workers, self.scheduler = workers, scheduler
        self.pool: Any = None
        self.until_the_end = ExitStack()

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        with self.until_the_end, deferred_interrupt(inf):
            if self.pool is not None:
                self.end_pool(cut_short=kind is not None)

    def run_all(self, task: Callable, calls: dict, finished: Callable) -> None:
        """Call `task(*arguments)` for every {name: arguments}; as `workers.run_all`, without a bar."""
        if calls:
            with self.place() as place:
                make_calls(place, task, calls, finished)

    @contextmanager
    def place(self) -> Iterator:
        """The `Place` of one round. What ends the round by an exception ends the processes too."""
        if self.scheduler is not None or self.workers == 1:
            with executor(self.workers, self.scheduler) as place:
                yield place
            return
        self.start_pool()
        with deferred_interrupt(inf) as interrupted:
            try:
                yield Place(self.pool, self.workers, interrupted, call)
            except BaseException:
                self.end_pool(cut_short=True)
                raise

    def submit(self, task: Callable, *arguments: Any) -> Any:
        """A future of `task(*arguments)`, made beside what this process does; None where it has no others."""
        if self.scheduler is not None or self.workers == 1:
            return None
        self.start_pool()
        return self.pool.submit(task, *arguments)

    def start_pool(self) -> None:
        """Let there be a pool; its processes start when there are calls for them."""
        if self.pool is None:
            self.until_the_end.enter_context(raised_interrupt())
            self.until_the_end.enter_context(one_thread())
            self.pool = ProcessPool(self.workers)

    def end_pool(self, cut_short: bool) -> None:
        """End the processes; those that are marching save their state first."""
        pool, self.pool = self.pool, None
        if cut_short:
            pool.stop()
        else:
            pool.shutdown()
