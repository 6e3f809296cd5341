"""The cache of runs: what makes a key, what is kept, and what survives interruption and company."""

import shutil
import threading
from pathlib import Path

import h5py
import numpy as np
import pytest
from fake_simulation import stopped

import fvcollapse
from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.output import run as output
from fvcollapse.studies import cache
from fvcollapse.studies.cache import RunCache, cache_key
from fvcollapse.studies.cache_folder import default_folder, ready_folder

CASE = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.1})


# -- keys ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "change",
    [
        {"rheology.mu_1": 0.481},
        {"grid.cell_size": 0.0200001},
        {"effects.lateral_friction": {}},
        {"numerics.tolerance": 2e-3},
        {"front.thickness": 0.0051},
        {"gate.speed": float("inf")},
    ],
)
def test_physics_and_numerics_make_the_key(change):
    assert cache_key(CASE.replace(**change)) != cache_key(CASE)


@pytest.mark.parametrize(
    "change",
    [
        {"time.end": 2.0},
        {"time.stop_at_rest": True},
        {"time.output_interval": 0.1},
        {"time.output_times": [0.05]},
        {},
    ],
)
def test_outputs_do_not(change):
    assert cache_key(CASE.replace(**change)) == cache_key(CASE)


def test_another_solver_is_another_key(monkeypatch):
    before = cache_key(CASE)
    monkeypatch.setattr(cache, "solver_version", lambda effects: "0.0")
    assert cache_key(CASE) != before


