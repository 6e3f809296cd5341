"""Calls for workers to make; here, so that worker processes can import them."""

import os
import signal
import time
from functools import partial
from pathlib import Path
from types import SimpleNamespace

from fvcollapse.errors import InputError, NumericalError


def double(value):
    return 2 * value


def threads_and_process(pause):
    """Number of threads of the linear algebra, and the process."""
    import numpy as np
    from threadpoolctl import threadpool_info

    time.sleep(pause)
    np.linalg.solve(np.eye(3), np.ones(3))
    return [pool["num_threads"] for pool in threadpool_info()], os.getpid()


def process_after(pause):
    """The process that makes the call, after a pause [s]."""
    time.sleep(pause)
    return os.getpid()


def fail(kind):
    if kind == "numerical":
        raise NumericalError("the domain is full", "at x = 1 m", 0.5)
    if kind == "input":
        raise InputError("case.toml", "time.end", "1", "2")
    if kind == "bug":
        raise ZeroDivisionError("a bug")
    return kind


def die_once(folder, name, number):
    """Kill the own process at the first call of this name; tell of every call, and of its end.

    As a run in its folder, a call that has ended is not made again.
    """
    folder = Path(folder)
    if name in done(folder):
        return name
    with (folder / "calls").open("a") as file:
        file.write(f"{name}\n")
    if number and not (folder / f"{name}.died").exists():
        (folder / f"{name}.died").touch()
        os.kill(os.getpid(), number)
        time.sleep(30.0)  # until the signal is here
    time.sleep(0.05)
    with (folder / "ends").open("a") as file:
        file.write(f"{name}\n")
    return name


def tell_process_and_sleep(folder):
    (Path(folder) / f"{os.getpid()}").touch()
    time.sleep(120.0)


def run_two_sleepers(folder):
    from fvcollapse.studies.workers import run_all

    calls = {n: (folder,) for n in range(2)}
    run_all(tell_process_and_sleep, calls, lambda name, outcome: None, workers=2)


def done(folder):
    """The names that have ended."""
    path = folder / "ends"
    return path.read_text().split() if path.exists() else []


def die_always():
    os.kill(os.getpid(), signal.SIGKILL)


def checkpoint_often():
    """Let this process write a checkpoint every 0.3 s."""
    from fvcollapse.output import keeper
    from fvcollapse.output import run as output

    output.run_case = partial(output.run_case, checkpoint_interval=0.3)
    output.CHECKPOINT_INTERVAL = 0.3
    keeper.SAVING_SHARE = 1.0


def run_with_many_checkpoints(case, folder):
    """`run_member`; tells in which process it runs."""
    from fvcollapse.studies import members

    checkpoint_often()
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "processes").open("a") as file:
        file.write(f"{os.getpid()}\n")
    members.run_member(case, folder)
    return folder.name


def fill_cache(folder, cases):
    """Run all cases into a cache; tell the log of every run before its folder goes."""
    import shutil

    from fvcollapse.studies import cache

    def tell_and_remove(work, ignore_errors):
        path = Path(work) / "run.log"
        if path.exists():
            with (Path(folder) / "logs").open("a") as file:
                file.write(path.read_text())
        remove(work, ignore_errors)

    remove = shutil.rmtree
    cache.shutil = SimpleNamespace(rmtree=tell_and_remove)
    checkpoint_often()
    cache.RunCache(Path(folder)).run_all(cases)


def march(folder, seconds):
    """As a run: tell of the start, march, save when a signal is heeded."""
    from fvcollapse.console.interruption import Interrupted, deferred_interrupt

    folder = Path(folder)
    (folder / f"{os.getpid()}.started").touch()
    end = time.monotonic() + seconds
    with deferred_interrupt() as interrupted:
        while time.monotonic() < end:
            time.sleep(0.02)
            if number := interrupted():
                time.sleep(0.2)
                (folder / f"{os.getpid()}.saved").touch()
                raise Interrupted(number)


def study_with_an_idle_worker(folder):
    """Exit status of a study on two workers, of which one soon has nothing more to do."""
    from fvcollapse.console.interruption import exit_status
    from fvcollapse.studies.workers import run_all

    folder = Path(folder)
    calls = {"long": (folder, 120.0), "short": (folder, 0.0)}
    try:
        run_all(march, calls, lambda name, outcome: (folder / f"{name}.done").touch(), workers=2)
    except KeyboardInterrupt as error:
        return exit_status(error)
    return 0
