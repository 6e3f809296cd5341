"""The command line itself: help without arguments, the nearest name, lists, the cache of runs."""

import os
import re

import pytest

import fvcollapse
from fvcollapse.__main__ import main
from fvcollapse.errors import InputError
from fvcollapse.studies import bench
from fvcollapse.studies.cache import EXTRACT, RunCache, cache_key
from fvcollapse.studies.cache_size import cache_size, prune
from fvcollapse.verification.names import CPU_TIME, NAMES
from fvcollapse.verification.problems.all import PROBLEMS

COARSE = {"grid.cell_size": 0.035, "time.end": 0.02}


@pytest.mark.parametrize(
    ("words", "command"), [([], "diagnose"), (["blind"], "score"), (["new"], "effect")]
)
def test_without_arguments_there_is_help(words, command, capsys):
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert printed.startswith(" ".join(["usage: fvcollapse", *words]))
    assert command in printed


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["diagnos", "beads"], "diagnose"),
        (["blind", "mak"], "make"),
        (["bench", "--efects"], "--effects"),
        (["run", "case.toml", "--quite"], "--quiet"),
        (["converge", "case.toml", "--cellsize", "1"], "--cell-size"),
        (["import-curves", "--out", "beads", "--time-unit", "mss"], "ms"),
    ],
)
def test_the_nearest_name_is_proposed(words, meant, capsys):
    assert main(words) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert told.endswith(f"; did you mean {meant}?\n")


def test_a_word_like_no_other_gets_no_proposal(capsys):
    assert main(["xyzzy"]) == 2
    assert "did you mean" not in capsys.readouterr().err


@pytest.mark.parametrize("words", [["run"], ["plot"], ["sweep"], ["diagnose"], ["blind", "make"]])
def test_a_command_without_its_arguments_shows_its_help(words, capsys):
    assert main(words) == 2
    printed, told = capsys.readouterr()
    assert printed.startswith(" ".join(["usage: fvcollapse", *words]))
    assert told.count("\n") == 1
    assert f"fvcollapse {' '.join(words)}: missing: " in told


def test_a_folder_of_experiments_can_be_planned_one_by_one(capsys):
    """Without a folder for the report, which a dry run does not write."""
    words = ["diagnose", "runs/experiments/martin2017", "--each", "--dry-run"]
    assert main(words) == 0
    assert capsys.readouterr().out.count("martin2017") == 4
    assert main(words[:3]) == 2
    assert "fvcollapse diagnose: missing: --out; see" in capsys.readouterr().err


def test_a_misspelt_effect_is_answered_with_the_nearest(capsys):
    words = ["diagnose", "runs/experiments/mangeney2010_0deg", "--dry-run"]
    assert main([*words, "--effects", "lateral_fricton"]) == 2
    assert capsys.readouterr().err.endswith("; did you mean lateral_friction?\n")


@pytest.mark.parametrize(
    "words",
    [["run", "a.toml", "--workers", "2"], ["bench", "--list"], ["verify", "nosuch"]],
    ids=" ".join,
)
def test_what_is_like_no_name_gets_no_hint(words, capsys):
    assert main(words) == 2
    told = capsys.readouterr().err
    assert "did you mean" not in told
    assert "closest" not in told


def test_a_folder_is_no_file(capsys):
    assert main(["run", "runs"]) == 2
    assert capsys.readouterr().err.startswith("runs: file: found a folder; allowed: a readable")


def test_an_option_that_is_given_already_is_not_proposed(capsys):
    given = ["blind", "make", "--cases", "1", "--out", "x"]
    assert main([*given, "--outt", "y"]) == 2
    assert "did you mean" not in capsys.readouterr().err
    assert main(["blind", "make", "--out", "x", "--nope"]) == 2
    assert "did you mean" not in capsys.readouterr().err
    repeated = ["run", "case.toml", "--set", "time.end=1", "--sett", "time.end=2"]
    assert main(repeated) == 2
    assert "did you mean --set?" in capsys.readouterr().err


def test_verify_says_what_it_will_take(capsys):
    assert main(["verify", "imposed_bed_stress"]) == 0
    told = capsys.readouterr().err
    assert (
        told == f"1 of {len(NAMES)} problems (the whole set takes {CPU_TIME}, compilation aside)\n"
    )


def test_names_of_problems_are_known_without_the_solver():
    assert list(NAMES) == [problem.name for problem in PROBLEMS]


def test_bench_says_what_it_will_take(monkeypatch, capsys):
    def stop():
        raise InputError("bench", "stop", "the first measurement", "none")

    monkeypatch.setattr(bench, "compile_times", stop)
    assert main(["bench", "22deg_w10cm_12mm"]) == 2
    first, last = capsys.readouterr().err.splitlines()
    assert re.match(r"1 case, about \d+ min; where nothing is compiled yet", first)
    assert last.startswith("bench: stop")
    whole = bench.cost(bench.cases(), all_of_them=True)
    assert re.match(r"12 cases, about \d+ min;", whole)


def test_verify_lists_its_problems(capsys):
    assert main(["verify", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(NAMES)
    assert all(len(line.split()) > 1 for line in lines)


def test_cache_says_where_and_how_large_and_is_pruned(tmp_path, capsys):
    folder = tmp_path / "cache"
    assert main(["cache", "--cache", str(folder)]) == 0
    assert (
        f"{folder}: kept 0 finished runs and 0 that were begun, 0.0 MB" in capsys.readouterr().out
    )
    case = fvcollapse.load_case("runs/collapse_22deg_w10cm.toml").replace(**COARSE)
    cache = RunCache(folder)
    cache.run(case)
    place = cache.place(case)
    size = cache_size(folder)
    assert (size.finished, size.begun) == (1, 0)
    assert size.size >= (place / EXTRACT).stat().st_size
    assert prune(folder).finished == 0
    strange = place.parent.parent / "00" / ("00" + cache_key(case)[2:])
    strange.parent.mkdir()
    os.rename(place, strange)  # as if another solver had computed it
    (folder / "notes.txt").write_text("mine")
    assert main(["cache", "--cache", str(folder), "--prune"]) == 0
    assert "removed 1 finished runs" in capsys.readouterr().out
    assert not strange.exists()
    assert (folder / "notes.txt").exists()
