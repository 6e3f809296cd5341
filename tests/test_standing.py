"""Workers that stay from one round of calls to the next: the same processes, and gone at the end of the block."""

import io
import os
import signal
import sys
import time

import fake_tasks
import pytest
from fake_terminal import Terminal

from fvcollapse.console.rounds_bar import RoundsBar
from fvcollapse.errors import InputError, OutputError
from fvcollapse.studies.standing import StandingWorkers


def processes_of(team, pause=0.3):
    """Processes that made the calls of one round of two."""
    found = {}
    team.run_all(fake_tasks.process_after, {n: (pause,) for n in range(2)}, found.__setitem__)
    return set(found.values())


def is_alive(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_the_processes_of_one_round_make_the_next_and_end_with_the_block():
    with StandingWorkers(2) as team:
        first = processes_of(team)
        assert processes_of(team) == first
        assert len(first) == 2
        assert os.getpid() not in first
    assert not any(map(is_alive, first))


@pytest.fixture
def heeded():
    """SIGINT is heeded; a shell lets what it runs in the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_nothing_to_do_starts_nothing():
    with StandingWorkers(2) as team:
        team.run_all(fake_tasks.double, {}, None)
        assert team.pool is None


def test_one_worker_is_this_process():
    with StandingWorkers(1) as team:
        assert processes_of(team, 0.0) == {os.getpid()}
    with pytest.raises(InputError, match="--workers: found 0"):
        StandingWorkers(0)


def test_an_idle_process_that_was_killed_is_replaced():
    with StandingWorkers(2) as team:
        first = processes_of(team)
        for process in first:
            os.kill(process, signal.SIGKILL)
        time.sleep(0.2)
        assert len(processes_of(team) - first) == 2


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.usefixtures("heeded")
def test_a_signal_between_two_rounds_ends_the_processes(number):
    first = set()

    def interrupted_study():
        with StandingWorkers(2) as team:
            first.update(processes_of(team))
            os.kill(os.getpid(), number)
            time.sleep(5.0)

    with pytest.raises(KeyboardInterrupt):
        interrupted_study()
    assert first
    assert not any(map(is_alive, first))
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_a_failure_in_a_round_ends_the_processes():
    def finished(name, outcome):
        raise OutputError("table", "disk full")

    first = set()

    def failing_study():
        with StandingWorkers(2) as team:
            first.update(processes_of(team))
            team.run_all(fake_tasks.double, {1: (1,)}, finished)

    with pytest.raises(OutputError):
        failing_study()
    assert first
    assert not any(map(is_alive, first))


# -- the bar -------------------------------------------------------------------------------------


@pytest.mark.parametrize("columns", ["80", "0"])
def test_the_bar_counts_all_rounds_by_what_they_cost(columns, monkeypatch):
    """Also where the terminal says that it has no columns."""
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setattr(sys, "stderr", Terminal())
    bar = RoundsBar({"second": [2.0, 2.0], "third": [4.0]}, quiet=False)
    bar.begin("first", [8.0, 1.0, 1.0], 20.0)  # half of the runs are at hand
    assert bar.later == (2, 4.0)
    assert sys.stderr.getvalue().strip().startswith("first, 0 of about 5 runs:")
    bar.end_run(8.0)
    assert "first, 1 of about 5 runs" in sys.stderr.getvalue()
    assert bar.bar.n / bar.bar.total == 8.0 / 14.0
    bar.end_run(1.0)
    bar.end_run(1.0)
    bar.begin("second", [], 4.0)
    bar.begin("third", [4.0], 4.0)
    bar.end_run(4.0)
    bar.close()
    assert "third, 4 of 4 runs: 100%" in sys.stderr.getvalue()


def test_no_bar_where_nothing_is_missing_or_nobody_looks(monkeypatch):
    for quiet, terminal, missing in ((False, True, []), (True, True, [1.0]), (False, False, [1.0])):
        monkeypatch.setattr(sys, "stderr", Terminal() if terminal else io.StringIO())
        bar = RoundsBar({}, quiet)
        bar.begin("first", missing, 1.0)
        bar.close()
        assert sys.stderr.getvalue() == ""
