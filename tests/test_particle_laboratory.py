"""The study of the particle laboratory: what it measures, writes and draws; the diagnosis has tests of its own."""

import json
from argparse import Namespace
from types import SimpleNamespace

import numpy as np
import pytest
from toy_laboratory import collapse, film

from fvcollapse import load_case, load_experiment
from fvcollapse.measure.align import align
from fvcollapse.simulation import Simulation
from plots import particle_laboratory as figures
from runs.particle_laboratory import mobilised, study
from runs.table import write_table


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A laboratory of the same form, with formulas for grains."""
    root = tmp_path_factory.mktemp("laboratory")
    for name, slope in (("control_10deg", 10.0), ("control_16deg", 16.0)):
        film(root / "labelled" / name, slope)
    for name in study.LABELLED:
        film(root / "labelled" / name, 16.0, effects={"cohesion": {"kappa_0": 20.0}})
    for name in ("b02", "b01"):
        film(root / "blind" / name, 13.0)
    (root / "blind" / "SEAL.txt").write_text("b01 0123\n", encoding="utf-8")
    return root


def options(data, out):
    return Namespace(
        data=data, out=out / "out", tables=out, cache=out / "cache", workers=1, cell_size=None
    )


def test_baseline_holds_what_is_known_and_nothing_else():
    case = load_case(study.BASELINE)
    law = case.rheology
    assert (law.mu_1, law.mu_2, law.I_0) == (0.448, 0.797, 0.5)
    assert case.boundary.mu_bed == np.inf
    assert case.boundary.mu_back_wall == 0.5
    assert case.effects == type(case.effects)()


def test_measures_of_a_known_difference(data):
    one = load_experiment(data / "labelled" / "control_10deg")
    case = one.case(load_case(study.BASELINE)).replace(**{"grid.cell_size": 0.004})
    same = study.measures(align(collapse(case.replace(**{"rheology.mu_1": 0.45})), one))
    pairs = align(collapse(case.replace(**{"rheology.mu_1": 0.40})), one)
    other = study.measures(pairs)
    assert other["front_difference"] == pytest.approx(
        other["front_simulated"] - other["front_measured"], abs=2e-4
    )
    assert other["front_difference"] > same["front_difference"] + 0.02
    assert not other["passed"]
    final = next(pair for pair in pairs if pair.name == "profiles")
    last = final.time == final.time[-1]
    expected = np.sqrt(np.mean((final.simulated - final.measured)[last] ** 2))
    assert other["final_thickness_rms"] == pytest.approx(expected, abs=1e-5)


def test_curves_can_be_drawn(data, tmp_path, monkeypatch):
    rows, table = [], []
    for name in study.CONTROLS:
        one = load_experiment(data / "labelled" / name)
        pairs = align(collapse(one.case()), one)
        rows += study.curve_rows(name, pairs)
        table.append({"experiment": name, "cell_size": 0.006} | study.measures(pairs))
    write_table(tmp_path / "curves.csv", rows)
    write_table(tmp_path / "validation.csv", table)
    times = {row["time"] for row in rows if row["observable"] == "profiles"}
    assert len(times) >= study.PROFILES_SHOWN
    monkeypatch.setattr(figures, "SOURCE", tmp_path)
    monkeypatch.setattr(figures, "HERE", tmp_path)
    (tmp_path / "figures").mkdir()
    figures.main()
    drawn = sorted(path.name for path in (tmp_path / "figures").iterdir())
    assert drawn == [
        f"particle_laboratory_{what}.{kind}"
        for what in ("fronts", "profiles")
        for kind in ("png", "txt")
    ]
    caption = (tmp_path / "figures" / "particle_laboratory_fronts.txt").read_text()
    assert "6 mm" in caption
    assert "nothing is tuned" in caption


def test_answers_are_in_the_form_that_is_scored(data, tmp_path, monkeypatch):
    calls = []

    def told(folders, case, **settings):
        calls.append((folders, case, settings))
        settings["folder"].mkdir(parents=True)
        for name in ("report.json", "report.html"):
            (settings["folder"] / name).write_text("{}", encoding="utf-8")
        chance = {"none": 0.75, "gate": 0.25}
        return SimpleNamespace(
            verdict=SimpleNamespace(kind="none", probability=chance, set=["none", "gate"])
        )

    monkeypatch.setattr(study, "diagnose", told)
    study.blind(options(data, tmp_path))
    answers = json.loads((tmp_path / "answers.json").read_text(encoding="utf-8"))
    assert list(answers) == ["b01", "b02"]
    assert answers["b01"] == {
        "verdict": "none",
        "probability": {"none": 0.75, "gate": 0.25},
        "set": ["none", "gate"],
    }
    assert (tmp_path / "out" / "blind" / "b02" / "report.html").exists()
    assert [path.name for path in (tmp_path / "blind" / "b02").iterdir()] == ["report.json"]
    folders, case, settings = calls[0]
    assert folders == [data / "blind" / "b01"]
    assert case == study.BASELINE
    assert [one.name for one in settings["controls"]] == list(study.CONTROLS)
    study.labelled(options(data, tmp_path))
    assert set(json.loads((tmp_path / "labelled" / "answers.json").read_text())) == set(
        study.LABELLED
    )


def test_walls_of_grains_as_slow_as_the_slip_of_the_solver_mobilise_a_root_of_two_less():
    case = load_case(study.BASELINE)
    slip = Simulation(case).constants.balance.slip_min
    field = {"pressure": np.ones((3, 2)), "u": np.full((4, 2), slip), "w": np.zeros((3, 3))}
    assert mobilised.friction(case, field, 0.3) == pytest.approx(0.3 / np.sqrt(2.0))
    field["u"] *= 1e6
    assert mobilised.friction(case, field, 0.3) == pytest.approx(0.3)
