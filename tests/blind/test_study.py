"""The study of the blind check: steps in their order, and answers that are given once."""

import json
from dataclasses import replace

import pytest
from report_example import example

from fvcollapse.diagnosis.verdict_model import VerdictModel, to_json
from runs.blind import study
from runs.blind.study import STEPS, main


def test_the_steps_are_those_of_an_honest_check():
    assert list(STEPS) == ["training", "fit", "make", "answer", "reduce", "score", "restamp"]


@pytest.mark.parametrize(
    ("step", "problem"),
    [
        ("fit", "no such file"),
        ("score", "no such file"),
        ("answer", "no cases"),
        ("reduce", "no cases"),
    ],
)
def test_a_step_without_the_one_before_is_refused(step, problem, tmp_path, capsys):
    (tmp_path / "distances.json").write_text("{}")
    assert main([step, "--out", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert problem in capsys.readouterr().err


def test_a_suite_is_answered_once(tmp_path, capsys):
    (tmp_path / "answers.json").write_text("{}")
    assert main(["answer", "--out", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert "answered once" in capsys.readouterr().err


def test_the_last_experiment_of_a_case_is_held_out(tmp_path, monkeypatch):
    for name in ("case_001/a", "case_001/b", "case_001/c", "case_002/a"):
        (tmp_path / "blind" / name).mkdir(parents=True)
        (tmp_path / "blind" / name / "experiment.toml").write_text("")
    asked = []

    def diagnose(fitted, hold_out, folder, **options):
        asked.append(([path.name for path in fitted], [path.name for path in hold_out]))
        return example("effect")

    monkeypatch.setattr(study, "diagnose", diagnose)
    assert main(["reduce", "--out", str(tmp_path), "--tables", str(tmp_path)]) == 0
    assert asked == [(["a", "b"], ["c"])]  # a case of one experiment has none to hold out
    found = json.loads((tmp_path / "reductions.json").read_text())
    assert set(found) == {"case_001"}
    assert set(found["case_001"]["reduction"]) == {*("predicted", "actual", "winner", "runner_up")}


def test_a_layer_is_restamped_with_a_reason(tmp_path, capsys):
    layer = tmp_path / "layer.json"
    model = replace(VerdictModel.load(), solver="0.1.0+0123456789ab", about={"cases": 3})
    model.save(layer)
    text = layer.read_text()
    call = ["restamp", "--layer", str(layer), "--note"]
    assert main([*call, "  "]) == 2
    assert "--note: found none; allowed: why both solvers give the same numbers" in (
        capsys.readouterr().err
    )
    assert layer.read_text() == text
    assert main([*call, "only comments differ"]) == 0
    again = VerdictModel.load(layer)
    assert again.is_of_this_solver
    note = {"from": "0.1.0+0123456789ab", "note": "only comments differ"}
    assert again.about == {"cases": 3, "restamped": [note]}
    assert to_json(replace(again, solver=model.solver, about=model.about)) == text
