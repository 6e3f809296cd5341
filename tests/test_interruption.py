"""Signals: saved, heeded, not heeded twice; what a study does whose other worker has nothing to do."""

import os
import signal
import threading
import time

import pytest
from fake_simulation import FakeSimulation
from processes import alive, start, wait_for

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.console import interruption
from fvcollapse.console.interruption import Interrupted, deferred_interrupt
from fvcollapse.output import run as output

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
STUDY = (
    "import sys; from fake_tasks import study_with_an_idle_worker as s; sys.exit(s(sys.argv[1]))"
)
SIGNALLED_COMMAND = """
import os, sys
from fvcollapse.commands import keys
from fvcollapse.commands.command_line import main
def signalled(arguments):
    print("before")
    os.kill(os.getpid(), int(sys.argv[1]))
    print("after")
    return 0
keys.execute = signalled
sys.exit(main(["keys"]))
"""


@pytest.mark.parametrize(
    "number", [signal.SIGINT, signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.slow)]
)
def test_study_with_an_idle_worker_saves_and_ends(tmp_path, number):
    """The idle worker must not take with it what the busy one waits for."""
    study, mark = start("-c", STUDY, tmp_path)
    wait_for(lambda: (tmp_path / "short.done").exists() and len(list(tmp_path.iterdir())) == 3)
    time.sleep(0.2)
    begun = time.monotonic()
    study.send_signal(number)
    out, err = study.communicate(timeout=30)
    assert time.monotonic() - begun < 5.0
    assert (study.returncode, out, err) == (128 + number, "", "")
    assert len(list(tmp_path.glob("*.saved"))) == 1
    assert not (tmp_path / "long.done").exists()
    wait_for(lambda: not alive(mark), 5.0)


def test_study_whose_idle_worker_is_killed_goes_on(tmp_path):
    study, mark = start("-c", STUDY, tmp_path)
    wait_for(lambda: (tmp_path / "short.done").exists() and len(list(tmp_path.iterdir())) == 3)
    started = sorted(tmp_path.glob("*.started"), key=lambda path: path.stat().st_mtime_ns)
    workers = {int(path.name.partition(".")[0]) for path in started}
    busy = {process for process in workers if not is_waiting(process)}
    for process in workers - busy:
        os.kill(process, signal.SIGKILL)
    time.sleep(0.5)
    assert study.poll() is None
    study.terminate()
    assert study.communicate(timeout=10) == ("", "")
    assert study.returncode == 143
    assert len(list(tmp_path.glob("*.saved"))) == 1
    wait_for(lambda: not alive(mark), 5.0)


def is_waiting(process):
    """Whether a process reads from its pipe; a marching one sleeps for hundredths of a second."""
    path = f"/proc/{process}/wchan"
    for _ in range(10):
        time.sleep(0.01)
        with open(path) as file:
            if "nanosleep" in file.read():
                return False
    return True


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_command_that_keeps_nothing_ends_at_once_with_a_word(number):
    command, _ = start("-c", SIGNALLED_COMMAND, int(number))
    out, err = command.communicate(timeout=60)
    assert (out, err) == ("before\n", f"ended by {signal.Signals(number).name}\n")
    assert command.returncode == -number  # 128 + number to a shell


def test_hangup_is_ignored_where_it_was_ignored():
    ignoring = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)" + SIGNALLED_COMMAND
    command, _ = start("-c", ignoring, int(signal.SIGHUP))
    assert command.communicate(timeout=60) == ("before\nafter\n", "")
    assert command.returncode == 0


def test_interrupt_of_a_job_in_the_background_is_answered():
    """A shell script ignores SIGINT for it."""
    ignoring = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)" + SIGNALLED_COMMAND
    command, _ = start("-c", ignoring, int(signal.SIGINT))
    assert command.communicate(timeout=60) == ("before\n", "interrupted\n")
    assert command.returncode == 130


@pytest.mark.parametrize("number", SIGNALS)
def test_run_saves_and_tells_its_signal(monkeypatch, tmp_path, number):
    class Signalled(FakeSimulation):
        def advance(self, time_limit):
            if self.state.step == 11:
                os.kill(os.getpid(), number)
            return super().advance(time_limit)

    monkeypatch.setattr(output, "Simulation", Signalled)
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2})
    with pytest.raises(Interrupted) as caught:
        output.run_case(case, tmp_path, quiet=True)
    assert interruption.exit_status(caught.value) == 128 + number
    assert len(open_result(tmp_path).steps["dt"]) == 12


def test_step_that_does_not_end_is_cut_short(monkeypatch, tmp_path):
    class Endless(FakeSimulation):
        def advance(self, time_limit):
            if self.state.step == 11:
                os.kill(os.getpid(), signal.SIGTERM)
                threading.Event().wait(60.0)
            return super().advance(time_limit)

    monkeypatch.setattr(output, "Simulation", Endless)
    monkeypatch.setattr(output, "deferred_interrupt", lambda: deferred_interrupt(0.3))
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2})
    begun = time.monotonic()
    with pytest.raises(Interrupted):
        output.run_case(case, tmp_path, quiet=True)
    assert time.monotonic() - begun < 30.0
    assert len(open_result(tmp_path).steps["dt"]) == 11
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL


def test_repeated_sigterm_is_one_and_a_signal_that_nobody_asked_for_is_raised_at_the_end():
    reached = []

    def work():
        with deferred_interrupt():
            os.kill(os.getpid(), signal.SIGTERM)
            os.kill(os.getpid(), signal.SIGTERM)
            reached.append("the end")

    with pytest.raises(Interrupted) as caught:
        work()
    assert reached
    assert caught.value.number == signal.SIGTERM
    with deferred_interrupt() as interrupted:
        assert interrupted() == 0
        os.kill(os.getpid(), signal.SIGTERM)
        assert interrupted() == signal.SIGTERM  # heeded: not raised again