def test_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("FVCOLLAPSE_CACHE", str(tmp_path))
    assert default_folder() == tmp_path
    monkeypatch.delenv("FVCOLLAPSE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "/elsewhere")
    assert default_folder() == Path("/elsewhere/fvcollapse")


# -- hits and misses -----------------------------------------------------------------------------


def test_only_the_extract_stays(started, tmp_path):
    runs = RunCache(tmp_path)
    result = runs.run(CASE)
    assert result.complete
    place = runs.place(CASE)
    assert sorted(path.name for path in place.iterdir()) == ["extract.h5", "lock"]
    assert open_result(place / "extract.h5").case.to_toml() == result.case.to_toml()
    assert len(started) == 1


def test_second_request_runs_nothing(started, tmp_path):
    first = RunCache(tmp_path).run(CASE)
    again = fvcollapse.RunCache(str(tmp_path)).run(CASE.replace(**{"time.output_interval": 0.05}))
    assert len(started) == 1
    np.testing.assert_array_equal(first.runout, again.runout)


def test_longer_run_serves_a_shorter_request_and_not_the_other_way(started, tmp_path):
    runs = RunCache(tmp_path)
    runs.run(CASE)
    assert runs.get(CASE.replace(**{"time.end": 0.06})) is not None
    assert runs.get(CASE.replace(**{"time.end": 0.2})) is None
    assert runs.run(CASE.replace(**{"time.end": 0.2})).series["time"][-1] == 0.2
    assert runs.run(CASE).case.time.end == 0.2
    assert len(started) == 2


def test_broken_extract_is_made_again(started, tmp_path):
    runs = RunCache(tmp_path)
    runs.run(CASE)
    path = runs.place(CASE) / "extract.h5"
    path.write_bytes(path.read_bytes()[:5000])
    assert runs.get(CASE) is None
    assert runs.run(CASE).complete
    assert len(started) == 2


def test_entry_of_another_case_is_made_again_with_a_word(started, tmp_path, capsys):
    runs, other = RunCache(tmp_path), CASE.replace(**{"rheology.mu_1": 0.3})
    runs.run(other)
    place = runs.place(CASE)
    shutil.copytree(runs.place(other), place)
    assert runs.run(CASE).case.rheology.mu_1 == CASE.rheology.mu_1
    told = capsys.readouterr().err
    assert told == f"{place / 'extract.h5'}: an entry of another case; it is computed again\n"
    assert len(started) == 2
    runs.run(CASE)
    assert capsys.readouterr().err == ""
    assert len(started) == 2


@pytest.mark.parametrize("name", ["series/table", "profiles/table", "steps/table", "profiles/x"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_entry_that_is_not_finite_is_made_again_with_a_word(started, tmp_path, capsys, name, value):
    runs = RunCache(tmp_path)
    runs.run(CASE)
    with h5py.File(runs.place(CASE) / "extract.h5", "r+") as file:
        data = file[name][()]
        data.flat[-1] = value
        file[name][...] = data
    result = runs.run_all({"a": CASE}).results["a"]
    assert np.isfinite(result.runout).all()
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "it is computed again" in told
    assert len(started) == 2


def test_run_that_is_not_finite_fails_and_leaves_nothing(started, monkeypatch, tmp_path):
    runs = RunCache(tmp_path)
    monkeypatch.setattr(cache, "is_finite", lambda result: False)
    with pytest.raises(NumericalError, match="not finite"):
        runs.run(CASE)
    assert [path.name for path in runs.place(CASE).iterdir()] == ["lock"]


def test_folder_that_cannot_be_written_names_what_to_set(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"cannot be written.*set FVCOLLAPSE_CACHE or --cache"):
        ready_folder(tmp_path / "file" / "cache")
    assert ready_folder(tmp_path / "a" / "b").is_dir()
    assert list((tmp_path / "a" / "b").iterdir()) == []
    monkeypatch.delenv("FVCOLLAPSE_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)

    monkeypatch.setattr("os.path.expanduser", lambda path: path)  # as without a home
    with pytest.raises(InputError, match="FVCOLLAPSE_CACHE"):
        ready_folder()


def test_library_is_read_and_never_written(started, tmp_path):
    RunCache(tmp_path / "library").run(CASE)
    before = sorted((tmp_path / "library").rglob("*"))
    runs = RunCache(tmp_path / "own", (tmp_path / "library",))
    assert runs.run(CASE).complete
    runs.run(CASE.replace(**{"rheology.mu_1": 0.3}))
    assert len(started) == 2
    assert sorted((tmp_path / "library").rglob("*")) == before


# -- interruption and company --------------------------------------------------------------------


def test_interrupted_run_continues(started, monkeypatch, tmp_path):
    whole = RunCache(tmp_path / "whole").run(CASE)
    runs, counted = RunCache(tmp_path / "parts"), output.Simulation
    monkeypatch.setattr(output, "Simulation", stopped(KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        runs.run(CASE)
    assert runs.get(CASE) is None
    monkeypatch.setattr(output, "Simulation", counted)
    parts = runs.run(CASE)
    assert len(started) == 2  # one each: the second was continued
    for name in whole.series:
        np.testing.assert_array_equal(whole.series[name], parts.series[name])


def test_shorter_request_finishes_the_longer_run_that_was_cut_short(started, monkeypatch, tmp_path):
    runs, counted = RunCache(tmp_path), output.Simulation
    monkeypatch.setattr(output, "Simulation", stopped(KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        runs.run(CASE)
    monkeypatch.setattr(output, "Simulation", counted)
    assert runs.run(CASE.replace(**{"time.end": 0.02})).case.time.end == 0.1
    assert len(started) == 1


def test_two_at_a_time_make_one_run(started, tmp_path):
    results = []
    threads = [
        threading.Thread(target=lambda: results.append(RunCache(tmp_path).run(CASE)))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 4
    assert len(started) == 1


def test_many_runs_share_what_is_equal_and_failures_stop_nobody(started, monkeypatch, tmp_path):
    cases = {f"{mu}": CASE.replace(**{"rheology.mu_1": mu}) for mu in (0.3, 0.4, 0.5)}
    cases["same"] = cases["0.4"].replace(**{"time.end": 0.16})
    bad = stopped(NumericalError("no pressure"), only=lambda case: case.rheology.mu_1 == 0.3)
    monkeypatch.setattr(output, "Simulation", bad)
    runs = RunCache(tmp_path).run_all(cases)
    assert set(runs.results) == {"0.4", "0.5", "same"}
    assert set(runs.failures) == {"0.3"}
    assert len(started) == 3
    assert runs.results["0.4"].case.time.end == 0.16
    again = RunCache(tmp_path).run_all(cases)
    assert set(again.failures) == {"0.3"}
    assert len(started) == 3  # the bad one fails again where it stopped


def test_workers_that_do_not_share_the_folder_are_named(monkeypatch, tmp_path):
    monkeypatch.setattr(cache, "make_extract", lambda *_: None)
    with pytest.raises(InputError, match=r"--scheduler: found workers that do not see"):
        RunCache(tmp_path).run_all({"a": CASE})


def files_of_the_work(monkeypatch, tmp_path, error):
    """Names of the files of a run that an error stops."""
    monkeypatch.setattr(output, "Simulation", stopped(error))
    runs = RunCache(tmp_path)
    with pytest.raises(type(error)):
        runs.run(CASE)
    return sorted(path.name for path in (runs.place(CASE) / "run").iterdir())


def test_interrupted_run_leaves_its_checkpoint_only(started, monkeypatch, tmp_path):
    names = files_of_the_work(monkeypatch, tmp_path, KeyboardInterrupt())
    assert names == ["checkpoint.h5", "run.log"]


def test_failed_run_leaves_its_result_as_well(started, monkeypatch, tmp_path):
    names = files_of_the_work(monkeypatch, tmp_path, NumericalError("no pressure"))
    assert names == ["checkpoint.h5", "result.h5", "result.xdmf", "run.log"]
    place = RunCache(tmp_path).place(CASE) / "run"
    assert open_result(place).status.startswith("failed: no pressure")
