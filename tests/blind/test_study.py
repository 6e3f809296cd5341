"""The study of the blind check: steps in their order, and answers that are given once."""

import json
import shutil
from dataclasses import replace

import pytest
from blind_suite import keep_wedge, make_wedges
from report_example import example

from fvcollapse.blind import next_films
from fvcollapse.diagnosis.verdict_model import VerdictModel, to_json
from fvcollapse.errors import NumericalError
from runs.blind import held_out, next_value, study
from runs.blind.study import STEPS, main


def test_the_steps_are_those_of_an_honest_check():
    assert list(STEPS) == [
        *("training", "fit", "make", "answer", "reduce", "score"),
        *("next", "score_next", "losses", "restamp"),
    ]


@pytest.mark.parametrize(
    ("step", "problem"),
    [
        ("fit", "no such file"),
        ("score", "no such file"),
        ("answer", "no cases"),
        ("reduce", "no cases"),
        ("next", "no cases"),
        ("score_next", "no such file"),
    ],
)
def test_a_step_without_the_one_before_is_refused(step, problem, tmp_path, capsys):
    (tmp_path / "distances.json").write_text("{}")
    assert main([step, "--out", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert problem in capsys.readouterr().err


@pytest.mark.parametrize(
    ("step", "file"), [("answer", "answers.json"), ("next", "next_answers.json")]
)
def test_a_suite_is_answered_once(step, file, tmp_path, capsys):
    (tmp_path / file).write_text("{}")
    assert main([step, "--out", str(tmp_path), "--tables", str(tmp_path)]) == 2
    assert "answered once" in capsys.readouterr().err


def test_a_suite_may_begin_by_some_experiments_only(tmp_path, monkeypatch, capsys):
    drawn = []

    def make(count, folder, draw, resources):
        drawn.append((draw.style.designs, draw.per_world))
        folder.mkdir()
        (folder / "SEAL.json").write_text("{}")
        return folder / "SEAL.json"

    monkeypatch.setattr(study, "make", make)
    call = ["make", "--out", str(tmp_path), "--tables", str(tmp_path / "tables"), "--first"]
    assert main([*call, "slope13_width07", "slope08_width14"]) == 0
    designs = (
        ("slope08_width14", "slope13_width14", "slope18_width14"),
        ("slope13_width07", "slope13_width07_tall"),
    )
    assert drawn == [(designs, 3)]
    assert (tmp_path / "tables" / "SEAL.json").exists()
    assert main([*call, "slope99_width99"]) == 2
    assert "--first: found slope99_width99; allowed: slope04_width07" in capsys.readouterr().err
    assert main([*call, "slope13_width07", "--per-world", "0"]) == 2
    assert "--per-world: found 0; allowed: 1, 2, 3, …" in capsys.readouterr().err


def test_the_last_experiment_of_a_case_is_held_out(tmp_path, monkeypatch):
    places = ("case_001/a", "case_001/b", "case_001/c", "case_001/controls/control_a", "case_002/a")
    for name in places:
        (tmp_path / "blind" / name).mkdir(parents=True)
        (tmp_path / "blind" / name / "experiment.toml").write_text("")
    asked = []

    def diagnose(fitted, hold_out, controls, **options):
        asked.append([[path.name for path in part] for part in (fitted, hold_out, controls)])
        return example("effect")

    monkeypatch.setattr(held_out, "diagnose", diagnose)
    for _ in range(2):  # what has been diagnosed is not diagnosed again
        assert main(["reduce", "--out", str(tmp_path), "--tables", str(tmp_path)]) == 0
    assert asked == [[["a", "b"], ["c"], ["control_a"]]]  # a case of one has none to hold out
    found = json.loads((tmp_path / "reductions.json").read_text())
    assert set(found) == {"case_001"}
    assert set(found["case_001"]["reduction"]) == {
        *("predicted", "actual", "winner", "runner_up", "winner_left", "runner_up_left")
    }
    scores = held_out.scores_of_reductions(tmp_path / "reductions.json")
    assert (scores["diagnoses"], scores["named"]) == (1, 1)
    assert scores["winner_leaves_less"]["value"] == 1.0


def test_a_diagnosis_whose_runs_fail_is_told_and_left_out(tmp_path, monkeypatch, capsys):
    for name in ("a", "b"):
        (tmp_path / "blind" / "case_001" / name).mkdir(parents=True)
        (tmp_path / "blind" / "case_001" / name / "experiment.toml").write_text("")

    def diagnose(*_, **__):
        raise NumericalError("no pivot")

    monkeypatch.setattr(held_out, "diagnose", diagnose)
    assert main(["reduce", "--out", str(tmp_path), "--tables", str(tmp_path)]) == 0
    assert "case_001: " in capsys.readouterr().err
    assert json.loads((tmp_path / "reductions.json").read_text()) == {}


def test_the_value_of_the_next_experiment_from_the_seal_to_the_scores(tmp_path, monkeypatch):
    """Planned and answered without the labels, by a diagnosis in a few lines; scored with them."""
    make_wedges(monkeypatch, tmp_path / "blind")
    (tmp_path / "tables").mkdir()
    shutil.copyfile(tmp_path / "blind" / "SEAL.json", tmp_path / "tables" / "SEAL.json")
    sure, torn = {"gate": 0.9, "none": 0.1}, {"gate": 0.5, "none": 0.5}
    first = {"verdict": "effect", "probability": torn, "set": ["gate", "none"]}
    about = {"words": "narrower", "expected_gain": 0.4, "separates": ["gate", "none"]}

    def keep_plans(cases, out, options):
        assert options["controls"]
        plan = {"first": first, "leading": ["gate", "none"]}
        plan |= {"recommended": "width_0.05", "random": "width_0.05"}
        changes = {"geometry.channel_width": 0.05}
        plan |= {"candidates": {"width_0.05": about | {"changes": changes}}}
        for case in cases[1:]:  # the first cannot be compared
            (out / f"{case.name}.json").write_text(json.dumps(plan))
        return {cases[0].name: NumericalError("no pivot")}

    def answer_batch(films, cases, out, options):
        for case in cases:
            assert (films / case.name / "width_0.05" / "experiment.toml").exists()
            answer = {"width_0.05": first | {"probability": sure}}
            (out / f"{case.name}.json").write_text(json.dumps(answer))
        return {}

    monkeypatch.setattr(next_value, "keep_plans", keep_plans)
    monkeypatch.setattr(next_value, "answer_batch", answer_batch)
    monkeypatch.setattr(next_films, "keep_truth", keep_wedge)
    (tmp_path / "blind.labels.json").chmod(0o600)
    call = ["--out", str(tmp_path), "--tables", str(tmp_path / "tables"), "--workers", "1"]
    assert main(["next", *call]) == 0
    found = json.loads((tmp_path / "tables" / "next_answers.json").read_text())
    assert list(found) == [f"case_00{n}" for n in range(1, 5)]
    assert found["case_001"]["added"] == {}
    assert main(["score_next", *call]) == 0
    scores = json.loads((tmp_path / "tables" / "next_scores.json").read_text())
    assert (scores["sealed_cases"], scores["cases"]) == (4, 4)
    assert scores["nothing_left_to_separate"]["cases"] == 1
    assert scores["all"]["cases"] == 3
    assert scores["all"]["gain"]["entropy"]["recommended"]["value"] == pytest.approx(
        0.531, abs=1e-3
    )
    (tmp_path / "tables" / "next_answers.json").unlink()
    assert main(["next", "--asked", "2", *call]) == 0
    assert main(["score_next", *call]) == 0
    scores = json.loads((tmp_path / "tables" / "next_scores.json").read_text())
    assert (scores["sealed_cases"], scores["cases"], scores["all"]["cases"]) == (4, 2, 1)
    (tmp_path / "tables" / "SEAL.json").write_text((tmp_path / "blind.labels.json").read_text())
    assert main(["score_next", *call]) == 2


def test_whole_diagnoses_are_scored_where_the_name_is_right_too(tmp_path):
    def named(effect, actual, left):
        reduction = {"predicted": 1.0, "actual": actual, "winner": actual, "runner_up": 0.5}
        reduction |= {"winner_left": left, "runner_up_left": 2.0}
        answer = {"verdict": "effect", "probability": {effect: 0.9, "none": 0.1}, "set": [effect]}
        return answer | {"reduction": reduction}

    answered = {"case_001": named("gate", 0.95, 1.0), "case_002": named("viscosity", 0.3, 3.0)}
    (tmp_path / "reductions.json").write_text(json.dumps(answered))
    label = {"cause": "gate", "unknown_kind": None}
    right = next_value.right_names(answered, dict.fromkeys(answered, {"label": label}))
    assert right == ["case_001"]
    every = held_out.scores_of_reductions(tmp_path / "reductions.json")
    own = held_out.scores_of_reductions(tmp_path / "reductions.json", only=right)
    assert (every["diagnoses"], own["diagnoses"]) == (2, 1)
    assert [each["within_narrow"]["value"] for each in (every, own)] == [0.5, 1.0]
    assert [each["winner_leaves_less"]["value"] for each in (every, own)] == [0.5, 1.0]


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
