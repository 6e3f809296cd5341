"""How studies are called, and the engine of their runs; each study has tests of its own."""

from importlib import import_module

import numpy as np
import pytest
from fake_simulation import FakeSimulation

from fvcollapse.case.case import Case
from fvcollapse.errors import NumericalError
from fvcollapse.output import run as output
from runs.study import (
    COST,
    Study,
    add_rows,
    finished_run,
    main,
    run_cached,
    run_in_folders,
    run_settings,
)
from runs.table import RUNS, cell, read_table, write_table

STUDIES = sorted(path.parent.name for path in RUNS.glob("*/study.py"))
SHORT = {"time.end": 0.1, "time.field_interval": 0.1, "grid.cell_size": 0.02}


@pytest.fixture
def by_formula(monkeypatch):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)


class FailingSimulation(FakeSimulation):
    def advance(self, *arguments):
        raise NumericalError("the pressure solve failed", "in column 3", 0.0)


# -- the call ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_is_called_alike(name, capsys):
    module = import_module(f"runs.{name}.study")
    assert module.STUDY.name == name
    assert module.STUDY.tables == RUNS / name
    assert f"python -m runs.{name}.study" in module.__doc__
    assert all(part in (RUNS / name / "README.md").read_text() for part in module.STUDY.parts)
    assert module.main(["no_such_part"]) == 2
    line = capsys.readouterr().err
    allowed = ", ".join(module.STUDY.parts)
    assert line == f"command line: PART: found no_such_part; allowed: {allowed}\n"
    with pytest.raises(SystemExit) as end:
        module.main(["--help"])
    assert end.value.code == 0


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ([], "PART: found none; allowed: count, measure"),
        (["count", "--workers", "0"], "--workers: found 0; allowed: a whole number >= 1"),
        (["count", "--cell-size", "nan"], "--cell-size: found nan; allowed: a number > 0, finite"),
        (
            ["count", "measure"],
            "--data: found none; allowed: the folder of the data that measure reads",
        ),
        (["measure", "--data", "no/folder"], "--data: found no/folder; allowed: a folder"),
    ],
)
def test_bad_calls_are_refused_in_one_line(arguments, problem, capsys):
    parts = {"count": pytest.fail, "measure": pytest.fail}
    study = Study("small", "A study.", parts, need_data=("measure",))
    assert main(study, arguments) == 2
    assert capsys.readouterr().err == f"command line: {problem}\n"


def test_parts_are_done_in_the_order_of_the_call(capsys):
    done = []
    parts = {"a": lambda options: done.append("a"), "b": lambda options: ["run 3: not finished"]}
    assert main(Study("small", "A study.", parts), ["a", "a"]) == 0
    assert done == ["a", "a"]
    assert main(Study("small", "A study.", parts), ["b", "a"]) == 1
    assert capsys.readouterr().err == "run 3: not finished\n"
    assert done == ["a"] * 3
    assert main(Study("small", "A study.", parts, all_parts=True), []) == 1


@pytest.mark.parametrize(
    ("error", "status"), [(NumericalError("no solution"), 1), (KeyboardInterrupt(), 130)]
)
def test_an_error_ends_the_study_with_its_status(error, status, capsys):
    def fail(options):
        raise error

    assert main(Study("small", "A study.", {"a": fail}), ["a"]) == status
    assert capsys.readouterr().err.count("\n") == 1


def test_options_that_a_study_does_not_use_are_unknown(capsys):
    study = Study("small", "A study.", {"a": lambda options: None}, uses=())
    for option in ("--data", "--cache", "--cell-size"):
        with pytest.raises(SystemExit) as end:
            main(study, ["a", option, "0.01"])
        assert end.value.code == 2


# -- the runs ------------------------------------------------------------------------------------


def test_runs_are_finished_once(by_formula, tmp_path, monkeypatch):
    case = Case().replace(**SHORT)
    cases = {
        tmp_path / "runs" / name: case.replace(**{"geometry.slope_angle_deg": angle})
        for name, angle in (("a", 0.0), ("b", 16.0))
    }
    run_in_folders(cases, workers=1)
    for folder in cases:
        result, problem = finished_run(folder)
        assert problem == ""
        assert result.complete
        assert float((folder / COST).read_text()) >= 0.0
    monkeypatch.setattr(output, "Simulation", None)  # another run would need it
    run_in_folders(cases, workers=1)


