"""Runs of a diagnosis with the solver and its cache: none is repeated, none is lost, and a failed one is told."""

import pytest
from toy_laboratory import PlannedQuestion, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.baseline import baseline_cases
from fvcollapse.diagnosis.library import build_library
from fvcollapse.diagnosis.runner import Runner
from fvcollapse.errors import NumericalError
from fvcollapse.studies.cache import make_extract


@pytest.fixture(scope="module")
def coarse(tmp_path_factory):
    """An experiment of a tenth of a second."""
    folder = film(tmp_path_factory.mktemp("real") / "short", 16.0)
    for name in ("front", "profiles", "volume", "interface"):
        path = folder / f"{name}.csv"
        header, *rows = path.read_text(encoding="utf-8").splitlines()
        kept = [row for row in rows if float(row.split(",")[0]) < 0.1]
        path.write_text("\n".join([header, *kept]) + "\n", encoding="utf-8")
    return load_experiment(folder)


def short_cases(experiment):
    """The coarsest cells, and the end of the run at once."""
    (case,) = baseline_cases([experiment], cell_size=0.028).values()
    return {experiment.name: case.replace(**{"time.end": 0.1})}


def test_an_interrupted_library_continues_from_the_cache(coarse, tmp_path, monkeypatch):
    calls = []

    def counted(*arguments):
        if len(calls) == 4:
            raise KeyboardInterrupt
        make_extract(*arguments)
        calls.append(arguments)

    monkeypatch.setattr("fvcollapse.studies.cache.make_extract", counted)
    question = PlannedQuestion((coarse,), planned=short_cases(coarse))
    with pytest.raises(KeyboardInterrupt):
        build_library(question, Runner(tmp_path), ["cohesion"], draws=4)
    calls.clear()
    calls.extend([None] * 5)  # past the interruption
    runner = Runner(tmp_path)
    found = build_library(question, runner, ["cohesion"], draws=4)
    assert (
        len(runner.asked) == 2 + 4 + 8
    )  # grids, draws, levels of cohesion and one on the finer grid
    assert len(runner.computed) == len(calls) - 5 == 14 - 4
    again = Runner(tmp_path)
    same = build_library(question, again, ["cohesion"], draws=4)
    assert not again.computed
    assert (same.samples == found.samples).all()
    assert found.responses["cohesion"][0].differences.any()


def test_a_failed_run_is_reported_and_not_repeated_within_a_call(coarse, tmp_path, monkeypatch):
    def fails(case, *arguments):
        if case.effects.cohesion is not None:
            raise NumericalError("it blew up")
        make_extract(case, *arguments)

    monkeypatch.setattr("fvcollapse.studies.cache.make_extract", fails)
    question = PlannedQuestion((coarse,), planned=short_cases(coarse))
    found = build_library(question, Runner(tmp_path), ["cohesion", "bed_friction"], draws=4)
    assert "it blew up" in found.left_out["cohesion"]
    assert set(found.responses) == {"bed_friction"}


def test_observation_of_the_same_flow_costs_no_run(coarse, tmp_path):
    (case,) = short_cases(coarse).values()
    section = {"velocity_ratio": 1.4}
    wanted = {
        view: (coarse, case.replace(**{"effects.transverse_profile": section | {"view": view}}))
        for view in ("average", "wall", "centre")
    }
    runner = Runner(tmp_path)
    seen, failures = runner.observations(wanted)
    assert not failures
    assert len(runner.asked) == len(runner.computed) == 1
    fronts = [seen[view].front[-1, 1] for view in ("wall", "average", "centre")]
    assert fronts == sorted(fronts)
    assert fronts[0] < fronts[2]
