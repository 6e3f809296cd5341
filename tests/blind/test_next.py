"""The next experiment: planned without a label, measured with the hidden cause in it, answered, scored."""

import json
import subprocess
import sys
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest
from blind_suite import CLASSES, keep_wedge, make_wedges, wedge
from toy_laboratory import ToyRunner, film

from fvcollapse.blind import make as making
from fvcollapse.blind import next_films, next_plan
from fvcollapse.blind.labels import read_labels
from fvcollapse.blind.next_answers import keep_next_answers, together
from fvcollapse.blind.next_films import film_next
from fvcollapse.blind.next_plan import candidates_of, keep_plans, one_of
from fvcollapse.blind.next_scores import (
    next_scores,
    over_worlds,
    read_next_answers,
)
from fvcollapse.blind.set_ups import SET_UPS, film_of, settings_text, varied
from fvcollapse.diagnosis.next_candidates import Candidate
from fvcollapse.diagnosis.next_experiment import Choice
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import InputError, NumericalError
from fvcollapse.measure.experiment import load_experiment

FIRST = "slope16_width10"
OPTIONS = {"effects": ("lateral_friction", "cohesion", "gate"), "draws": 8, "controls": True}
NARROW = {"geometry.channel_width": 0.05}
STEEP = {"geometry.slope_angle_deg": 22.0}
AT_ONCE = {"gate.speed": inf, "gate.time_constant": 0.0}
TALL = {"geometry.height_0": 0.21}


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


# -- films -----------------------------------------------------------------------------------------------------------


def test_another_set_up_is_filmed_as_long_as_its_collapse_takes():
    first = SET_UPS["slope13_width14"]
    assert varied(first, {"geometry.channel_width": 0.07}) == first._replace(width=0.07)
    assert varied(first, {"geometry.slope_angle_deg": 18.0})[:4] == SET_UPS["slope18_width14"][:4]
    steep = varied(SET_UPS["slope20_width10"], {"geometry.slope_angle_deg": 24.0})
    assert (steep.end, steep.reach) == (2.08, 2.0)  # beyond the steepest film, in proportion
    tall = varied(first, TALL)
    assert tall.end == pytest.approx(1.2 * 1.5**0.5, abs=0.01)
    assert tall.reach == pytest.approx(0.2 + 1.5 * 0.85, abs=0.01)
    assert varied(first, AT_ONCE) == first._replace(speed=inf)
    for one in SET_UPS.values():
        if one.height == 0.14:
            assert film_of(one.slope, one.height) == pytest.approx((one.end, one.reach - 0.2))


def test_what_is_stated_of_another_set_up_is_an_experiment(tmp_path):
    (tmp_path / "front.csv").write_text("t_s,x_front_m\n0,0.2\n0.1,0.3\n")
    set_up = varied(SET_UPS[FIRST], NARROW | STEEP | AT_ONCE | TALL)
    (tmp_path / "experiment.toml").write_text(settings_text(set_up, "careful"))
    case = load_experiment(tmp_path).case()
    geometry = case.geometry
    assert (geometry.channel_width, geometry.slope_angle_deg, geometry.height_0) == (0.05, 22, 0.21)
    assert case.gate.speed == inf


@pytest.fixture
def wedges(tmp_path, monkeypatch):
    """A sealed suite, a plan of every case, and the calls for truths."""
    make_wedges(monkeypatch, tmp_path / "suite")
    calls = []

    def keep(case_text, forces, path):
        calls.append((case_text, forces, path))
        keep_wedge(case_text, forces, path)

    monkeypatch.setattr(next_films, "keep_truth", keep)
    monkeypatch.setattr(making, "view_of", wedge)
    (tmp_path / "plans").mkdir()
    plan = {"candidates": {"width_0.05": {"changes": NARROW}, "speed_inf": {"changes": AT_ONCE}}}
    for number in range(1, len(CLASSES) + 1):
        (tmp_path / "plans" / f"case_{number:03d}.json").write_text(json.dumps(plan))
    return tmp_path, calls


def film_wedges(folder):
    return film_next(
        folder / "suite", folder / "suite.labels.json", folder / "plans", folder / "films"
    )


