"""Stamps of tables and figures, and the command that remakes what a change of the solver makes stale."""

import argparse
import json
import subprocess
from fnmatch import fnmatch
from pathlib import Path

import pytest

from runs import remake, restamp, stamps
from runs.remake_tasks import TASKS, Task

ROOT = stamps.ROOT
# tables and reports of the studies that no task makes, and why
ELSEWHERE = {
    "runs/blind/*": "answers and scores of the diagnosis: its evidence names the solver",
    "runs/cross_code/*": "another code; `answers.json` names the solver",
    "runs/particle_laboratory/blind/*": "reports of the diagnosis, which name the solver",
    "runs/example/*": "a report of the diagnosis, which names the solver",
    "runs/particle_laboratory/labelled/*": "reports of the diagnosis, which name the solver",
    "runs/particle_laboratory/*answers.json": "answers of the diagnosis",
    "runs/particle_laboratory/discrepancy.csv": "of the diagnosis",
    "runs/particle_laboratory/opened.csv": "answers of the diagnosis",
    "runs/paper_case/*": "reports of the diagnosis, which name the solver",
    "runs/laboratories/*": "reports of the diagnosis, which name the solver",
    "runs/experiments/*": "measurements",
    "runs/comparison/reference/*": "published data",
    "runs/bench/finest.json": "an hour of quiet machine",
    "runs/stamps.json": "the stamps",
}

