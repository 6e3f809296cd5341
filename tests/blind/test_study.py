"""The study of the blind check: steps in their order, and answers that are given once."""

import pytest

from runs.blind.study import STEPS, main


def test_the_steps_are_those_of_an_honest_check():
    assert list(STEPS) == ["training", "fit", "make", "answer", "score"]


@pytest.mark.parametrize(
    ("step", "problem"), [("fit", "no cases"), ("score", "no such file"), ("answer", "no cases")]
)
def test_a_step_without_the_one_before_is_refused(step, problem, tmp_path, capsys):
    (tmp_path / "distances.json").write_text("{}")
    assert main([step, "--out", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert problem in capsys.readouterr().err


def test_a_suite_is_answered_once(tmp_path, capsys):
    (tmp_path / "answers.json").write_text("{}")
    assert main(["answer", "--out", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert "answered once" in capsys.readouterr().err