def test_the_sealed_world_measures_what_was_planned(wedges):
    folder, calls = wedges
    assert film_wedges(folder) == {}
    films = {path.parent for path in (folder / "films").rglob("experiment.toml")}
    assert len(films) == len(calls) == 2 * len(CLASSES)
    for one in films:
        experiment = load_experiment(one)
        assert set(experiment.curves) == {"front", "profiles", "volume", "interface"}
        case = experiment.case()
        narrow = one.name == "width_0.05"
        assert case.geometry.channel_width == (0.05 if narrow else case.geometry.channel_width)
        assert (case.gate.speed == inf) != narrow
    assert not (folder / "suite.labels.json.next").exists()
    film_wedges(folder)
    assert len(calls) == 2 * len(CLASSES)  # what is there stays


def test_the_cause_and_the_world_of_the_case_are_in_its_next_experiment(wedges):
    folder, calls = wedges
    film_wedges(folder)
    entries = read_labels(folder / "suite.labels.json")["cases"]
    noise = set()
    for text, forces, path in calls:
        label = entries[path.parent.name]["label"]
        hidden = {*label["effects"], *label["world"]["effects"]}
        assert {name for name in CATALOGUE if f"[effects.{name}]" in text} == hidden
        added = label["outside"].get("forces", [])
        assert len(forces) == len(label["world"]["forces"]) + len(added)
        noise.add(text)
    assert len(noise) == len(calls)  # every run has errors of its set-up of its own


def test_no_film_tells_the_cause(wedges):
    folder, _ = wedges
    film_wedges(folder)
    shown = "".join(p.read_text() for p in (folder / "films").rglob("*") if p.is_file())
    for word in (*CATALOGUE, "none", "unknown", "truth", "quantile", "cell_size"):
        if word not in ("gate", "tilt"):  # [gate] is a section of every experiment
            assert word not in shown, word


def test_a_truth_that_cannot_be_computed_is_told(wedges, monkeypatch):
    folder, _ = wedges

    def fail(case_text, forces, path):
        if path.parent.name == "case_002":
            raise NumericalError("no pivot", time=0.1)
        keep_wedge(case_text, forces, path)

    monkeypatch.setattr(next_films, "keep_truth", fail)
    assert {case for case, _ in film_wedges(folder)} == {"case_002"}
    assert not (folder / "films" / "case_002").exists()


def test_other_labels_than_the_sealed_ones_measure_nothing(wedges):
    folder, calls = wedges
    path = folder / "suite.labels.json"
    text = path.read_text().replace('"cause": "gate"', '"cause": "viscosity"')
    path.write_text(text)
    with pytest.raises(InputError, match="not the sealed one"):
        film_wedges(folder)
    assert not calls


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


# -- scores ----------------------------------------------------------------------------------------------------------


def answer(**probability):
    left = 1.0 - sum(probability.values())
    probability = probability | ({"none": left} if left > 1e-9 else {})
    return {
        "verdict": "effect",
        "probability": dict(sorted(probability.items(), key=lambda item: -item[1])),
        "set": list(probability),
    }


def entry(first, recommended, **added):
    table = {
        name: {"words": name, "expected_gain": 0.5 / (n + 1), "separates": [], "answer": each}
        for n, (name, each) in enumerate(added.items())
    }
    return {
        "first": first,
        "leading": ["gate", "cohesion"],
        "added": table,
        "recommended": recommended,
        "random": min(table) if table else None,
    }


def labels(*causes):
    return {
        f"case_{n:03d}": {
            "label": {
                "cause": cause,
                "unknown_kind": None,
                "world": {"name": f"world_{n // 2}"},
            }
        }
        for n, cause in enumerate(causes)
    }


