"""`sweep`: the points, what is run and what is not, the table, and what is refused."""

import csv
import math

import numpy as np
import pytest
from fake_simulation import FakeSimulation

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.output import run as output
from fvcollapse.studies.sweep import all_points, parse_variation, point_name

VARY = ["--vary", "geometry.slope_angle_deg=0,16", "--vary", "rheology.mu_1=0.4,0.45,0.5"]


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text("time.end = 0.03\ngrid.cell_size = 0.02\n[effects.lateral_friction]\n")
    return path


def sweep(case_file, *arguments):
    out = case_file.parent / "out"
    return main(["sweep", str(case_file), "--quiet", "--out", str(out), *arguments])


def rows(case_file):
    with (case_file.parent / "out" / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


# -- the points ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a.b=1,2.5", ("a.b", [1, 2.5])),
        ("a.b = inf , 0.1", ("a.b", [math.inf, 0.1])),
        ("a.b=mu_I,bingham", ("a.b", ["mu_I", "bingham"])),
        ('a.b="mu_I","bingham"', ("a.b", ["mu_I", "bingham"])),
        ("a.b=true,false", ("a.b", [True, False])),
        ("a.b=[0.1, 0.2],[]", ("a.b", [[0.1, 0.2], []])),
        ("a.b=word,1", ("a.b", ["word", 1])),
    ],
)
def test_values_of_a_variation(text, expected):
    assert parse_variation(text) == expected


@pytest.mark.parametrize("text", ["a.b", "a.b=", "=1", ""])
def test_variation_without_key_or_value_is_refused(text):
    with pytest.raises(InputError, match=r"allowed: --vary section\.key="):
        parse_variation(text)


def test_points_are_the_product_and_the_last_key_changes_fastest():
    points = all_points(
        Case(), {"geometry.slope_angle_deg": [0, 16], "gate.speed": [1.0, math.inf]}
    )
    assert [(p.case.geometry.slope_angle_deg, p.case.gate.speed) for p in points] == [
        (0, 1.0),
        (0, math.inf),
        (16, 1.0),
        (16, math.inf),
    ]
    assert points[1].name == "geometry.slope_angle_deg=0_gate.speed=inf"


def test_names_are_safe_and_never_too_long():
    assert point_name({"rheology.law": "mu_I"}) == "rheology.law=mu_I"
    assert point_name({"a": "../x y"}) == "a=..-x-y"
    long = [point_name({"time.output_times": [0.1] * 50 + [last]}) for last in (0.1, 0.2)]
    assert max(map(len, long)) <= 120
    assert long[0] != long[1]


# -- runs ----------------------------------------------------------------------------------------


def test_every_point_has_a_result_and_a_row(case_file, started, capsys):
    assert sweep(case_file, *VARY) == 0
    table = rows(case_file)
    assert len(table) == len(started) == 6
    for row, case in zip(table, started, strict=True):
        result = open_result(case_file.parent / "out" / row["point"])
        assert result.case == case
        assert result.complete
        assert row["status"] == "complete"
        assert float(row["rheology.mu_1"]) == case.rheology.mu_1
        assert float(row["runout"]) == result.runout[-1]
        assert row["arrest_time"] == ""  # still moving
    printed = capsys.readouterr().out
    assert "sweep.csv" in printed
    heading = printed.splitlines()[0]
    for column in ("geometry.slope_angle_deg [deg]", "runout [m]", "arrest_time [s]", "trust"):
        assert column in heading
    with (case_file.parent / "out" / "sweep_units.csv").open(newline="") as file:
        columns = list(csv.DictReader(file))
    units = {row["column"]: row["unit"] for row in columns}
    assert all(row["meaning"] for row in columns)
    assert list(units) == list(rows(case_file)[0])
    assert units["geometry.slope_angle_deg"] == "deg"
    words = {"point", "status", "problem", "complete", "ended_at_rest", "trust", "trust_reasons"}
    assert {name for name, unit in units.items() if not unit} <= words


def test_finished_points_are_not_run_again_and_further_values_join(case_file, started):
    assert sweep(case_file, *VARY) == 0
    before = rows(case_file)
    started.clear()
    assert sweep(case_file, *VARY) == 0
    assert (started, rows(case_file)) == ([], before)
    assert sweep(case_file, *VARY, "--vary", "rheology.mu_1=0.55") == 0
    assert [case.rheology.mu_1 for case in started] == [0.55, 0.55]
    assert len(rows(case_file)) == 8


