"""Real runs on real workers, one of which is killed in the midst: nothing lost, nothing done twice."""

import json
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from fake_tasks import fill_cache, run_with_many_checkpoints
from same_result import differences

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.errors import NumericalError
from fvcollapse.studies.cache import RunCache
from fvcollapse.studies.members import run_member
from fvcollapse.studies.workers import run_all

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
RESUMED = re.compile(r"resumed from t = ([\d.]+) s")
STARTED = "start from t = 0"


@pytest.fixture
def calls(tmp_path):
    """Three runs of some seconds each."""
    case = Case().replace(**{"grid.cell_size": 0.005, "time.end": 1.2})
    slopes = (0, 10, 20)
    cases = {f"{n}": case.replace(**{"geometry.slope_angle_deg": n}) for n in slopes}
    return {name: (case, tmp_path / "runs" / name) for name, case in cases.items()}


@pytest.fixture
def scheduler(tmp_path):
    """Address of a scheduler with two worker processes; all are ended afterwards."""
    file = tmp_path / "scheduler.json"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests")])}

    def start(program, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments]
        with (tmp_path / f"{program}.log").open("a") as log:
            return subprocess.Popen(command, env=environment, cwd=tmp_path, stdout=log, stderr=log)

    here = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)]
    programs = [start("dask_scheduler", "--port", "0", *here)]
    try:
        wait_for(file.exists)
        one = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--scheduler-file", str(file)]
        programs += [start("dask_worker", *one) for _ in range(2)]
        yield json.loads(file.read_text())["address"], programs[0]
    finally:
        for program in programs:
            program.kill()
            program.wait()


def wait_for(condition, limit=900.0, alive=lambda: True):
    """Wait until a condition holds, while what makes it hold is alive: on a busy machine compilation takes minutes."""
    end = time.monotonic() + limit
    while not condition():
        assert alive(), "what was to be killed in its midst has ended before"
        assert time.monotonic() < end
        time.sleep(0.02)


def log(folder):
    path = folder / "run.log"
    return path.read_text() if path.exists() else ""


def marching(calls):
    """Folders of the runs that have a checkpoint beyond t = 0 and are not finished."""
    folders = [folder for _, folder in calls.values()]
    return [
        folder
        for folder in folders
        if re.search(r"checkpoint at t = 0\.0*[1-9]", log(folder)) and " done\n" not in log(folder)
    ]


def run_and_kill(calls, victim, **options):
    """Run all; kill `victim(folder)` once a run is in its midst. Return outcomes and that folder."""
    found, killed, ended = {}, [], threading.Event()

    def kill():
        wait_for(lambda: marching(calls) or ended.is_set())
        if ended.is_set():
            return
        killed.append(marching(calls)[0])
        victim(killed[0])

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        run_all(run_with_many_checkpoints, calls, found.__setitem__, **options)
    finally:
        ended.set()
        killer.join()
    assert killed, "all runs have ended before one could be killed in its midst"
    return found, killed[0]


def kill_its_worker(folder):
    process = int((folder / "processes").read_text().split()[-1])
    assert process != os.getpid()
    os.kill(process, signal.SIGKILL)


def check(calls, found, killed, tmp_path):
    assert found == {name: name for name in calls}
    for _, folder in calls.values():
        assert open_result(folder).complete
        assert log(folder).count(STARTED) == 1  # nothing done twice
        assert log(folder).count(" done\n") == 1
    assert float(RESUMED.search(log(killed)).group(1)) > 0.0  # nothing lost
    case, _ = calls[killed.name]
    run_member(case, tmp_path / "whole")
    assert differences(tmp_path / "whole/result.h5", killed / "result.h5") == []


def test_process_killed_in_the_midst_of_a_run(calls, tmp_path):
    found, killed = run_and_kill(calls, kill_its_worker, workers=2)
    check(calls, found, killed, tmp_path)


def test_worker_of_a_cluster_killed_in_the_midst_of_a_run(
    calls, scheduler, tmp_path, monkeypatch, capsys
):
    address, program = scheduler
    found, killed = run_and_kill(calls, kill_its_worker, scheduler=address)
    check(calls, found, killed, tmp_path)
    processes = {
        process
        for _, folder in calls.values()
        for process in (folder / "processes").read_text().split()
    }
    assert len(processes) == 2
    assert str(os.getpid()) not in processes
    # the command line, on the worker that is left
    (tmp_path / "short.toml").write_text("time.end = 0.05\ngrid.cell_size = 0.02\n")
    monkeypatch.chdir(tmp_path)
    arguments = ["sweep", "short.toml", "--vary", "gate.speed=1.0,inf", "--out", "sweep"]
    assert main([*arguments, "--scheduler", address, "--quiet"]) == 0
    assert open_result("sweep/gate.speed=inf").complete
    program.kill()
    program.wait()
    assert main([*arguments, "--scheduler", address, "--quiet"]) == 2
    assert "--scheduler: found 'tcp://" in capsys.readouterr().err


def test_lost_scheduler_is_one_line_and_the_runs_continue_without_it(calls, scheduler, tmp_path):
    address, program = scheduler

    def kill_the_scheduler(folder):
        program.kill()

    with pytest.raises(NumericalError, match="the scheduler is gone"):
        run_and_kill(calls, kill_the_scheduler, scheduler=address)
    found = {}
    run_all(run_with_many_checkpoints, calls, found.__setitem__)
    assert found == {name: name for name in calls}
    assert all(open_result(folder).complete for _, folder in calls.values())


def test_cache_filled_by_two_processes_one_of_which_is_killed(calls, tmp_path):
    folder = tmp_path / "cache"
    folder.mkdir()
    cases = {name: case for name, (case, _) in calls.items()}
    runs = RunCache(folder)
    context = multiprocessing.get_context("spawn")
    fillers = [context.Process(target=fill_cache, args=(folder, cases)) for _ in range(2)]
    fillers[0].start()
    first = runs.place(cases["0"]) / "run"
    wait_for(
        lambda: re.search(r"checkpoint at t = 0\.0*[1-9]", log(first)), alive=fillers[0].is_alive
    )
    fillers[1].start()  # waits for the first run, or is still on its way there
    time.sleep(1.0)
    fillers[0].kill()
    for filler in fillers:
        filler.join()
    assert fillers[1].exitcode == 0
    told = (folder / "logs").read_text()
    assert told.count(STARTED) == told.count(" done\n") == len(cases)
    assert float(RESUMED.search(told).group(1)) > 0.0
    results = runs.run_all(cases).results
    assert set(results) == set(cases)
    alone = RunCache(tmp_path / "alone").run(cases["0"])
    for name in alone.series:
        np.testing.assert_array_equal(alone.series[name], results["0"].series[name])