def test_gains_are_those_of_the_answers():
    wrong, right = answer(gate=0.4, cohesion=0.6), answer(gate=0.8, cohesion=0.2)
    cases = labels("gate", "gate", "gate", "viscosity")
    answers = {
        "case_000": entry(wrong, "a", a=right, b=wrong),
        "case_001": entry(wrong, "a", a=wrong, b=right),
        "case_002": entry(right, None),
        "case_003": entry(wrong, "a", a=None, b=right),
    }
    scores = next_scores(cases, answers)
    assert scores["nothing_left_to_separate"] == {"cases": 1, "right": 1.0}
    assert scores["not_compared"] == 1
    assert scores["candidates"] == 2.0
    every = scores["all"]
    assert every["cases"] == 2
    assert every["before"]["right"]["value"] == 0.0
    gain = {name: every["gain"]["right"][name]["value"] for name in every["gain"]["right"]}
    assert gain == {"recommended": 0.5, "random": 0.5, "drawn": 0.5, "best": 1.0}
    sure = {name: every["gain"]["probability"][name]["value"] for name in gain}
    assert sure == pytest.approx({"recommended": 0.2, "random": 0.2, "drawn": 0.2, "best": 0.4})
    drop = every["gain"]["entropy"]["best"]["value"]
    assert drop == pytest.approx(0.97095 - 0.72193, abs=1e-4)  # bit
    assert every["ahead"]["right"]["value"] == 0.0
    assert every["ahead_of_aim"]["right"]["value"] == -0.5
    assert scores["by_candidate"]["a"]["recommended"] == 2
    assert scores["by_candidate"]["a"]["best"] == 1
    assert scores["expectation"]["best_was_recommended"]["value"] == 0.5
    assert scores["expectation"]["order"]["value"] == pytest.approx(0.0)
    promised = [
        scores["expectation"][f"expected_drop_{name}"] for name in ("of_entropy", "by_a_random_one")
    ]
    assert [each["value"] for each in promised] == [0.5, 0.375]
    assert scores["groups"]["truth_leading"]["cases"] == 2


def test_a_pair_earns_half_and_its_own_probability():
    cases = labels("cohesion+gate")
    pair = answer(**{"cohesion+gate": 0.7, "gate": 0.3})
    answers = {"case_000": entry(answer(gate=0.9), "a", a=pair, b=answer(gate=1.0))}
    every = next_scores(cases, answers)["all"]
    assert every["gain"]["right"]["recommended"]["value"] == 0.5
    assert every["gain"]["probability"]["recommended"]["value"] == pytest.approx(0.7)


def test_worlds_are_drawn_whole():
    values = np.repeat([0.0, 1.0, 0.0, 1.0], 25)
    alone = over_worlds(values, [f"w{n}" for n in range(100)])
    whole = over_worlds(values, np.repeat(list("abcd"), 25))
    assert alone["value"] == whole["value"] == 0.5
    assert whole["high"] - whole["low"] > 3.0 * (alone["high"] - alone["low"])


def test_a_suite_without_any_recommendation_has_no_gain():
    scores = next_scores(labels("gate"), {"case_000": entry(answer(gate=1.0), None)})
    assert scores["all"] == {"cases": 0}
    assert scores["expectation"] == {}


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"recommended": "c"}, "recommended"),
        ({"random": None}, "random"),
        ({"first": {"verdict": "effect"}}, "field probability"),
        ({"leading": "gate"}, "leading"),
    ],
)
def test_answers_of_another_form_are_refused(change, key, tmp_path):
    good = entry(answer(gate=1.0), "a", a=answer(gate=0.6), b=None)
    path = tmp_path / "answers.json"
    path.write_text(json.dumps({"case_000": good}))
    assert read_next_answers(path, labels("gate")) == {"case_000": good}
    path.write_text(json.dumps({"case_000": good | change}))
    with pytest.raises(InputError, match=key):
        read_next_answers(path, labels("gate"))
    path.write_text(json.dumps({"case_000": good, "case_009": good}))
    with pytest.raises(InputError, match="no such case"):
        read_next_answers(path, labels("gate"))


def test_answers_are_to_all_cases_or_to_the_first_ones(tmp_path):
    sealed, good = labels("gate", "none", "none"), entry(answer(gate=1.0), "a", a=answer(gate=0.6))
    path = tmp_path / "answers.json"
    path.write_text(json.dumps({"case_000": good, "case_001": good}))
    assert list(read_next_answers(path, sealed)) == ["case_000", "case_001"]
    path.write_text(json.dumps({"case_000": good, "case_002": good}))
    with pytest.raises(InputError, match="case_001.*no answer"):
        read_next_answers(path, sealed)
