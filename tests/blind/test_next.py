"""The next experiment: planned and answered without a label, as the diagnosis ranks it."""

import json
import subprocess
import sys
from types import SimpleNamespace

import pytest
from toy_laboratory import ToyRunner, film

from fvcollapse.blind import next_plan
from fvcollapse.blind.next_answers import keep_next_answers, together
from fvcollapse.blind.next_plan import candidates_of, keep_plans, one_of
from fvcollapse.blind.next_scores import read_next_answers
from fvcollapse.blind.set_ups import SET_UPS, varied
from fvcollapse.diagnosis.next_candidates import Candidate
from fvcollapse.diagnosis.next_experiment import Choice
from fvcollapse.errors import NumericalError

FIRST = "slope16_width10"
OPTIONS = {"effects": ("lateral_friction", "cohesion", "gate"), "draws": 8, "controls": True}
NARROW = {"geometry.channel_width": 0.05}
STEEP = {"geometry.slope_angle_deg": 22.0}


# -- plans -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """Folder, plan and answers of a case of two experiments with a control, and the files that were opened for them.

    Films of two candidates show the same cause.
    """
    folder, opened = tmp_path_factory.mktemp("toy"), []
    case, hidden = folder / "suite" / "case_001", {"cohesion": {"kappa_0": 20.0}}
    film(case / FIRST, effects=hidden, seed=1)
    film(case / "slope20_width10", slope=20.0, effects=hidden, seed=2)
    film(case / "controls" / "control_slope16_width10", seed=3)
    films = folder / "films" / "case_001"
    film(films / "width_0.05", width=0.05, effects=hidden, seed=4)
    film(films / "slope_angle_22", slope=22.0, effects=hidden, seed=5)
    for place in (case, case / FIRST, films, folder / "suite"):
        (place / "labels.json").write_text("{")  # a careless owner leaves them lying about
    for name in ("plans", "answers"):
        (folder / name).mkdir()
    real = open

    def seen(path, *arguments, **options):
        opened.append(str(path))
        return real(path, *arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        for place in ("builtins.open", "io.open"):
            patch.setattr(place, seen)
        for place in ("next_plan", "next_answers"):
            patch.setattr(f"fvcollapse.blind.{place}.runner_of", lambda options: ToyRunner())
        assert keep_plans([case], folder / "plans", OPTIONS) == {}
        assert keep_next_answers([case], (folder / "films", folder / "answers"), OPTIONS) == {}
    plan, found = (
        json.loads((folder / name / "case_001.json").read_text()) for name in ("plans", "answers")
    )
    return SimpleNamespace(folder=folder, plan=plan, found=found, opened=opened)


def test_a_plan_recommends_what_the_diagnosis_ranks_first(laboratory):
    plan = laboratory.plan
    gains = [about["expected_gain"] for about in plan["candidates"].values()]
    assert gains == sorted(gains, reverse=True)
    assert plan["recommended"] == next(iter(plan["candidates"]))
    assert plan["random"] in plan["candidates"]
    assert {"slope_10", "slope_22", "width_0.05", "width_0.2", "speed_inf", "height_0.21"} == set(
        plan["candidates"]
    )
    parts = {part for name in plan["leading"] for part in name.split("+")}
    assert {"cohesion"} <= parts <= {*OPTIONS["effects"], "none"}
    assert len(plan["leading"]) == 2
    assert sum(plan["first"]["probability"].values()) == pytest.approx(1.0)


def test_a_repeat_is_never_planned():
    def choice(changes, added=()):
        return Choice(
            Candidate(FIRST, changes, ("front",), added), ("gate", "none"), 0.3, 1.0, None
        )

    same = {"geometry.slope_angle_deg": 16.0}  # what was measured already
    found = candidates_of(
        SET_UPS[FIRST], [choice({}, ("volume",)), choice(same), choice(NARROW), choice(STEEP)]
    )
    assert list(found) == ["width_0.05", "slope_22"]
    assert all(
        varied(SET_UPS[FIRST], about["changes"]) != SET_UPS[FIRST] for about in found.values()
    )


def test_the_random_choice_is_of_the_list_and_follows_from_the_name():
    table = dict.fromkeys("abcdef")
    drawn = [one_of(table, f"case_{number:03d}") for number in range(300)]
    assert drawn == [one_of(table, f"case_{number:03d}") for number in range(300)]
    counts = [drawn.count(name) for name in table]
    assert min(counts) > 30
    assert one_of(dict(reversed(table.items())), "case_001") == drawn[1]  # whatever is recommended
    assert one_of({}, "case_001") is None


def test_nothing_to_plan_where_nothing_is_left_to_separate(laboratory, monkeypatch, tmp_path):
    folder = laboratory.folder
    monkeypatch.setattr(next_plan, "runner_of", lambda options: ToyRunner())
    monkeypatch.setattr(next_plan, "choices", lambda *_: [])
    keep_plans([folder / "suite" / "case_001"], tmp_path, OPTIONS)
    plan = json.loads((tmp_path / "case_001.json").read_text())
    assert (plan["recommended"], plan["random"], plan["candidates"]) == (None, None, {})


def test_a_case_that_cannot_be_compared_is_told(laboratory, monkeypatch, tmp_path):
    folder = laboratory.folder

    def fail(*_):
        raise NumericalError("no pivot")

    monkeypatch.setattr(next_plan, "plan_of", fail)
    assert set(keep_plans([folder / "suite" / "case_001"], tmp_path, OPTIONS)) == {"case_001"}
    assert not list(tmp_path.iterdir())


# -- answers ---------------------------------------------------------------------------------------------------------


def test_answers_are_to_the_first_and_one_next_experiment(laboratory, tmp_path):
    plan, found = laboratory.plan, laboratory.found
    assert set(found) == {"width_0.05", "slope_angle_22"}
    entry = together(plan, found)
    assert entry["added"]["width_0.05"]["answer"] == found["width_0.05"]
    assert entry["added"]["height_0.21"]["answer"] is None  # it was not filmed
    assert "changes" not in entry["added"]["width_0.05"]
    json.loads(json.dumps(entry, allow_nan=False))  # a gate that is removed at once has no number
    path = tmp_path / "answers.json"
    path.write_text(json.dumps({"case_001": entry}))
    assert read_next_answers(path, {"case_001": {}})["case_001"]["first"] == plan["first"]
    # what the narrow channel shows is an answer of its own
    assert found["width_0.05"]["probability"] != plan["first"]["probability"]
    best = max(found["width_0.05"]["probability"], key=found["width_0.05"]["probability"].get)
    assert best == "cohesion"


def test_plans_and_answers_open_no_file_of_labels(laboratory):
    read = [path for path in laboratory.opened if str(laboratory.folder) in path]
    assert any(path.endswith("profiles.csv") for path in read)
    assert not [path for path in read if "labels" in path]
    assert not [path for path in read if "slope20" in path]  # the case has a second experiment


def test_the_answerer_does_not_know_the_code_that_reads_labels():
    modules = "fvcollapse.blind.next_plan, fvcollapse.blind.next_answers"
    forbidden = [f"fvcollapse.blind.{name}" for name in ("labels", "generator", "make", "truth")]
    program = f"import {modules}, sys; sys.exit(any(name in sys.modules for name in {forbidden}))"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
