"""Scores of the next experiment: what an answer gains by it, against numbers worked out by hand."""

import json

import numpy as np
import pytest

from fvcollapse.blind.next_scores import next_scores, over_worlds, read_next_answers
from fvcollapse.errors import InputError


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
