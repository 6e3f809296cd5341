"""The study of the blind check: steps in their order, and answers that are given once."""

import json

import pytest
from report_example import example

from runs.blind import study
from runs.blind.study import STEPS, main


def test_the_steps_are_those_of_an_honest_check():
    assert list(STEPS) == ["training", "fit", "make", "answer", "reduce", "score"]


@pytest.mark.parametrize(
    ("step", "problem"),
    [
        ("fit", "no cases"),
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
