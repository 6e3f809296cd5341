"""run, sweep, converge and diagnose killed at any instant, and asked again.

The results are to the last bit those of a call that was left alone, nothing that had ended is run again,
SIGTERM ends within 5 s, and no process is left. The instants are drawn from a fixed seed over the time
that the call takes; `-s` shows what was measured.
"""

import csv
import json
import random
import shutil
import signal
import time
from pathlib import Path

import pytest
from processes import alive, start, wait_for
from same_result import differences
from toy_laboratory import film

pytestmark = pytest.mark.slow
SCRIPT = Path(__file__).with_name("kill_command.py")
INSTANTS = 20
COARSE = "warning: experiment: command line: --cell-size: found 0.028 m"
QUICK = 5.0  # s in which SIGTERM ends a command
CASE = """[geometry]
slope_angle_deg = 16
[grid]
cell_size = 0.02
[time]
end = 0.15
[effects.lateral_friction]
"""


def arguments(command, folder):
    """The command line of a study in a folder, and its input files there."""
    folder.mkdir(parents=True, exist_ok=True)
    case, out = folder / "case.toml", folder / "out"
    case.write_text(CASE, encoding="utf-8")
    if command == "run":
        return ["run", case, "--quiet", "--out", out]
    if command == "sweep":
        vary = "geometry.slope_angle_deg=0,8,16"
        return ["sweep", case, "--vary", vary, "--workers", "2", "--quiet", "--out", out]
    if command == "converge":
        sizes = ["0.015", "0.018", "0.022"]
        return ["converge", case, "--cell-size", *sizes, "--workers", "2", "--quiet", "--out", out]
    experiment = short_film(folder / "experiment")
    options = ["--effects", "cohesion", "--cell-size", "0.028", "--cache", folder / "cache"]
    return ["diagnose", experiment, *options, "--quiet", "--out", out]


def short_film(folder):
    """An experiment of a tenth of a second."""
    film(folder, 16.0)
    for path in folder.glob("*.csv"):
        header, *rows = path.read_text(encoding="utf-8").splitlines()
        rows = [row for row in rows if float(row.split(",")[0]) < 0.1]
        path.write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    return folder


def begin(command, folder):
    line = arguments(command, folder)
    return start(SCRIPT, *line, RUNS_LOG=str(folder / "runs"))


def finish(command, folder):
    """Ask to the end; return the wall time."""
    begun = time.monotonic()
    process, mark = begin(command, folder)
    told = process.communicate()
    assert process.returncode == 0, told
    wait_for(lambda: not alive(mark), 10.0)
    return time.monotonic() - begun


def same_answers(command, whole, killed):
    """Names of what differs between two folders."""
    names = [path.relative_to(whole) for path in sorted((whole / "out").rglob("*.h5"))]
    found = [
        f"{name}: {what}" for name in names for what in differences(whole / name, killed / name)
    ]
    if command == "sweep":
        found += rows_without_time(whole) != rows_without_time(killed) and ["sweep.csv"] or []
    if command == "converge":
        name = "out/converge.json"
        found += [] if (whole / name).read_bytes() == (killed / name).read_bytes() else [name]
    if command == "diagnose":
        found += report_without_cost(whole) != report_without_cost(killed) and ["report"] or []
    left = [str(path) for path in killed.rglob("*.tmp")]
    return found + left


def rows_without_time(folder):
    with (folder / "out/sweep.csv").open(newline="") as file:
        return [{**row, "wall_time": None} for row in csv.DictReader(file)]


def report_without_cost(folder):
    """The report without what says how it was made: cost, date, folder, which runs were at hand before."""
    report = json.loads((folder / "out/report.json").read_text(encoding="utf-8"))
    report.pop("cost")
    report["details"].pop("made")
    for group in report["details"]["runs"]:
        group.pop("cached")
    return report


def run_twice(folder):
    """Lines of runs that began or went on after they had ended."""
    ended, found = set(), []
    for line in (folder / "runs").read_text().splitlines():
        word, _, case = line.partition(" ")
        if case in ended:
            found.append(line)
        if word == "end":
            ended.add(case)
    return found


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
@pytest.mark.parametrize("command", ["run", "sweep", "converge", "diagnose"])
def test_killed_at_any_instant_and_asked_again(command, number, tmp_path):
    finish(command, tmp_path / "warm")  # kernels are compiled
    duration = finish(command, tmp_path / "whole")
    draw = random.Random(f"{command} {number}")
    killed, slowest = 0, 0.0
    for instant in range(INSTANTS):
        folder = tmp_path / "killed"
        delay = duration * draw.random()
        process, mark = begin(command, folder)
        time.sleep(delay)
        ended_before = process.poll() is not None
        process.send_signal(number)
        begun = time.monotonic()
        out, err = process.communicate(timeout=60)
        if not ended_before and process.returncode != 0:
            killed += 1
            slowest = max(slowest, time.monotonic() - begun)
            assert process.returncode in (-number, 128 + number), (out, err)
            told = [line for line in err.splitlines() if not line.startswith(COARSE)]
            assert told in ([], ["interrupted"], [f"ended by {signal.Signals(number).name}"]), err
        if number == signal.SIGTERM:
            assert slowest < QUICK
            assert not alive(mark)
        finish(command, folder)
        wait_for(lambda mark=mark: not alive(mark), 10.0)
        assert same_answers(command, tmp_path / "whole", folder) == [], (instant, delay)
        assert run_twice(folder) == [], (instant, delay)
        shutil.rmtree(folder)
    print(f"{command} {number.name}: {killed} of {INSTANTS} killed, slowest end {slowest:.2f} s")
    assert killed >= INSTANTS // 2


@pytest.mark.parametrize("command", ["sweep", "converge", "diagnose"])
def test_two_processes_at_one_study(command, tmp_path):
    """Asked twice at the same time: nothing is lost, and nothing is computed twice."""
    finish(command, tmp_path / "whole")
    folder = tmp_path / "shared"
    calls = [begin(command, folder) for _ in range(2)]
    for process, _ in calls:
        told = process.communicate()
        assert process.returncode == 0, told
    wait_for(lambda: not any(alive(mark) for _, mark in calls), 10.0)
    assert same_answers(command, tmp_path / "whole", folder) == []
    lines = (folder / "runs").read_text().split("\n")
    begun = [line for line in lines if line.startswith(("begin", "resume"))]
    ended = [line for line in lines if line.startswith("end")]
    assert len(begun) == len(ended) == len(set(ended))


def test_two_runs_in_one_folder(tmp_path):
    """The second one is refused while the first one works, and finds the result afterwards."""
    finish("run", tmp_path / "whole")
    folder = tmp_path / "shared"
    calls = [begin("run", folder) for _ in range(2)]
    told = [process.communicate() for process, _ in calls]
    status = sorted(process.returncode for process, _ in calls)
    assert status in ([0, 2], [0, 0])
    refused = [
        err for (_, err), (process, _) in zip(told, calls, strict=True) if process.returncode
    ]
    assert all("another run that writes there" in err for err in refused)
    finish("run", folder)
    assert same_answers("run", tmp_path / "whole", folder) == []
    assert run_twice(folder) == []
