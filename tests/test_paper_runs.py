"""The study of the paper as it is called: its cases, its command, and the committed tables that follow."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fvcollapse.case.grammar import as_table
from plots import paper, paper_front_slow_phase
from runs import table
from runs.paper import beds, cases, curves, measures, statements, study
from runs.study import main as call

PAPER = table.RUNS / "paper"


# -- cases ---------------------------------------------------------------------------------------


def test_every_case_is_listed_once_and_is_a_case():
    found = beds.runs(beds.parts(), 0.006)  # raises if a case is refused or listed twice
    physics = {}
    for at, run in found.items():
        same = run.case.replace(**{"time.end": 1.0, "time.output_times": ()}).to_toml()
        same = run.bed, same  # `sensitivity` has one of the runs of the rough bed
        assert same not in physics, f"{at} is {physics[same]} again"
        physics[same] = at
        assert run.refinement == 1.0 or run.case.grid.cell_size < 0.006, at
        assert set(run.member.keep) <= set(curves.KEPT)
        assert set(run.member.profiles) <= set(cases.TIMES)


def test_rough_beds_hold_the_grains():
    found = beds.runs([part for part in beds.parts() if part.startswith("rough")], 0.006)
    assert {run.bed for run in found.values()} == {"rough", "rough_thin_layer"}
    for run in found.values():
        assert run.case.boundary.mu_bed == math.inf
        assert ("thin_layer" in as_table(run.case)["effects"]) == (run.bed == beds.ROUGH_THIN)
    assert not any("bed" in run.name for run in found.values())


def test_finer_grids_are_runs_of_their_own():
    keys = [("", "back0.18_a22_w10", 2.0), ("rough", "eta1_a22_w10", 2.0)]
    found = beds.finer_runs(keys, 0.006)
    assert list(found) == ["back0.18_a22_w10_3mm", "rough/eta1_a22_w10_3mm"]
    assert {run.group for run in found.values()} == {beds.FINER}
    assert not set(found) & set(beds.runs(beds.parts(), 0.006))


# -- the command ---------------------------------------------------------------------------------


@pytest.fixture
def short(monkeypatch):
    """One short case on two coarse grids instead of all."""
    settings = cases.collapse(22, "w10", end=0.12)
    keep = tuple(curves.KEPT)
    listed = {"muI_a22_w10": cases.Member(settings, (1.0, 1.5), (0.1,), keep)}
    monkeypatch.setattr(beds, "GROUPS", {"lateral_friction": listed})
    shorter = replace(study.STUDY, parts={"lateral_friction": listed})
    monkeypatch.setattr(study, "main", partial(call, shorter))
    return listed


def study_in(folder, *arguments):
    options = ["--out", str(folder / "runs"), "--tables", str(folder)]
    return study.main([*options, "--workers", "1", "--cell-size", "0.035", *arguments])


def test_study_writes_tables_and_runs_nothing_twice(short, tmp_path, monkeypatch):
    assert study_in(tmp_path) == 0
    found = table.Tables(tmp_path)
    assert found.row("muI_a22_w10", 1.5)["cell_size_mm"] == pytest.approx(35.0 / 1.5, rel=1e-5)
    assert found.row("muI_a22_w10")["cpu_s"] > 0.0
    assert found.line("muI_a22_w10", "front_m").values[0] == pytest.approx(0.2, abs=0.002)
    assert found.line("muI_a22_w10", "thickness_mm", 0.1).values.max() > 100.0
    first = (tmp_path / "lateral_friction" / table.CURVES).read_bytes()
    monkeypatch.setattr("fvcollapse.output.run.Simulation", None)  # a second run would need it
    assert study_in(tmp_path) == 0
    assert (tmp_path / "lateral_friction" / table.CURVES).read_bytes() == first


def test_a_run_that_stopped_is_left_out_and_named(short, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(study, "run_in_folders", lambda *_: None)
    assert study_in(tmp_path) == 1
    assert "muI_a22_w10_35mm" in capsys.readouterr().err
    assert not (tmp_path / "lateral_friction").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["figure_3"], "PART: found figure_3; allowed: lateral_friction"),
        (["--workers", "0"], "--workers: found 0"),
        (["--cell-size", "0.2"], "--cell-size 0.2: grid.cell_size"),
    ],
)
def test_bad_arguments_are_one_line(tmp_path, capsys, arguments, words):
    assert study_in(tmp_path, *arguments) == 2
    captured = capsys.readouterr().err
    assert words in captured
    assert captured.count("\n") == 1


# -- the committed tables ------------------------------------------------------------------------


def test_committed_tables_are_readable_and_small():
    found = table.Tables(PAPER)
    assert found.scalars
    for row in found.scalars.values():
        assert row["complete"] == 1.0
    for lines in found.curves.values():
        for line in lines:
            assert np.isfinite(table.as_line(line).values).any()
    for folder, most in ((PAPER, 700_000), (PAPER / "rough", 300_000)):
        assert sum(path.stat().st_size for path in folder.glob("*/*.csv")) < most


def test_committed_statements_follow_from_the_committed_tables():
    found, _ = statements.all_statements(PAPER)
    text = (PAPER / "statements.md").read_text(encoding="utf-8")
    assert f"{statements.counted(found)}.\n" in text
    for number, of in enumerate(found, start=1):
        assert f"| {number} | {of.claim.place} | {of.claim.claim} | " in text
        assert of.paper.measured().replace("|", "/") in text
    rows = table.read_table(PAPER / "statements.csv")
    assert [row["clause_verdict"] for row in rows] == [
        row.get("clause_verdict", "") for row in statements.clause_rows(found)
    ]


def test_figures_and_statements_share_what_a_slow_phase_is():
    assert paper_front_slow_phase.PLATEAU_LEAST == measures.PLATEAU_LEAST


def test_the_labels_of_the_sensitivities_are_those_of_the_cases(tmp_path):
    study.write_labels(tmp_path / table.LABELS)
    stored = PAPER / "sensitivity" / table.LABELS
    assert (tmp_path / table.LABELS).read_bytes() == stored.read_bytes()


@pytest.mark.slow
def test_everything_is_remade(tmp_path, monkeypatch):
    """All cases on the coarsest grids that are allowed, the statements and the figures."""
    monkeypatch.setattr("plots.paper_style.FIGURES", tmp_path / "figures")
    options = ["--out", str(tmp_path / "runs"), "--tables", str(tmp_path), "--cell-size", "0.035"]
    assert study.main(options) in (0, 1)  # on such grids a run may fail; it is named and left out
    paper.main(tmp_path)
    of = table.Tables(tmp_path)
    assert len(of.scalars) > 150
    assert (tmp_path / "statements.md").exists()
    assert len(list((tmp_path / "figures").glob("*.png"))) > 10
