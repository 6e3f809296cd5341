"""Many calls at once: outcomes, threads, workers that die, folders that are held."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from pathlib import Path

import fake_tasks
import pytest
from fake_terminal import Terminal

from fvcollapse.errors import FvcollapseError, InputError, NumericalError, OutputError
from fvcollapse.files.locks import exclusive
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.studies import workers
from fvcollapse.studies.workers import ATTEMPTS, run_all

ROOT = Path(__file__).resolve().parents[1]


def outcomes(task, calls, **options):
    found = {}
    run_all(task, calls, found.__setitem__, **options)
    return found


# -- outcomes ------------------------------------------------------------------------------------


def test_every_call_is_made_once():
    calls = {n: (n,) for n in range(7)}
    assert outcomes(fake_tasks.double, calls) == {n: 2 * n for n in range(7)}


def test_one_worker_is_this_process_in_order():
    found = outcomes(fake_tasks.threads_and_process, {"b": (0,), "a": (0,)})
    assert list(found) == ["b", "a"]
    assert {process for _, process in found.values()} == {os.getpid()}


def test_workers_are_other_processes_with_one_thread_each(monkeypatch):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "7")
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    found = outcomes(fake_tasks.threads_and_process, {n: (0.5,) for n in range(4)}, workers=2)
    threads = [number for numbers, _ in found.values() for number in numbers]
    assert threads
    assert set(threads) == {1}
    processes = {process for _, process in found.values()}
    assert len(processes) == 2
    assert os.getpid() not in processes
    assert os.environ["OPENBLAS_NUM_THREADS"] == "7"
    assert "OMP_NUM_THREADS" not in os.environ


@pytest.mark.parametrize("count", [1, 2])
def test_failures_are_outcomes_and_the_others_go_on(count):
    calls = {name: (name,) for name in ("numerical", "fine", "input", "well")}
    found = outcomes(fake_tasks.fail, calls, workers=count)
    assert isinstance(found["numerical"], NumericalError)
    assert found["numerical"].time == 0.5
    assert isinstance(found["input"], InputError)
    assert (found["fine"], found["well"]) == ("fine", "well")


def test_a_bug_is_raised():
    with pytest.raises(ZeroDivisionError):
        outcomes(fake_tasks.fail, {"bug": ("bug",), "fine": ("fine",)})


@pytest.mark.parametrize("count", [1, 2])
def test_what_is_raised_here_ends_the_rest(tmp_path, count):
    def finished(name, outcome):
        raise OutputError("table", "disk full")

    calls = {f"{n}": (tmp_path, f"{n}", 0) for n in range(50)}
    with pytest.raises(OutputError):
        run_all(fake_tasks.die_once, calls, finished, workers=count)
    assert len((tmp_path / "ends").read_text().split()) < 10


def test_number_of_workers_is_checked():
    with pytest.raises(InputError, match=r"--workers: found 0"):
        outcomes(fake_tasks.double, {1: (1,)}, workers=0)


def test_nothing_to_do():
    assert outcomes(fake_tasks.double, {}, workers=2) == {}


def test_bar_tells_runs_done_and_time_left(monkeypatch):
    for quiet in (False, True):
        monkeypatch.setattr(sys, "stderr", Terminal())
        outcomes(fake_tasks.threads_and_process, {n: (0.15,) for n in range(3)}, quiet=quiet)
        shown = sys.stderr.getvalue()
        assert ("3/3" in shown) == ("run/s" in shown) == (not quiet)


# -- workers that die ----------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_call_of_a_dead_worker_is_made_again_and_no_other(tmp_path, number):
    calls = {f"{n}": (tmp_path, f"{n}", number if n == 2 else 0) for n in range(6)}
    found = outcomes(fake_tasks.die_once, calls, workers=2)
    assert found == {name: name for name in calls}
    ends = Counter((tmp_path / "ends").read_text().split())
    assert ends == Counter(list(calls))  # nothing lost, nothing finished twice
    started = Counter((tmp_path / "calls").read_text().split())
    assert started["2"] == 2
    assert sum(started.values()) <= len(calls) + 2  # the one beside it may have been cut short


def test_call_that_kills_every_worker_is_given_up(tmp_path):
    calls = {"bad": ()}
    found = outcomes(fake_tasks.die_always, calls, workers=2)
    assert isinstance(found["bad"], NumericalError)
    assert f"died {ATTEMPTS} times" in str(found["bad"])


def test_sigterm_ends_the_study(tmp_path):
    calls = {f"{n}": (tmp_path, f"{n}", 0) for n in range(200)}

    def finished(name, outcome):
        os.kill(os.getpid(), signal.SIGTERM)

    with pytest.raises(KeyboardInterrupt):
        run_all(fake_tasks.die_once, calls, finished, workers=2)
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    parent = multiprocessing.get_context("spawn").Process(
        target=fake_tasks.run_two_sleepers, args=(tmp_path,)
    )
    parent.start()
    wait_for(lambda: len(list(tmp_path.iterdir())) == 2)
    parent.kill()
    parent.join()
    children = [int(path.name) for path in tmp_path.iterdir()]
    wait_for(lambda: not any(map(is_alive, children)))


def wait_for(condition):
    end = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def is_alive(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    status = Path(f"/proc/{process}/stat")  # a zombie is dead, whoever has to collect it
    return not (status.exists() and status.read_text().rpartition(")")[2].split()[0] == "Z")


# -- folders -------------------------------------------------------------------------------------


def test_lock_is_held_by_one_at_a_time(tmp_path):
    inside, most = [], []

    def enter():
        with exclusive(tmp_path / "deep" / "lock"):
            inside.append(1)
            most.append(len(inside))
            time.sleep(0.02)
            inside.pop()

    threads = [threading.Thread(target=enter) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1] * 5


def test_lock_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written"), exclusive(tmp_path / "file/lock"):
        pass


# -- the scheduler -------------------------------------------------------------------------------


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense:::", ""])
def test_scheduler_that_is_not_there_is_one_line(monkeypatch, address):
    monkeypatch.setattr(workers, "CONNECT", 0.5)
    with pytest.raises(InputError, match=r"--scheduler: found .*allowed: the address") as caught:
        outcomes(fake_tasks.double, {1: (1,)}, scheduler=address)
    assert "\n" not in str(caught.value)


def test_missing_package_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"fvcollapse\[cluster\]"):
        outcomes(fake_tasks.double, {1: (1,)}, scheduler="tcp://127.0.0.1:9")


def test_worker_with_another_solver_is_refused():
    with pytest.raises(FvcollapseError, match=r"a worker with solver .*; allowed: .* 9.9"):
        workers.call("9.9", fake_tasks.double, (1,))
    assert workers.call(solver_version(), fake_tasks.double, (1,)) == 2


LOST = """
import sys, threading, time
import h5py
from h5py._objects import phil
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.studies.workers import call_in_a_thread

open_file = h5py.File(sys.argv[1], "w")  # freed as the interpreter ends, under the lock of HDF5
held = threading.Event()

def write():
    with phil:
        held.set()
        time.sleep(120.0)

threading.Thread(target=call_in_a_thread, args=(solver_version(), write, ()), daemon=True).start()
held.wait()
"""


def test_a_worker_that_is_left_in_the_midst_of_a_call_ends(tmp_path):
    """A thread that is ended inside HDF5 keeps its lock, for which the end of the interpreter would wait for ever."""
    command = [sys.executable, "-c", LOST, str(tmp_path / "file.h5")]
    with subprocess.Popen(command, cwd=ROOT) as program:
        try:
            assert program.wait(60.0) == 1
        finally:
            program.kill()
