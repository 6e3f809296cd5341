"""The whole diagnosis by formula, from a call or the command line to a report."""

import csv
import json
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
from toy_laboratory import ToyRunner, film, only_numbers, three_films

import fvcollapse
from fvcollapse import load_case
from fvcollapse.__main__ import main
from fvcollapse.diagnosis import confirmation
from fvcollapse.diagnosis import diagnose as module
from fvcollapse.diagnosis.diagnose import contenders
from fvcollapse.diagnosis.report import findings, read_report
from fvcollapse.diagnosis.report.certainty import certainty
from fvcollapse.diagnosis.report.limits import confirmation_reasons
from fvcollapse.diagnosis.verdict import Verdict

EFFECTS = "lateral_friction,cohesion,gate"
WALLS = {"lateral_friction": {"mu_wall": 0.22, "pressure_ratio": 0.9}}


@pytest.fixture
def by_formula(monkeypatch):
    """Runs are formulas."""
    monkeypatch.setattr(module, "StandingRunner", ToyRunner)


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    return three_films(tmp_path_factory.mktemp("experiments"), effects=WALLS)


def test_the_command_writes_a_report(by_formula, folders, monkeypatch, tmp_path, capsys):
    kept = []
    monkeypatch.setattr(
        module, "report_of", lambda *found: kept.append(found) or findings.report_of(*found)
    )
    filmed = [shutil.copytree(each, tmp_path / each.name) for each in folders]
    for each in filmed:  # what is left are fewer figures to draw
        (each / "volume.csv").unlink()
        (each / "interface.csv").unlink()
    odd = filmed[-1] / "experiment.toml"
    settings = odd.read_text(encoding="utf-8")
    settings = settings.replace("mu_1 = 0.45", "mu_1 = 0.45\nsolid_fraction = 0.3")
    odd.write_text(settings, encoding="utf-8")
    *fitted, held = map(str, filmed)
    out = tmp_path / "out"
    options = ["--effects", EFFECTS, "--hold-out", held, "--out", str(out), "--quiet"]
    options += ["--workers", "1"]
    assert main(["diagnose", *fitted, *options]) == 0
    report = read_report(out)
    assert report.verdict.effects == ["lateral_friction"]
    assert report.verdict.kind == "effect"
    assert report.reduction.fitted.overall.fraction_closed > 0.9
    assert report.reduction.held_out.overall.fraction_closed > 0.9
    assert report.details.confirmation.folds[0].held_out
    assert report.cost.solver_runs > 50
    assert set(report.candidates) == set(EFFECTS.split(","))
    assert report.where
    assert (out / "report.html").stat().st_size > 10_000
    assert list((out / "figures").iterdir())
    printed, told = capsys.readouterr()
    assert "lateral friction" in printed
    (warning,) = report.warnings
    assert (warning.experiment, warning.key, warning.found) == (
        "s16_w0.2",
        "material.solid_fraction",
        "0.3",
    )
    assert told == f"warning: {warning.line()}\n"
    assert str(out / "report.json") in printed
    content = json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert content["experiments"] == ["s10_w0.1", "s16_w0.1"]
    assert content["held_out"] == ["s16_w0.2"]
    check_files_beside(out, report)
    check_a_gap_that_does_not_shrink(kept, report, monkeypatch)
    assert f" --hold-out {held} --effects {EFFECTS} --out {out}" in report.details.made.command
    assumed = {(one.experiment, one.key): one for one in report.details.assumed}
    assert assumed["s16_w0.1", "rheology.grain_diameter"].source == "default of the program"
    assert ("s16_w0.1", "rheology.mu_1") not in assumed  # it is stated