def test_a_run_that_fails_is_named_and_tried_again(tmp_path, monkeypatch):
    folder = tmp_path / "a"
    monkeypatch.setattr(output, "Simulation", FailingSimulation)
    run_in_folders({folder: Case().replace(**SHORT)}, workers=1)
    result, problem = finished_run(folder)
    assert result is None
    assert "stopped at t = 0.000 s: the pressure solve failed" in problem
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    run_in_folders({folder: Case().replace(**SHORT)}, workers=1)
    assert finished_run(folder)[1] == ""
    assert "no such file" in finished_run(tmp_path / "b")[1]


def test_cases_of_a_table_are_not_run_again(by_formula, tmp_path):
    path, settings = tmp_path / "part.csv", {"a": SHORT, "b": SHORT | {"time.end": 0.05}}
    write_table(path, [{"name": "b", "settings": "{}", "runout": "0.5"}])
    rows = []
    for name, first, result, problem in run_settings(path, settings, tmp_path / "runs", 1):
        assert (name, problem) == ("a", "")
        rows.append(first | {"runout": float(result.summary()["runout"])})
    add_rows(path, rows)
    table = read_table(path)
    assert [row["name"] for row in table] == ["b", "a"]
    assert table[0]["runout"] == "0.5"
    assert '"time.end": 0.1' in table[1]["settings"]


def test_cached_runs_name_the_one_that_fails(tmp_path, monkeypatch):
    options = type("Options", (), {"cache": tmp_path / "cache", "workers": 1})
    monkeypatch.setattr(output, "Simulation", FailingSimulation)
    with pytest.raises(NumericalError, match="steep: the pressure solve failed"):
        run_cached({"steep": Case().replace(**SHORT)}, options)
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    assert run_cached({"steep": Case().replace(**SHORT)}, options)["steep"].complete


def test_acceptance_makes_its_table(by_formula, tmp_path, monkeypatch, capsys):
    module = import_module("runs.acceptance.study")
    monkeypatch.setitem(module.PARTS, "time_step", lambda: {"dt1ms": SHORT})
    arguments = ["time_step", "--out", str(tmp_path / "out"), "--tables", str(tmp_path)]
    assert module.main([*arguments, "--workers", "1"]) == 0
    (row,) = read_table(tmp_path / "time_step.csv")
    stored = read_table(RUNS / "acceptance" / "time_step.csv")[0]
    assert list(row) == list(stored)
    assert row["finite"] == "True"
    assert "dt1ms" in capsys.readouterr().out


def test_comparison_makes_its_tables(by_formula, tmp_path, monkeypatch):
    module = import_module("runs.comparison.study")
    monkeypatch.setitem(module.PARTS, "plane", lambda: {"a0.7": SHORT})
    arguments = ["plane", "--out", str(tmp_path / "out"), "--tables", str(tmp_path)]
    assert module.main([*arguments, "--workers", "1"]) == 0
    for name in ("plane.csv", "plane_profiles.csv"):
        made, stored = (read_table(folder / name) for folder in (tmp_path, RUNS / "comparison"))
        assert made
        assert list(made[0]) == list(stored[0])


# -- tables --------------------------------------------------------------------------------------


def test_a_table_is_what_was_written(tmp_path):
    rows = [
        {"name": "a", "x": np.float64(1 / 3), "n": 2},
        {"name": 'b, "c"', "x": float("nan"), "fine": True},
        {"name": None, "x": 1.5e-12},
    ]
    path = tmp_path / "new" / "table.csv"
    write_table(path, rows)
    assert read_table(path) == [
        {"name": "a", "x": "0.333333", "n": "2", "fine": ""},
        {"name": 'b, "c"', "x": "", "n": "", "fine": "True"},
        {"name": "", "x": "1.5e-12", "n": "", "fine": ""},
    ]
    assert b"\r" not in path.read_bytes()
    write_table(path, rows, ("x", "name"))
    assert list(read_table(path)[0]) == ["x", "name"]
    assert read_table(tmp_path / "missing.csv") == []
    assert [cell(value) for value in (0.0, 7, "text", None)] == ["0", "7", "text", ""]
