"""The seal is opened only for what was sealed, and answers are what the interface says."""

import json
import shutil

import pytest
from blind_suite import make_wedges
from report_example import example

from fvcollapse.__main__ import main
from fvcollapse.blind import calibration, outcomes
from fvcollapse.blind.answers import answer_of_report
from fvcollapse.blind.score import score
from fvcollapse.blind.score_table import table
from fvcollapse.errors import InputError

RIGHT = {
    "case_001": {"verdict": "none", "probability": {"none": 0.9, "gate": 0.1}, "set": ["none"]},
    "case_002": {
        "verdict": "unknown",
        "probability": {"unknown": 0.7, "gate": 0.3},
        "set": ["unknown", "gate"],
    },
    "case_003": {
        "verdict": "effect",
        "probability": {"gate": 0.8, "none": 0.2},
        "set": ["gate"],
        "reduction": {"predicted": 0.5, "actual": 0.6, "runner_up": 0.2},
    },
    "case_004": {
        "verdict": "several",
        "probability": {"cohesion+gate": 0.6, "gate": 0.4},
        "set": ["cohesion+gate", "gate"],
    },
}


@pytest.fixture(scope="module", autouse=True)
def few_samples():
    """Of the bootstrap, whose intervals no test here looks at (`test_metrics.py` does)."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (outcomes, calibration):
            patch.setattr(module, "SAMPLES", 40)
        yield


@pytest.fixture(scope="module")
def whole_suite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        make_wedges(patch, folder / "suite")
    return folder


@pytest.fixture
def suite(whole_suite, tmp_path):
    return shutil.copytree(whole_suite, tmp_path, dirs_exist_ok=True)


def scored(suite, answers, **options):
    path = suite / "answers.json"
    path.write_text(json.dumps(answers))
    return score(suite / "suite", path, suite / "suite.labels.json", **options)


def test_right_answers(suite):
    scores = scored(suite, RIGHT)
    assert scores["data_checked"] == 4
    assert scores["seal"] == json.loads((suite / "suite" / "SEAL.json").read_text())["seal"]
    assert scores["all"]["top_1"]["value"] == 1.0
    assert scores["all"]["set_holds_truth"]["value"] == 1.0
    assert scores["all"]["mean_set_size"]["value"] == 1.5
    assert scores["alarms"]["false_alarm_on_none"]["value"] == 0.0
    assert scores["reduction"]["winner_beats_runner_up"]["n"] == 1
    assert scores["baselines"]["always_lateral_friction"]["top_1"]["value"] == 0.0
    assert scores["baselines"]["always_none"]["top_1"]["value"] == 0.25
    assert "first name right" in table(scores)


def test_half_for_one_of_two_causes(suite):
    answers = RIGHT | {"case_004": RIGHT["case_003"]}
    scores = scored(suite, answers)
    assert scores["all"]["top_1"]["value"] == pytest.approx(3.5 / 4)
    assert scores["by_class"]["pair"]["top_1"]["value"] == 0.5


def test_parameters_are_compared_with_what_was_hidden(suite):
    labels = json.loads((suite / "suite.labels.json").read_text())["cases"]
    drawn = labels["case_003"]["label"]["effects"]["gate"]["section"]
    found = {
        name: {"value": value, "low": value - 0.1, "high": value + 0.1}
        for name, value in drawn.items()
    }
    answer = RIGHT["case_003"] | {"parameters": {"gate": found}}
    scores = scored(suite, RIGHT | {"case_003": answer})
    assert scores["parameters"]["interval_90_covers"]["value"] == 1.0
    assert scores["parameters"]["interval_90_covers"]["n"] == len(drawn)
    assert scores["parameters"]["z_mean"]["value"] == pytest.approx(0.0, abs=1e-9)


def test_answers_of_others_are_compared_case_by_case(suite):
    wrong = {name: RIGHT["case_001"] for name in RIGHT}
    (suite / "simple.json").write_text(json.dumps(wrong))
    scores = scored(suite, RIGHT, against=[suite / "simple.json"])
    other = scores["baselines"]["simple"]
    assert other["top_1"]["value"] == 0.25
    assert other["mcnemar"]["only_first"] == 3


def test_effects_that_data_can_tell_apart_are_scored_by_themselves(suite):
    (suite / "d.json").write_text(json.dumps({"case_003": 3.5}))
    scores = scored(suite, RIGHT, separability=suite / "d.json")
    assert scores["by_separability"]["separable"]["top_1"]["n"] == 1
    assert "not_separable" not in scores["by_separability"]


def test_a_label_that_was_changed_is_refused(suite):
    path = suite / "suite.labels.json"
    plan = json.loads(path.read_text())
    plan["cases"]["case_001"]["label"]["cause"] = "gate"
    path.write_text(json.dumps(plan))
    with pytest.raises(InputError, match=r"cases\.case_001: found a label that is not the sealed"):
        scored(suite, RIGHT)


def test_data_that_were_changed_are_refused(suite):
    path = next((suite / "suite" / "case_002").glob("*/front.csv"))
    path.write_text(path.read_text() + "9,0.5\n")
    with pytest.raises(InputError, match="other data than sealed"):
        scored(suite, RIGHT)


def test_a_seal_that_was_changed_is_refused(suite):
    path = suite / "suite" / "SEAL.json"
    seal = json.loads(path.read_text())
    path.write_text(json.dumps(seal | {"seal": "0" * 64}))
    with pytest.raises(InputError, match="a hash that is not of its cases"):
        scored(suite, RIGHT)
    del seal["cases"]["case_001"]
    path.write_text(json.dumps(seal))
    with pytest.raises(InputError, match="other cases than the seal"):
        scored(suite, RIGHT)


def changed(**keys):
    return RIGHT | {"case_001": RIGHT["case_001"] | keys}


@pytest.mark.parametrize(
    ("answers", "problem"),
    [
        ([], "file: found the list"),
        ({}, "case_001: found no answer"),
        (RIGHT | {"case_01": {}}, "case_01: found no such case"),
        (RIGHT | {"case_001": 3}, "case_001: found 3; allowed: a table"),
        (changed(verdict="perhaps"), r'case_001\.verdict: found the string "perhaps"'),
        (
            changed(probability={}),
            r"case_001\.probability: found a table; allowed: a table of length >= 1",
        ),
        (changed(probability={"none": 0.5}), "a sum of 0.5"),
        (changed(probability={"none": 1.5, "gate": -0.5}), r"probability\.none: found 1.5"),
        (changed(probability={"gates": 1.0}), r"probability\.gates: found no such name"),
        (changed(probability={"gate+cohesion": 1.0}), "no such name"),
        (changed(probability={"none": True}), "found the boolean true; allowed: a number"),
        (changed(set="none"), r'case_001\.set: found the string "none"; allowed: a list'),
        (changed(set=["nothing"]), r"case_001\.set"),
        (changed(reduction={"actual": 0.5}), r"case_001\.reduction"),
        (changed(parameters={"gate": {"speed": {"value": 1.0}}}), r"case_001\.parameters"),
    ],
)
def test_answers_that_are_none_are_refused_in_one_line(suite, answers, problem):
    with pytest.raises(InputError, match=problem):
        scored(suite, answers)


def test_the_command_writes_scores(suite, capsys):
    (suite / "answers.json").write_text(json.dumps(RIGHT))
    command = ["blind", "score", str(suite / "suite"), str(suite / "answers.json")]
    command += ["--labels", str(suite / "suite.labels.json")]
    assert main(command) == 0
    printed = json.loads(capsys.readouterr().out)
    assert main([*command, "--json", str(suite / "scores.json")]) == 0
    assert json.loads((suite / "scores.json").read_text()) == printed
    assert "truth in the set" in capsys.readouterr().out


def test_the_command_refuses_bad_input(suite, capsys):
    command = ["blind", "score", str(suite / "suite"), str(suite / "missing.json")]
    assert main([*command, "--labels", str(suite / "suite.labels.json")]) == 2
    error = capsys.readouterr().err
    assert "missing.json" in error
    assert error.count("\n") == 1
    assert main(["blind", "make", "--cases", "0", "--out", str(suite / "new")]) == 2
    assert "--cases" in capsys.readouterr().err


def test_a_report_is_an_answer(suite):
    report = example("effect")
    answer = json.loads(json.dumps(answer_of_report(report)))
    effect = report.verdict.effects[0]
    assert answer["verdict"] == "effect"
    assert answer["set"] == report.verdict.set
    assert set(answer["parameters"]) == {effect}
    winner = next(rung for rung in report.details.ladder if rung.model == "winner")
    assert answer["reduction"]["actual"] == winner.fitted.fraction_closed
    assert answer["reduction"]["winner"] == winner.held_out.fraction_closed
    scores = scored(suite, dict.fromkeys(RIGHT, answer))
    assert scores["all"]["top_1"]["value"] < 0.5
    assert "reduction" not in answer_of_report(example("none"))