def check_files_beside(out, report):
    """The runs have one row each, and the page counts them; the case of the next experiment can be run."""
    rows = list(csv.DictReader((out / "runs.csv").read_text(encoding="utf-8").splitlines()))
    groups = report.details.runs
    assert len(rows) == sum(one.runs for one in groups) == report.cost.solver_runs
    purposes = {one.purpose for one in groups if one.experiment == "s10_w0.1"}
    assert {"model as given", "finer grid", "other parameters", "cohesion"} <= purposes
    if report.next_experiment is not None:
        case = load_case(out / "next_experiment.toml")
        for key, value in report.next_experiment.set_up.items():
            section, _, name = key.partition(".")
            assert getattr(getattr(case, section), name) == value
    assert (out / "next_experiment.toml").exists() == (report.next_experiment is not None)


def check_a_gap_that_does_not_shrink(kept, report, monkeypatch):
    """It confirms nothing: the winner beats the runner-up, but only since that one is worse still."""
    ((analysis, answer, ladder, *_),) = kept
    assert report.details.confirmation.wording == "confirmed"
    told = {(report.held_out[0], True): {"winner": -0.4, "runner_up": -0.9}}
    monkeypatch.setattr(confirmation, "fold_fractions", lambda ladder: told)
    tests = confirmation.confirm(analysis, answer, ladder)
    assert tests.strength == "consistent with"
    reasons = confirmation_reasons(tests)
    assert "the gap of an experiment held out does not shrink" in reasons


def test_coarse_cells_are_told_and_the_verdict_layer_is_not_asked(by_formula, folders, capsys):
    report = fvcollapse.diagnose(folders[:1], effects=["cohesion"], draws=6, cell_size=0.02)
    assert report.details.coarse_cells == pytest.approx({folders[0].name: 0.14 / 12})
    assert all(one.conformal_p is None for one in report.details.hypotheses.values())
    assert "--cell-size: found 0.02 m; expected: at most 0.0117 m" in capsys.readouterr().err
    assert "The cells of 2 cm are coarser" in certainty(report)


def test_nothing_hidden_needs_no_effect(by_formula, tmp_path):
    folder = film(tmp_path / "plain")
    report = fvcollapse.diagnose([folder], effects=("cohesion", "gate"), draws=8)
    assert report.verdict.kind == "none"
    assert report.verdict.effects == []
    assert report.reduction is None
    assert report.details.confirmation is None
    assert [rung.model for rung in report.details.ladder] == ["baseline", "recalibrated"]
    assert any("No experiment was held out" in line for line in report.details.limits)


def test_a_few_numbers_are_not_judged_by_a_layer_fitted_to_films(by_formula, tmp_path):
    rows = "runout,0.7,0.01,value", "final_height,0.11,0.005,value"
    folder = only_numbers(film(tmp_path / "numbers"), *rows)
    report = fvcollapse.diagnose([folder], effects=("lateral_friction", "gate"), draws=8)
    assert any("so few measured values" in line for line in report.details.limits)
    assert all(one.conformal_p is None for one in report.details.hypotheses.values())
    assert max(report.verdict.probability.values()) <= 0.9


def test_controls_are_told(by_formula, tmp_path):
    controls = [
        film(tmp_path / f"c{n}", slope, swelling=0.05, seed=n)
        for n, slope in enumerate((10.0, 16.0))
    ]
    one = film(tmp_path / "one", 13.0, swelling=0.05, seed=5)
    out, options = tmp_path / "out", {"effects": ("cohesion", "gate"), "draws": 8, "workers": 1}
    report = fvcollapse.diagnose([one], controls=controls, folder=out, **options)
    assert report.verdict.kind == "none"
    assert report.experiments == ["one"]
    assert any("controls (c0, c1)" in line for line in report.details.limits)
    assert set(report.details.expected) == set(report.by_observable)  # what was taken off is told
    assert "learned from the control experiments" in (out / "report.html").read_text(
        encoding="utf-8"
    )
    for name, parts in report.details.budget.items():  # sources of a gap add up to its uncertainty
        total = np.sqrt(sum(sd**2 for sd in parts.values()))
        assert total == pytest.approx(report.by_observable[name].combined_uncertainty, rel=1e-3)


