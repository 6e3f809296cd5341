"""The one rule: nothing of another question is overwritten without --force, the same one continues."""

import csv
import json
import os

import numpy as np
import pytest
from same_result import differences

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.draw import pictures
from fvcollapse.draw.drawing import new_figure, png
from fvcollapse.errors import InputError, OutputError
from fvcollapse.output.question import RECORD, Latitude, claim_file, claim_folder
from fvcollapse.studies import refinement_report

CASE = "time.end = 0.03\ngrid.cell_size = 0.02\n"
COMMANDS = {
    "run": ["run", "CASE"],
    "sweep": ["sweep", "CASE", "--vary", "gate.speed=1,2"],
    "converge": ["converge", "CASE", "--cell-size", "0.02", "0.025", "0.03"],
}


@pytest.fixture
def started(started, monkeypatch):
    """The same, where no figure of a refinement is drawn."""
    blank = png(new_figure(0.5, 0.5))
    monkeypatch.setattr(refinement_report, "draw_png", lambda *_: blank)
    return started


@pytest.fixture
def ask(tmp_path, capsys):
    """Ask a command; (exit status, stderr)."""
    case = tmp_path / "case.toml"
    case.write_text(CASE)

    def answer(command, *changes, out="out"):
        line = [str(case) if word == "CASE" else word for word in COMMANDS[command]]
        status = main([*line, "--quiet", "--out", str(tmp_path / out), *changes])
        return status, capsys.readouterr().err

    return answer


def contents(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*.*") if p.is_file()}


@pytest.mark.parametrize("command", COMMANDS)
def test_same_question_finds_its_results_and_another_one_is_refused(
    command, started, ask, tmp_path
):
    assert ask(command) == (0, "")
    count = len(started)
    before = contents(tmp_path / "out")
    assert ask(command) == (0, "")
    assert len(started) == count  # nothing is run twice
    status, told = ask(command, "--set", "rheology.mu_2=0.9")
    assert status == 2
    assert told.count("\n") == 1
    assert "--force" in told
    after = contents(tmp_path / "out")
    logs = [name for name in after if name.name == "run.log"]
    assert {n: d for n, d in after.items() if n not in logs} == {
        n: d for n, d in before.items() if n not in logs
    }
    assert ask(command, "--set", "rheology.mu_2=0.9", "--force") == (0, "")
    assert len(started) == 2 * count
    results = list((tmp_path / "out").rglob("result.h5"))
    assert {open_result(path).case.rheology.mu_2 for path in results} == {0.9}


@pytest.mark.parametrize("command", ["sweep", "converge"])
def test_foreign_folder_is_refused_before_anything_runs(command, started, ask, tmp_path):
    foreign = tmp_path / "out" / "letters.txt"
    foreign.parent.mkdir()
    foreign.write_text("dear")
    status, told = ask(command)
    assert status == 2
    assert "letters.txt" in told
    assert told.count("\n") == 1
    assert started == []
    assert list(foreign.parent.iterdir()) == [foreign]
    assert ask(command, "--force") == (0, "")
    assert foreign.read_text() == "dear"


def test_result_of_unknown_origin_is_refused(started, ask, tmp_path):
    foreign = tmp_path / "out" / "result.h5"
    foreign.parent.mkdir()
    foreign.write_bytes(b"measurements of years")
    assert ask("run")[0] == ask("run", "--resume")[0] == 2
    assert foreign.read_bytes() == b"measurements of years"
    assert ask("run", "--force") == (0, "")
    assert open_result(foreign).complete


def rows(tmp_path):
    with (tmp_path / "out" / "sweep.csv").open(newline="") as file:
        return {row["point"]: row for row in csv.DictReader(file)}


def test_narrower_sweep_keeps_the_other_rows(started, ask, tmp_path):
    assert ask("sweep", "--vary", "gate.speed=3")[0] == 0
    before = rows(tmp_path)
    assert len(before) == 3
    assert ask("sweep")[0] == 0
    assert rows(tmp_path) == before
    assert len(started) == 3
    assert ask("sweep", "--vary", "rheology.mu_1=0.4,0.45")[0] == 0
    after = rows(tmp_path)
    assert len(after) == 3 + 4
    for point, row in before.items():
        assert row.items() <= after[point].items()
    assert after["gate.speed=3"]["rheology.mu_1"] == ""


def test_broken_table_is_one_line(started, ask, tmp_path):
    assert ask("sweep")[0] == 0
    (tmp_path / "out" / "sweep.csv").write_text("a,b\n1,2,3\n")
    status, told = ask("sweep")
    assert (status, told.count("\n")) == (2, 1)
    assert "sweep.csv" in told


def test_study_grows_and_does_not_shrink(started, ask, tmp_path):
    copy = ["--json", str(tmp_path / "copy.json")]
    assert ask("converge", *copy) == (0, "")
    assert ask("converge", *copy) == (0, "")
    assert ask("converge", "0.0225", *copy)[0] == 2  # an argument that is no option
    COMMANDS["wider"] = [*COMMANDS["converge"], "0.0225"]
    assert ask("wider", *copy) == (0, "")
    assert len(json.loads((tmp_path / "copy.json").read_text())["runout"]["cell_size"]) == 4
    status, told = ask("converge")
    assert status == 2
    assert "values: found [0.03, 0.025, 0.02]" in told
    (tmp_path / "copy.json").write_text("notes")
    assert ask("wider", *copy)[0] == 2
    assert ask("wider", *copy, "--force") == (0, "")


def test_pictures_of_one_run_are_renewed_and_of_another_refused(
    started, ask, monkeypatch, tmp_path
):
    for name in ("picture", "animation"):
        monkeypatch.setattr(pictures, name, lambda *_: b"picture")
    assert ask("run")[0] == 0
    drawn = ["plot", str(tmp_path / "out"), "--out", str(tmp_path / "pictures")]
    assert main(drawn) == main(drawn) == 0
    assert ask("run", "--resume", "--set", "time.end=0.04")[0] == 0
    assert main(drawn) == 0
    assert ask("run", "--set", "gate.speed=1", out="other")[0] == 0
    drawn[1] = str(tmp_path / "other")
    assert main(drawn) == 2
    assert main([*drawn, "--force"]) == 0


def test_files_are_not_overwritten(tmp_path, capsys):
    path = tmp_path / "table.json"
    path.write_text("notes")
    for command in (["verify", "bagnold_24deg"], ["bench", "22deg_w10cm_6mm"]):
        assert main([*command, "--json", str(path)]) == 2
        told = capsys.readouterr()
        assert (told.out, told.err.count("\n")) == ("", 1)
        assert "already there" in told.err
    assert path.read_text() == "notes"
    claim_file(path, force=True)
    claim_file(None)
    with pytest.raises(OutputError, match="a device"):  # the atomic move would replace it
        claim_file(os.devnull)


def test_imported_curves_are_the_same_or_refused(tmp_path, capsys):
    (tmp_path / "front.csv").write_text("0 0.2\n0.1 0.3\n")
    line = ["import-curves", "--front", str(tmp_path / "front.csv"), "--out", str(tmp_path / "new")]
    assert main(line) == main(line) == 0
    (tmp_path / "front.csv").write_text("0 0.2\n0.1 0.4\n")
    assert main(line) == 2
    assert main([*line, "--force"]) == 0
    assert "0.4" in (tmp_path / "new" / "front.csv").read_text()


# -- the record ----------------------------------------------------------------------------------


def test_what_may_differ(tmp_path):
    latitude = Latitude(free=("case.a", "case.b"), growing=("values",))
    asked = {"case.a": 1, "case.b.x": 2, "case.c": float("inf"), "values": [1, 2]}
    assert not claim_folder(tmp_path, "sweep", asked, latitude=latitude)
    (tmp_path / "result").touch()
    assert claim_folder(tmp_path, "sweep", asked | {"case.a": 5}, latitude=latitude)
    assert claim_folder(tmp_path, "sweep", asked | {"values": [1, 3, 2]}, latitude=latitude)
    with pytest.raises(InputError, match=r"question\.json: values"):
        claim_folder(tmp_path, "sweep", asked, latitude=latitude)
    asked["values"] = [1, 2, 3]
    narrow = latitude._replace(free=("case.a",))
    with pytest.raises(
        InputError, match=r"b\.x: found 3; allowed: 2, as the results there have it"
    ):
        claim_folder(tmp_path, "sweep", asked | {"case.b.x": 3}, latitude=narrow)
    assert claim_folder(tmp_path, "sweep", asked, latitude=narrow)
    with pytest.raises(InputError, match=r"b\.x"):  # what was fixed once stays fixed
        claim_folder(tmp_path, "sweep", asked | {"case.b.x": 3}, latitude=latitude)
    with pytest.raises(InputError, match="command: found"):
        claim_folder(tmp_path, "converge", asked)
    assert not claim_folder(tmp_path, "converge", asked, force=True)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"format": 1}', "\xff", "[" * 100_000])