def test_failed_point_does_not_stop_the_others(case_file, monkeypatch, capsys):
    class Failing(FakeSimulation):
        def advance(self, time_limit):
            if self.case.rheology.mu_1 == 0.45:
                raise NumericalError("no pressure", "in the solve", self.state.time)
            return super().advance(time_limit)

    monkeypatch.setattr(output, "Simulation", Failing)
    assert sweep(case_file, *VARY) == 1
    status = [row["status"] for row in rows(case_file)]
    assert status == ["complete", "failed", "complete"] * 2
    assert rows(case_file)[1]["problem"].startswith("no pressure")
    error = capsys.readouterr().err
    assert error.count("no pressure, in the solve") == 2
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    assert sweep(case_file, *VARY) == 0  # continues the two


@pytest.mark.parametrize(
    ("bug", "words"),
    [
        (MemoryError(), "the memory is exhausted"),
        (np.linalg.LinAlgError("singular"), "unexpected LinAlgError: singular"),
        (FloatingPointError("overflow"), "unexpected FloatingPointError: overflow"),
        (ValueError("deep inside"), "unexpected ValueError: deep inside"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_point_that_fails_for_any_reason_leaves_its_row(
    case_file, monkeypatch, capsys, bug, words
):
    class Failing(FakeSimulation):
        def advance(self, time_limit):
            if self.case.rheology.mu_1 == 0.45 and self.state.step == 2:
                raise bug
            return super().advance(time_limit)

        @property
        def row(self):
            if self.case.rheology.mu_1 == 0.5 and self.state.step == 3:
                raise bug
            return super().row

    monkeypatch.setattr(output, "Simulation", Failing)
    assert sweep(case_file, *VARY[2:]) == 1
    found = rows(case_file)
    assert sorted({row["status"] for row in found}) == ["complete", "failed"]
    for row in found:
        if row["status"] == "failed":
            assert row["problem"].startswith(words)
            result = open_result(case_file.parent / "out" / row["point"])
            assert not result.complete
            assert result.status == f"failed: {row['problem']}"
            assert len(result.steps["dt"]) == 2  # the last good state is kept
    capsys.readouterr()


def test_interrupted_sweep_keeps_its_table_and_continues(case_file, started, monkeypatch):
    class Stopped(FakeSimulation):
        def advance(self, time_limit):
            if len(started) == 3 and self.state.step == 2:
                raise KeyboardInterrupt
            return super().advance(time_limit)

    counted = output.Simulation
    monkeypatch.setattr(output, "Simulation", type("Both", (Stopped, counted), {}))
    assert sweep(case_file, *VARY) == 130
    assert [row["status"] for row in rows(case_file)] == ["complete"] * 2 + ["missing"] * 4
    monkeypatch.setattr(output, "Simulation", counted)
    assert sweep(case_file, *VARY) == 0
    assert len(started) == 6  # the third was continued


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "missing: --vary"),
        (["--vary", "gate.sped=1,2"], "gate.sped: found a path that is no key; allowed: the clos"),
        (["--vary", "gate.speed=1,-2"], "gate.speed: found -2; allowed: a number >= 0"),
        (["--vary", "gate=1"], "gate: found 1; allowed: a table"),
        (["--vary", "gate.speed=1,1"], "--vary: found gate.speed=1 twice"),
        (["--vary", "gate.speed=" + "1," * 99, "--vary", "rheology.mu_1=" + "0," * 2000], "combin"),
        (["--vary", "gate.speed=1", "--workers", "0"], "--workers: found 0"),
    ],
)
def test_bad_arguments_are_one_line_and_run_nothing(case_file, started, capsys, arguments, words):
    assert sweep(case_file, *arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert started == []
    assert not (case_file.parent / "out").exists()


def test_points_of_another_case_are_refused(case_file, started, capsys):
    assert sweep(case_file, *VARY[:2]) == 0
    assert sweep(case_file, *VARY[:2], "--set", "rheology.mu_2=0.9") == 2
    assert "rheology.mu_2" in capsys.readouterr().err