def test_the_truth_is_not_read(by_formula, tmp_path):
    """A section [truth], right or wrong, changes nothing; nor does a second call."""
    plain = film(tmp_path / "a" / "same", effects=WALLS, seed=3)
    told = film(tmp_path / "b" / "same", effects=WALLS, seed=3)
    path = told / "experiment.toml"
    path.write_text(path.read_text() + '\n[truth]\ncause = "gate"\n', encoding="utf-8")
    one, other = (fvcollapse.diagnose([each], effects=("gate",), draws=8) for each in (plain, told))
    assert one.verdict == other.verdict
    assert one.where == other.where
    assert one.reduction == other.reduction


def answer(kind, effects, probability):
    return Verdict(kind, effects, (), probability, tuple(probability), {})


class Evidences:
    def __init__(self, *names):
        self.evidence = self
        self.hypotheses = dict.fromkeys(names)


def test_who_climbs_the_ladder():
    found = Evidences("a", "b", "a+b", "none", "unknown")
    chance = {"a": 0.6, "b": 0.2, "a+b": 0.1, "none": 0.05, "unknown": 0.05}
    assert contenders(found, answer("effect", ("a",), chance)) == ("a", "b")
    assert contenders(found, answer("several", ("a", "b"), chance)) == ("a+b", "a")
    paired = {"a": 0.5, "a+b": 0.3, "b": 0.2}  # the pair holds the winner: no rival
    assert contenders(found, answer("effect", ("a",), paired)) == ("a", "b")
    assert contenders(found, answer("none", (), chance)) == (None, None)
    assert contenders(found, answer("unknown", (), chance)) == ("a", "b")


@pytest.mark.parametrize(
    "lacking", ["nothing", "no controls", "values", "effects", "model", "fine cells"]
)
def test_the_verdict_layer_is_asked_for_what_it_was_fitted_to(lacking, monkeypatch):
    layer = SimpleNamespace(judges=lambda evidence: lacking != "effects")
    loaded = None if lacking == "model" else layer
    asked = []
    load = lambda controls: asked.append(controls) or loaded  # noqa: E731
    monkeypatch.setattr(module.VerdictModel, "load", staticmethod(load))
    kind = np.full(20 if lacking == "values" else 200, "value")
    controls = () if lacking == "no controls" else (object(),)  # each has a layer
    question = SimpleNamespace(coarse_cells={"film": 0.0117} if lacking == "fine cells" else {})
    points = SimpleNamespace(kind=kind)
    analysis = SimpleNamespace(controls=controls, points=points, evidence=None, question=question)
    expected = layer if lacking in ("nothing", "no controls") else None
    assert module.verdict_model_for(analysis) is expected
    assert all(each == bool(controls) for each in asked)


# -- bad input -----------------------------------------------------------------------------------


def refused(capsys, *arguments):
    """The one line that a call leaves on stderr."""
    assert main(["diagnose", *map(str, arguments)]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    return told.err


def test_bad_input_is_one_line(folders, tmp_path, capsys):
    one, out = folders[0], tmp_path / "out"
    assert "--effects: found 'walls'" in refused(capsys, one, "--effects", "walls", "--out", out)
    assert "it is given twice" in refused(capsys, one, one, "--out", out)
    assert "it is given twice" in refused(capsys, one, "--controls", one, "--out", out)
    assert "--seed" in refused(capsys, one, "--seed", "-1", "--out", out)
    assert "no such file" in refused(capsys, tmp_path / "none", "--out", out)
    assert "--cell-size: found 0.1;" in refused(capsys, one, "--cell-size", "0.1", "--out", out)
    assert "--workers" in refused(capsys, one, "--workers", "0", "--out", out)
    case = tmp_path / "case.toml"
    case.write_text("[geometry]\nslope = 1\n", encoding="utf-8")
    assert "geometry.slope" in refused(capsys, one, "--case", case, "--out", out)
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    assert "cannot be written" in refused(capsys, one, "--out", blocked / "out")
    assert "--out" in refused(capsys, one)