def test_broken_record_is_one_line(tmp_path, text):
    (tmp_path / "result").touch()
    (tmp_path / RECORD).write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match="no question of fvcollapse"):
        claim_folder(tmp_path, "sweep", {})
    assert not claim_folder(tmp_path, "sweep", {}, force=True)


def test_place_that_is_a_file_is_one_line(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written"):
        claim_folder(tmp_path / "file", "sweep", {})


# -- what a kill leaves --------------------------------------------------------------------------


def test_missing_or_older_xdmf_is_written(started, ask, tmp_path):
    assert ask("run")[0] == 0
    path = tmp_path / "out" / "result.xdmf"
    text = path.read_bytes()
    for spoil in (path.unlink, lambda: path.write_bytes(text[:100])):
        spoil()
        assert ask("run")[0] == 0
        assert path.read_bytes() == text
    assert len(started) == 1


def test_half_written_files_of_a_killed_run_go(started, ask, tmp_path):
    assert ask("run")[0] == 0
    left = [tmp_path / "out" / name for name in (".fvcollapse-x1.tmp", ".result.h5.tmp")]
    for path in left:
        path.touch()
    notes = tmp_path / "out" / ".notes.tmp"
    notes.touch()
    assert ask("run")[0] == 0
    assert not any(path.exists() for path in left)
    assert notes.exists()


def test_run_that_is_forced_is_the_run(started, ask, tmp_path):
    assert ask("run", "--set", "rheology.mu_1=0.4")[0] == 0
    assert ask("run", "--force")[0] == 0
    assert ask("run", out="fresh")[0] == 0
    found = [tmp_path / name / "result.h5" for name in ("out", "fresh")]
    assert differences(*found) == []
    assert np.isfinite(open_result(found[0]).runout).all()
