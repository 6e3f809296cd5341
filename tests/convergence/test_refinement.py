"""`converge`: the members, what is measured of them, the files, and what is refused."""

import csv
import json
import math

import numpy as np
import pytest
from fake_member import fail_on_coarse
from fake_simulation import FakeSimulation
from PIL import Image

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.draw.drawing import new_figure, png
from fvcollapse.errors import NumericalError
from fvcollapse.output import run as output
from fvcollapse.studies import refinement_report
from fvcollapse.studies.convergence import convergence
from fvcollapse.studies.members import run_members
from fvcollapse.studies.refinement import UNITS, member_case

DRAW = refinement_report.draw_png
SIZES = ["0.01", "0.02", "0.014"]


@pytest.fixture
def case_file(monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    blank = png(new_figure(0.5, 0.5))
    monkeypatch.setattr(refinement_report, "draw_png", lambda *_: blank)  # takes seconds
    path = tmp_path / "short.toml"
    path.write_text("time.end = 0.03\n[effects.lateral_friction]\n")
    return path


def converge(case_file, *arguments):
    out = case_file.parent / "out"
    return main(["converge", str(case_file), "--quiet", "--out", str(out), *arguments])


def records(case_file):
    return json.loads((case_file.parent / "out" / "converge.json").read_text())


def test_study_of_the_cell_size(case_file, capsys):
    assert converge(case_file, "--cell-size", *SIZES, "--json", str(case_file) + ".json") == 0
    out = case_file.parent / "out"
    table, told = capsys.readouterr()
    assert told == ""  # a fresh study says nothing of checkpoints
    assert "runout at 5 mm (m)" in table
    assert "GCI" in table
    found = records(case_file)
    assert json.loads((case_file.parent / "short.toml.json").read_text()) == found
    assert found.keys() == UNITS.keys()
    runout = found["runout_10mm"]
    assert {"cell_size", "value", "order", "extrapolated", "gci"} <= runout.keys()
    assert runout["cell_size"] == [0.02, 0.014, 0.01]
    results = [open_result(out / f"cell_size_{size}") for size in runout["cell_size"]]
    assert runout["value"] == [result.runout_10mm[-1] for result in results]
    # 14 columns of 14 mm are 196 mm, the gate stands at 200 mm
    assert runout["refinement_size"] == pytest.approx([0.02, math.sqrt(0.2 / 14 * 0.014), 0.01])
    expected = convergence(runout["refinement_size"], runout["value"], 1.0)._asdict()
    assert {name: runout[name] for name in expected} == expected
    assert runout["least_squares"] is None  # of three values
    coarse, medium, none = found["profile_l1"]["value"]
    assert none is None  # there is no finer one
    assert min(coarse, medium) > 0.0
    assert found["profile_l1"]["relative_error"] == medium
    assert 0.0 <= found["profile_l1"]["oscillating"] <= 1.0
    assert found["arrest_time"]["value"] == [None] * 3
    assert found["arrest_time"]["behaviour"] == "missing"
    assert "Oscillatory: " in table


def test_table_of_all_triplets_and_figure(case_file, monkeypatch, capsys):
    monkeypatch.setattr(refinement_report, "draw_png", DRAW)
    assert converge(case_file, "--cell-size", *SIZES, "0.03") == 0
    printed = capsys.readouterr().out
    assert "all values, least squares" in printed
    assert "root of the cell area (m)" in printed
    out = case_file.parent / "out"
    fitted = records(case_file)["x_99"]["least_squares"]
    assert fitted["uncertainty"] > 0.0
    with (out / "converge.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["observable"] for row in rows] == [name for name in UNITS for _ in range(2)]
    record = records(case_file)["x_99"]
    triplets, had = record["triplets"], record["refinement_size"]
    for n, (row, triplet) in enumerate(zip(rows[6:8], triplets, strict=True)):
        sizes = [float(row[f"cell_size_{role}"]) for role in ("coarse", "medium", "fine")]
        assert sizes == had[n : n + 3]  # of the grid, as in the picture
        assert row["order"] == str(triplet["order"] if triplet["order"] is not None else "")
    with Image.open(out / "converge.png") as image:
        assert len(np.unique(np.asarray(image.convert("L")))) > 10


def test_finished_members_are_not_run_again(case_file, monkeypatch):
    assert converge(case_file, "--cell-size", *SIZES) == 0
    first = records(case_file)
    started = []

    class Counted(FakeSimulation):
        def __init__(self, case, state=None):
            started.append(case.grid.cell_size)
            super().__init__(case, state)

    monkeypatch.setattr(output, "Simulation", Counted)
    assert converge(case_file, "--cell-size", *SIZES) == 0
    assert started == []
    assert records(case_file) == first
    assert converge(case_file, "--cell-size", *SIZES, "0.025") == 0
    assert started == [0.025]


def test_tolerance_has_no_order(case_file):
    assert converge(case_file, "--tolerance", "1e-2", "1e-3", "1e-4") == 0
    record = records(case_file)["runout"]
    assert record["tolerance"] == [1e-2, 1e-3, 1e-4]
    assert record["behaviour"] == "no order"
    assert record["relative_error"] == record["spread"] == 0.0  # the stand-in does not iterate
    assert record["order"] is record["gci"] is record["refinement_size"] is None


def test_step_that_was_limited_otherwise_is_not_refined(case_file):
    """The stand-in takes its own steps, whatever the longest allowed one is."""
    assert converge(case_file, "--time-step", "1e-2", "5e-3", "2e-3") == 0
    assert records(case_file)["runout"]["behaviour"] == "not refined"


def test_shear_rate_is_refined_by_its_value(case_file):
    assert converge(case_file, "--shear-rate-min", "1e-2", "1e-3", "1e-4") == 0
    record = records(case_file)["runout"]
    assert record["refinement_size"] == record["shear_rate_min"] == [1e-2, 1e-3, 1e-4]
    assert record["behaviour"] == "unchanged"


def test_cell_keeps_its_shape():
    case = Case().replace(**{"grid.cell_size": 0.01, "grid.cell_size_z": 0.005})
    assert member_case(case, "cell_size", 0.02).grid.cell_size_z == pytest.approx(0.01)
    assert member_case(Case(), "cell_size", 0.02).grid.cell_size_z is None


# -- members in processes ------------------------------------------------------------------------


def members(folder):
    sizes = (0.02, 0.015, 0.01)
    return {folder / f"{size}": Case().replace(**{"grid.cell_size": size}) for size in sizes}


def test_members_run_in_processes_and_a_failure_names_its_member(tmp_path):
    told = []
    with pytest.raises(NumericalError, match=r"0\.02: the domain is full, at x = 1 m, at t = 0.5"):
        run_members(members(tmp_path), workers=2, run=fail_on_coarse, tell=told.append)
    assert list(tmp_path.glob("*/end"))  # the coarsest, which fails, starts last


def test_failure_ends_a_study_in_one_process(tmp_path):
    with pytest.raises(NumericalError, match=r"0\.02: the domain is full"):
        run_members(members(tmp_path), run=fail_on_coarse, tell=lambda line: None)
    assert not list(tmp_path.glob("*/end"))


def test_a_member_that_fails_leaves_its_row_and_the_others_their_study(
    case_file, monkeypatch, capsys
):
    class Failing(FakeSimulation):
        def advance(self, time_limit):
            if self.case.grid.cell_size == 0.02:
                raise np.linalg.LinAlgError("singular")
            return super().advance(time_limit)

    monkeypatch.setattr(output, "Simulation", Failing)
    assert converge(case_file, "--cell-size", *SIZES, "0.03") == 1
    assert records(case_file)["runout"]["cell_size"] == [0.03, 0.014, 0.01]
    assert "cell_size_0.02: failed: unexpected LinAlgError: singular" in capsys.readouterr().out
    with (case_file.parent / "out" / "members.csv").open() as file:
        rows = {row["cell_size"]: row for row in csv.DictReader(file)}
    assert [row["status"] for row in rows.values()] == [
        "complete",
        "failed",
        "complete",
        "complete",
    ]
    assert "singular" in rows["0.02"]["problem"]


def test_two_finished_members_are_no_study(case_file, monkeypatch, capsys):
    class Failing(FakeSimulation):
        def advance(self, time_limit):
            if self.case.grid.cell_size == 0.02:
                raise MemoryError
            return super().advance(time_limit)

    monkeypatch.setattr(output, "Simulation", Failing)
    assert converge(case_file, "--cell-size", *SIZES) == 1
    error = capsys.readouterr().err
    assert "1 of 3 members failed, three must finish" in error
    assert "the memory is exhausted" in error
    assert error.count("\n") == 1


# -- bad input -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--cell-size", "0.01", "0.02"], "found 2 of them; allowed: at least three values"),
        (["--cell-size", "0.01", "0.02", "0.01"], "found 0.01 twice"),
        (["--cell-size", "0.01", "0.02", "-0.01"], "found -0.01; allowed: positive numbers"),
        (["--tolerance", "0.1", "0", "0.01"], "found 0; allowed: positive numbers"),
        (["--time-step", "1e-3", "nan", "1e-2"], "invalid decimal_number value: 'nan'"),
        (["--cell-size", "0.01", "0.02", "fine"], "invalid decimal_number value: 'fine'"),
        (["--cell-size", "0.01", "0.02", "0.5"], "--cell-size 0.5: grid.cell_size: found 0.5"),
        (["--tolerance", "0.1", "0.5", "2"], "--tolerance 2: numerics.tolerance: found 2.0"),
        (["--slope", "1", "2", "3"], "one of the arguments --cell-size"),
        (["--cell-size", *SIZES, "--tolerance", "1"], "not allowed with argument"),
        (["--cell-size", *SIZES, "--slope", "1"], "unrecognized arguments"),
        (["--cell-size", *SIZES, "--workers", "0"], "--workers: found 0"),
        (["--cell-size", *SIZES, "--json", "/no/such/folder/a.json"], "no such folder"),
    ],
)
def test_bad_arguments_are_one_line_and_run_nothing(case_file, capsys, arguments, words):
    assert converge(case_file, *arguments) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.err.count("\n") == 1
    assert not (case_file.parent / "out").exists()


def test_unreadable_case_is_refused(tmp_path, capsys):
    assert main(["converge", str(tmp_path / "none.toml"), "--cell-size", *SIZES]) == 2
    assert "no such file" in capsys.readouterr().err


def test_members_of_another_study_are_refused(case_file, capsys):
    assert converge(case_file, "--cell-size", *SIZES) == 0
    capsys.readouterr()
    for change, key in (("time.end=0.02", "time.end"), ("gate.speed=1.0", "gate.speed")):
        assert converge(case_file, "--cell-size", *SIZES, "--set", change) == 2
        assert key in capsys.readouterr().err