WRITER = """
import sys
from pathlib import Path
target = Path(sys.argv[1])
target.parent.mkdir(parents=True, exist_ok=True)
target.write_text(sys.argv[2])
sys.exit(int(sys.argv[3]))
"""


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A repository with one study, one figure of its table, and a solver whose version can be changed."""
    (tmp_path / "writer.py").write_text(WRITER)
    version = {"now": "1"}
    monkeypatch.setattr(remake, "solver_version", lambda effects=None: version["now"])
    table = Task("study", ("writer", "{tables}/study/a.csv", "1,2", "0"), ("runs/study/*.csv",), ())
    figure = Task(
        "figure", ("writer", "plots/figures/a.png", "drawn", "0"), ("plots/figures/a.*",), (), 1.0,
        ("runs/study/*.csv",),
    )  # fmt: skip
    return tmp_path, (table, figure), version


def do(task, root, tasks=()):
    return remake.remake(task, argparse.Namespace(data=None, workers=1), tasks, root)


def states_of(tasks, root):
    return [set(remake.states(task, tasks, root).values()) for task in tasks]


def test_what_was_remade_is_present_until_solver_table_or_file_change(small):
    root, tasks, version = small
    assert states_of(tasks, root) == [{stamps.MISSING}, {stamps.MISSING}]
    assert [do(task, root) for task in tasks] == ["", ""]
    assert states_of(tasks, root) == [{stamps.PRESENT}, {stamps.PRESENT}]
    assert stamps.read_stamps(root)["runs/study/a.csv"]["cpu_s"] > 0.0

    version["now"] = "2"
    assert states_of(tasks, root) == [{stamps.STALE}, {stamps.STALE}]  # the figure with its table
    version["now"] = "1"
    (root / "runs" / "study" / "a.csv").write_text("3,4")
    assert states_of(tasks, root) == [{stamps.CHANGED}, {stamps.STALE}]
    assert do(tasks[0], root) == ""
    assert states_of(tasks, root) == [{stamps.PRESENT}, {stamps.PRESENT}]  # the same table again

    stamps.write_stamps(root, [], {})
    (root / stamps.STAMPS).write_text("{}")
    assert states_of(tasks, root) == [{stamps.UNSTAMPED}, {stamps.UNSTAMPED}]


def test_a_task_that_fails_replaces_nothing_and_its_cost_adds_up(small):
    root, (table, _), _ = small
    assert do(table, root) == ""
    first = stamps.read_stamps(root)
    failing = table._replace(command=(*table.command[:2], "5,6", "3"))
    assert "study: exit status 3" in do(failing, root)
    assert (root / "runs" / "study" / "a.csv").read_text() == "1,2"
    assert stamps.read_stamps(root) == first
    assert do(table, root) == ""
    again = stamps.read_stamps(root)["runs/study/a.csv"]["cpu_s"]
    assert again > first["runs/study/a.csv"]["cpu_s"]


def test_a_task_has_the_tables_of_those_before_it(small):
    root, (table, _), version = small
    second = table._replace(
        name="second",
        command=("writer", "{tables}/second/b.csv", "7", "0"),
        makes=("runs/second/*.csv",),
        after=("study",),
    )
    tasks = (table, second)
    assert do(second, root, tasks) == "second: needs study"
    assert do(table, root, tasks) == ""
    for path in root.glob("out/remake/*/tables/study/a.csv"):
        path.unlink()  # made elsewhere
    assert do(second, root, tasks) == ""
    assert len(list(root.glob("out/remake/1/tables/*/*.csv"))) == 2
    version["now"] = "2"
    assert do(second, root, tasks) == "second: needs study"


def test_a_task_that_needs_data_is_named(small):
    root, (table, _), _ = small
    needing = table._replace(command=(*table.command, "--data", "{data}/dem"))
    assert needing.needs_data == "dem"
    assert do(needing, root) == "study: needs --data"
    assert not (root / "runs").exists()


def test_the_list_names_every_file_and_never_fails(capsys):
    """Stale tables are listed, here and in `runs/README.md`; they are no failure."""
    assert remake.main(["--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    stored = json.loads((ROOT / stamps.STAMPS).read_text(encoding="utf-8"))
    for name in stored:
        assert sum(f" {name}  (" in line for line in lines) == 1, name
    for line in lines:
        assert line.startswith(stamps.STATES)
        assert line.endswith(("CPU s)", "needs --data)"))
    print(*(line for line in lines if not line.startswith(stamps.PRESENT)), sep="\n")


def test_every_committed_table_and_figure_has_a_task_or_a_reason():
    listed = subprocess.run(
        ["git", "ls-files", "runs", "plots/figures"], cwd=ROOT, capture_output=True, text=True
    )
    if listed.returncode:
        pytest.skip("no git repository")
    made = {name for task in TASKS for name in remake.files_of(task.makes)}
    for name in listed.stdout.splitlines():
        if not (ROOT / name).exists() or Path(name).suffix not in (".csv", ".json", ".png"):
            continue
        known = name in made or any(fnmatch(name, pattern) for pattern in ELSEWHERE)
        assert known or name.startswith(OTHER_FIGURES), name


# drawn by hand from runs that are no study, or of published data
OTHER_FIGURES = (
    "plots/figures/collapse_",
    "plots/figures/ill_posedness",
)


def test_names_are_unique_and_commands_exist():
    names = [task.name for task in TASKS]
    assert len(set(names)) == len(names)
    made = [name for task in TASKS for name in task.makes]
    assert len(set(made)) == len(made)
    for task in TASKS:
        module = task.command[0].replace(".", "/")
        assert (ROOT / f"{module}.py").exists() or (ROOT / module / "__main__.py").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--only", "nothing"], "--only: found nothing; allowed: comparison bars"),
        (["--workers", "0"], "--workers: found 0"),
        (["--data", "no folder"], "--data: found no folder; allowed: a folder"),
    ],
)
def test_bad_arguments_are_one_line(arguments, words, capsys):
    assert remake.main(arguments) == 2
    captured = capsys.readouterr().err
    assert words in captured
    assert captured.count("\n") == 1


def test_tables_of_a_solver_with_the_same_numbers_are_restamped_with_a_note(small, monkeypatch):
    root, tasks, version = small
    assert [do(task, root) for task in tasks] == ["", ""]
    version["now"] = "2"
    monkeypatch.setattr(restamp, "solver_version", lambda effects=None: version["now"])
    earlier = stamps.read_stamps(root)
    assert restamp.restamped(earlier, "0", "another solver", tasks, root) == earlier
    done = restamp.restamped(earlier, "1", "only comments differ", tasks, root)
    (root / stamps.STAMPS).write_text(json.dumps(done))
    assert states_of(tasks, root) == [{stamps.PRESENT}, {stamps.PRESENT}]
    kept = done["runs/study/a.csv"]
    assert kept["restamped"] == [{"from": "1", "note": "only comments differ"}]
    version["now"] = "3"
    again = restamp.restamped(done, "2", "a file has moved", tasks, root)["runs/study/a.csv"]
    assert [of["from"] for of in again["restamped"]] == ["1", "2"]
    assert kept["cpu_s"] == earlier["runs/study/a.csv"]["cpu_s"]


def test_answers_of_a_solver_with_the_same_numbers_are_restamped(tmp_path):
    path = tmp_path / "answers.json"
    made_with = [
        {"solver": "1", "diagnosis": "a"}, {"solver": "1", "diagnosis": "b"}, {"solver": "0", "diagnosis": "a"},
    ]  # fmt: skip
    path.write_text(json.dumps({f"{n}": {"made_with": of} for n, of in enumerate(made_with)}))
    restamp.restamp_answers(path, "1", "a")
    now = [answer["made_with"] for answer in json.loads(path.read_text()).values()]
    present = restamp.digest_of(restamp.DIAGNOSIS)
    assert [of["diagnosis"] for of in now] == [present, "b", "a"]
    assert [of["solver"] for of in now] == [restamp.solver_version()] * 2 + ["0"]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [(["0.0"], "SOLVER: found 0.0; allowed: 0.1.0+"), ([], "--note: found none; allowed: why")],
)
def test_a_restamp_needs_a_known_solver_and_a_reason(arguments, line, capsys):
    known = [next(stamp["code"] for stamp in stamps.read_stamps().values() if "code" in stamp)]
    before = (ROOT / stamps.STAMPS).read_bytes()
    assert restamp.main(arguments or known) == 2
    assert line in capsys.readouterr().err
    assert (ROOT / stamps.STAMPS).read_bytes() == before
