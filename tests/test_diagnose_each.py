"""`diagnose --each` and `--dry-run`: a table of all answers; what would be run, without running it."""

import csv
import re

import pytest
from experiment_folder import SETTINGS, write_experiment
from report_example import example

from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.commands.diagnose_each import diagnose_each
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.studies.estimate import duration, plan_of, run_seconds

FILM = "runs/experiments/example_16deg_w10cm"


def test_one_row_for_each_and_a_failure_stops_no_other(tmp_path, capsys):
    folders = [write_experiment(tmp_path / name) for name in ("a", "b", "c")]
    asked = []

    def diagnose(experiment, folder):
        asked.append((experiment.name, folder))
        if experiment.name == "b":
            raise NumericalError("it blew up")
        return example("effect" if experiment.name == "a" else "none")

    out = tmp_path / "out"
    assert diagnose_each(folders, out, diagnose) == 1
    assert asked == [(name, out / name) for name in "abc"]
    with (out / "summary.csv").open(encoding="utf-8", newline="") as file:
        first, failed, last = csv.DictReader(file)
    assert (first["status"], first["state"], first["first_cause"]) == (
        "done",
        "named",
        "lateral_friction",
    )
    assert float(first["probability"]) == pytest.approx(0.87)
    assert 0.0 < float(first["closed_held_out"]) < 1.0
    assert (failed["status"], failed["problem"]) == ("failed", "it blew up")
    assert (last["state"], last["closed_fitted"]) == ("leaning", "")
    printed, told = capsys.readouterr()
    assert "a: Most likely cause: lateral friction (87 %)" in printed
    assert told == "b: it blew up\n"


def test_two_of_one_name_are_refused(tmp_path):
    folders = [write_experiment(tmp_path / name / "film") for name in ("a", "b")]
    with pytest.raises(InputError, match="folders of different names"):
        diagnose_each(folders, tmp_path / "out", None)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "runs"),
    [
        (["run", "{case}"], 1),
        (["sweep", "{case}", "--vary", "geometry.slope_angle_deg=0,10,16"], 3),
        (["converge", "{case}", "--cell-size", "0.02", "0.015", "0.01"], 3),
    ],
)
def test_a_dry_run_counts_and_writes_nothing(words, runs, tmp_path, monkeypatch, capsys):
    (tmp_path / "case.toml").write_text("")
    monkeypatch.chdir(tmp_path)
    words = [word.format(case="case.toml") for word in words]
    assert main([*words, "--out", "out", "--dry-run"]) == 0
    assert re.fullmatch(rf"{runs} runs?, about \d+ s on 1 core, .*\n", capsys.readouterr().out)
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_a_dry_diagnosis_counts_its_runs(tmp_path, capsys):
    out, cache = tmp_path / "out", tmp_path / "cache"
    words = ["diagnose", FILM, "--effects", "cohesion", "--out", str(out), "--cache", str(cache)]
    assert main([*words, "--dry-run"]) == 0
    printed, warned = capsys.readouterr()
    told = re.match(r"(\d+) runs, about \d+ s on 2 cores, .* up to (\d+) more", printed)
    assert "expected: at most" not in warned
    assert main([*words, "--cell-size", "0.02", "--dry-run"]) == 0
    assert "--cell-size: found 0.02 m; expected: at most" in capsys.readouterr().err
    assert not out.exists()
    assert int(told[1]) >= 2 + 20 + 3  # two grids, the ensemble, levels of the effect
    assert int(told[2]) > 0
    assert not out.exists()
    assert not cache.exists()


def test_a_dry_diagnosis_tells_what_is_odd(tmp_path, capsys):
    settings = SETTINGS.replace("slope_angle_deg = 16", "slope_angle_deg = 0.2793")
    odd = write_experiment(tmp_path / "odd", settings)
    words = ["diagnose", str(odd), "--effects", "cohesion", "--out", str(tmp_path / "out")]
    assert main([*words, "--cache", str(tmp_path / "cache"), "--dry-run"]) == 0
    assert "slope_angle_deg: found 0.2793" in capsys.readouterr().err


def test_an_estimate_grows_as_the_cost_does():
    """Four times the cells; below some size also more steps."""
    sizes = (0.012, 0.006, 0.0015)
    coarse, fine, finest = (run_seconds(Case().replace(**{"grid.cell_size": h})) for h in sizes)
    assert 1.5 * coarse < fine < 4.5 * coarse
    assert finest > 16.0 * fine
    plan = plan_of([Case()] * 3, present=2)
    assert (plan.runs, plan.present) == (5, 2)
    assert plan.seconds == pytest.approx(3.0 * run_seconds(Case()))
    assert plan.line(2).startswith("5 runs (2 of them there already), about ")


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.2, "1 s"), (89.0, "89 s"), (91.0, "2 min"), (5000.0, "84 min"), (7201.0, "3 h")],
)
def test_durations(seconds, words):
    assert duration(seconds) == words
