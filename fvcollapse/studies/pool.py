"""Processes of this machine that make calls, of which any may be killed at any instant.

Every process has a pipe of its own to this one, and a thread here that waits for its answer. Nothing
is shared between the processes, so that one that dies, at whatever instant, takes nothing with it that
another one waits for: its pipe ends, and its call ends as `BrokenExecutor`.

Two executors were tried in its place. `concurrent.futures.ProcessPoolExecutor` has one queue for all
processes, of which an idle one holds the lock; SIGTERM ends it there, and the others, and with them
this process, wait for that lock for ever. `loky` does not hang, but answers the death of any process,
and `shutdown(kill_workers=True)`, with SIGKILL for all others within 0.1 s: a run that is marching
there cannot save its state, which SIGTERM and Ctrl-C are to leave.
"""

import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections.abc import Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing.reduction import ForkingPickler
from queue import Empty, SimpleQueue
from typing import Any

from fvcollapse.console.interruption import leave_to_parent
from fvcollapse.output.compilation import FIRST, HALF, SECOND

TO_SAVE = 30.0  # s that a run has to finish its step and save; a second signal stops it at once
TO_END = 5.0  # s that a process without a call has to end
NOT_TO_WORKERS = tuple(  # signals of the terminal, which reach all of its processes
    getattr(signal, name) for name in ("SIGINT", "SIGHUP") if hasattr(signal, name)
)


class ProcessPool(Executor):
    """An executor of processes, each started when there is a call for it.

    Parameters
    ----------
    workers : int
        Processes at most.
    """

    def __init__(self, workers: int) -> None:
        self.threads = ThreadPoolExecutor(workers, "fvcollapse-worker")
        self.free: SimpleQueue = SimpleQueue()
        self.workers: list = []
        self.stopping, self.lock = False, threading.Lock()

    def submit(self, fn, /, *args, **kwargs):
        """A future of `fn(*args, **kwargs)`; a `BrokenExecutor` if its process dies."""
        return self.threads.submit(self.make, ForkingPickler.dumps((fn, args, kwargs)))

    def make(self, call: Any) -> Any:
        """Let a process make a call; here in a thread."""
        worker = self.free_worker()
        outcome, value = worker.answer(call)  # where it dies, it is not free again
        self.free.put(worker)
        if outcome == RAISED:
            raise value
        return value

    def free_worker(self) -> Any:
        """A living process without a call; a new one if there is none."""
        while True:
            try:
                worker = self.free.get_nowait()
            except Empty:
                return self.start_worker()
            if worker.process.is_alive():  # it may have been killed since its last call
                return worker

    def start_worker(self) -> Any:
        """A new process, unless the pool is about to end."""
        with self.lock:
            if self.stopping:
                raise BrokenExecutor("the pool is stopped")
            worker = Worker(SECOND if len(self.workers) % 2 else FIRST)
            self.workers.append(worker)
            return worker

    def shutdown(self, wait=True, *, cancel_futures=False):
        """Let all calls end, then all processes."""
        self.threads.shutdown(wait=wait, cancel_futures=cancel_futures)
        end_all(self.workers, TO_END)

    def stop(self) -> None:
        """Tell all processes to save and end; drop what has not begun.

        Returns when all are gone: after `TO_SAVE` seconds, or when this is interrupted, they are killed.
        """
        with self.lock:
            self.stopping = True
        self.threads.shutdown(wait=False, cancel_futures=True)
        for worker in self.workers:
            worker.process.terminate()  # a run that is marching saves its state first
        end_all(self.workers, TO_SAVE)
        self.threads.shutdown()


def end_all(workers: Any, patience: float) -> None:
    """Wait for the end of processes, `patience` seconds for all of them, and kill what is left."""
    limit = time.monotonic() + patience
    try:
        for worker in workers:
            worker.leave()
            worker.process.join(max(0.0, limit - time.monotonic()))
    finally:
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join()


# -- on both ends of a pipe ----------------------------------------------------------------------

RETURNED, RAISED = "returned", "raised"


class Worker:
    """A process that makes one call after the other, seen from here.

    `half` says which half of the kernels it compiles first (`output.compilation.HALF`).
    """

    def __init__(self, half: str) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, there = context.Pipe()
        self.process = context.Process(target=work, args=(there, half))
        with blocked(NOT_TO_WORKERS):
            self.process.start()
        there.close()  # the death of the process is the end of the pipe

    def answer(self, call: Any) -> tuple:
        """(`RETURNED` or `RAISED`, value) of a call.

        Raises
        ------
        BrokenExecutor
            The process died, or was told to stop.
        """
        try:
            self.connection.send_bytes(call)
            data = self.connection.recv_bytes()
        except (EOFError, OSError):
            self.process.join()
            message = f"the process ended with status {self.process.exitcode}"
            raise BrokenExecutor(message) from None
        return pickle.loads(data)  # of our own process

    def leave(self) -> None:
        """Let the process end when its call has ended."""
        with suppress(OSError):
            self.connection.send_bytes(b"")


def work(connection: Any, half: str) -> None:
    """Make the calls that come through a pipe until it ends, or until this process is told to stop; see `Worker`."""
    begin_worker()
    os.environ[HALF] = half
    while True:
        try:
            data = connection.recv_bytes()
        except (EOFError, OSError):
            return
        if not data:
            return
        try:
            answer = RETURNED, made(data)
        except KeyboardInterrupt:  # the state is saved; taking the interpreter down takes a second
            sys.stderr.flush()
            os._exit(128 + signal.SIGTERM)
        except Exception as error:
            error.add_note("in a worker:\n" + traceback.format_exc())
            answer = RAISED, error
        with suppress(OSError):  # nobody listens any more
            connection.send_bytes(packed(*answer))


def made(data: bytes) -> Any:
    """What a call returns; its task is imported here."""
    task, arguments, options = pickle.loads(data)  # of the process that started this one
    return task(*arguments, **options)


def packed(outcome: Any, value: Any) -> bytes:
    """An answer as bytes; an error that cannot be packed is told in words."""
    try:
        return bytes(ForkingPickler.dumps((outcome, value)))
    except Exception as error:
        told = RuntimeError(f"{type(value).__name__}: {value} (which cannot be sent: {error})")
        return bytes(ForkingPickler.dumps((RAISED, told)))


@contextmanager
def blocked(numbers: Iterable[int]) -> Iterator[None]:
    """Let the processes that this thread starts begin with these signals blocked."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def begin_worker() -> None:
    """Keep the signals of the terminal from a worker, and end it with its parent.

    It gets one signal, SIGTERM from the parent, that a marching run answers by saving.
    """
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # a signal to the group of the parent is answered by the parent
    leave_to_parent(NOT_TO_WORKERS)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, NOT_TO_WORKERS)
    threading.Thread(target=end_with_the_parent, daemon=True).start()


def end_with_the_parent() -> None:
    """Wait for the death of the parent, then let a marching run save its state and end the worker."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    while True:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(TO_SAVE)
