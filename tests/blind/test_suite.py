"""From the cases of a suite to a fitted verdict and to answers, on collapses by formula."""

import copy
import json

import numpy as np
import pytest
from toy_laboratory import ToyRunner, film

from fvcollapse.blind import case_evidence, verdict_training
from fvcollapse.blind.answers import answers, write_answers
from fvcollapse.blind.case_evidence import BATCH, design_of, study
from fvcollapse.blind.causes import BLIND, TRAINING, known_effects
from fvcollapse.blind.distances import distances
from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.forms import answer_problems
from fvcollapse.blind.labels import LABELS_FORMAT
from fvcollapse.blind.simple_rules import SIMPLE
from fvcollapse.blind.verdict_training import (
    cross_validated,
    make_training,
    may_teach,
    teachers,
    train,
    training_classes,
)
from fvcollapse.diagnosis.verdict import EVEN
from fvcollapse.diagnosis.verdict_features import agrees
from fvcollapse.diagnosis.verdict_model import VerdictModel
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import InputError, NumericalError

OPTIONS = {"effects": ("cohesion", "bed_friction"), "draws": 8}
# leaving a kind and a fold of worlds out, five of unknown must be left
CAUSES = {"none": 8, "unknown": 14, **dict.fromkeys(OPTIONS["effects"], 8)}
CASES = sum(CAUSES.values())


def hidden(cause, rng):
    """(effects of the label, swelling) of a case."""
    effects = {}
    for name in () if cause in ("none", "unknown") else cause.split("+"):
        (parameter, prior), *_ = CATALOGUE[name].priors.items()
        u = float(rng.uniform(0.1, 0.9))
        section = {parameter: float(prior.distribution().ppf(u))}
        effects[name] = {"closure": 0, "section": section, "quantiles": {parameter: u}}
    return effects, float(rng.uniform(0.05, 0.1)) if cause == "unknown" else 0.0


def toy_world(number):
    """A world without controls."""
    about = {"name": f"world_{number:02d}", "strength": "slight", "statement": "careful"}
    return about | {"quality": 1.0, "common": {}, "controls": {}}


def toy_suite(folder, causes):
    """Cases and labels."""
    rng, cases = np.random.default_rng(3), {}
    for number, cause in enumerate(causes):
        name = f"case_{number:03d}"
        effects, swelling = hidden(cause, rng)
        film(
            folder / "suite" / name / "slope16",
            effects={effect: each["section"] for effect, each in effects.items()},
            swelling=swelling,
            seed=number,
            mu_1=float(rng.normal(0.45, 0.012)),
        )
        kind = ("balloon", "sponge")[number % 2] if cause == "unknown" else None
        label = {"cause": cause, "unknown_kind": kind, "effects": effects}
        label |= {"form": None, "world": toy_world(number // 2), "experiments": {}}
        entry = {"salt": "00" * 16, "seed": number, "world_seed": 0, "attempt": 0, "label": label}
        cases[name] = entry
    plan = {"format": LABELS_FORMAT, "cases": cases}
    (folder / "labels.json").write_text(json.dumps(plan))
    return folder


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """A toy suite, and the evidence of its cases."""
    causes = [name for name, count in CAUSES.items() for _ in range(count)]
    folder = toy_suite(tmp_path_factory.mktemp("toy"), causes)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(case_evidence.Runner, "__init__", ToyRunner.__init__)
        patch.setattr(case_evidence.Runner, "observations", ToyRunner.observations)
        assert study(folder / "suite", folder / "evidence", **OPTIONS) == {}
    found = distances(folder / "evidence", folder / "labels.json")
    return folder, found


@pytest.fixture(scope="module")
def model(studied):
    folder, _ = studied
    return train(pairs_of(folder), {"made": "by formula"})


def pairs_of(folder):
    """Evidence and labels of the toy suite."""
    return teachers([(folder / "evidence", folder / "labels.json")], controls=False)


def test_every_case_leaves_a_file_of_evidence(studied):
    folder, _ = studied
    for path in sorted((folder / "evidence").iterdir()):
        content, evidence = read_evidence(path)
        assert {"none", "unknown", *OPTIONS["effects"]} <= set(evidence.hypotheses)
        assert content["experiments"] == ["slope16"]
        found = content["hypotheses"]["bed_friction"]["parameters"]["mu_bed"]
        assert found["low"] <= found["value"] <= found["high"]


def test_answers_are_answers_and_mostly_right(studied, model, tmp_path):
    folder, _ = studied
    labels = json.loads((folder / "labels.json").read_text())["cases"]
    found = answers(folder / "evidence", model)
    write_answers(tmp_path / "answers.json", found)
    found = json.loads((tmp_path / "answers.json").read_text())
    assert set(found) == set(labels)
    assert not [problem for each in found.values() for problem in answer_problems(each)]
    right = [
        max(found[name]["probability"], key=found[name]["probability"].get)
        == labels[name]["label"]["cause"]
        for name in labels
    ]
    assert np.mean(right) > 0.7
    named = [each for each in found.values() if each["verdict"] == "effect"]
    assert all(set(each["parameters"]) for each in named)


def test_answers_are_none_where_the_model_agrees(studied, model):
    folder, _ = studied
    found = answers(folder / "evidence", model)
    evidences = {path.stem: read_evidence(path)[1] for path in (folder / "evidence").iterdir()}
    assert len({agrees(evidence) for evidence in evidences.values()}) == 2
    for name, evidence in evidences.items():
        if agrees(evidence):
            assert (found[name]["verdict"], "none" in found[name]["set"]) == ("none", True)
            assert found[name]["probability"]["none"] >= EVEN


@pytest.mark.parametrize("rule", SIMPLE)
def test_simple_rules_answer_too(studied, rule):
    folder, _ = studied
    found = answers(folder / "evidence", simple=rule)
    assert not [problem for each in found.values() for problem in answer_problems(each)]
    assert (
        len({max(each["probability"], key=each["probability"].get) for each in found.values()}) > 1
    )


def test_scores_of_cases_that_the_model_had_not_seen(studied):
    folder, _ = studied
    scores = cross_validated(pairs_of(folder))
    assert scores["cases"] == CASES
    assert set(scores["alarms"]["unknown_by_kind"]) == {"balloon", "sponge"}
    assert scores["all"]["top_1"]["value"] > 0.5


def test_distance_of_a_true_cause_grows_with_its_strength(studied):
    folder, found = studied
    labels = json.loads((folder / "labels.json").read_text())["cases"]
    own = {
        name: entry["label"]["effects"]["bed_friction"]["quantiles"]["mu_bed"]
        for name, entry in labels.items()
        if entry["label"]["cause"] == "bed_friction"
    }
    assert set(own) < set(found)
    strongest, weakest = min(own, key=own.get), max(own, key=own.get)  # low friction: strong
    assert found[strongest] > found[weakest] > 0.0


def test_the_model_knows_its_suite(model, tmp_path):
    assert model.about == {"cases": CASES, "made": "by formula"}
    model.save(tmp_path / "model.json")
    assert VerdictModel.load(tmp_path / "model.json").classes == model.classes


def test_evidence_that_is_there_is_kept(studied, monkeypatch):
    folder, _ = studied
    monkeypatch.setattr(case_evidence, "analysis_of", lambda *_: pytest.fail("computed again"))
    assert study(folder / "suite", folder / "evidence") == {}


def test_a_case_that_cannot_be_compared_is_told(studied, monkeypatch, tmp_path):
    folder, _ = studied
    count = []

    def fail(case, *_):
        count.append(case)
        if len(count) > 1:
            raise NumericalError("no pivot")

    monkeypatch.setattr(case_evidence, "keep_evidence", fail)
    failed = study(folder / "suite", tmp_path / "evidence")
    assert len(failed) == CASES - 1


def test_designs_are_told_apart_by_their_experiments(tmp_path):
    for name in ("a", "b"):
        (tmp_path / "case" / name).mkdir(parents=True)
        (tmp_path / "case" / name / "experiment.toml").write_text("")
    assert design_of(tmp_path / "case") == ("a", "b")
    with pytest.raises(InputError, match="no cases"):
        study(tmp_path / "case" / "a", tmp_path / "out")


def test_a_file_that_is_no_evidence_is_refused(tmp_path):
    (tmp_path / "case.json").write_text(
        '{"format": "fvcollapse-evidence", "hypotheses": {"none": {}}}'
    )
    with pytest.raises(InputError, match="hypotheses"):
        read_evidence(tmp_path / "case.json")
    (tmp_path / "case.json").write_text('{"format": "another"}')
    with pytest.raises(InputError, match="format"):
        read_evidence(tmp_path / "case.json")


def test_what_an_effect_closes_and_worsens_is_kept_and_its_form_checked(studied, tmp_path):
    folder, _ = studied
    path = sorted((folder / "evidence").glob("*.json"))[0]
    content = json.loads(path.read_text())
    name = next(name for name in content["hypotheses"] if name in CATALOGUE)
    content["hypotheses"][name] |= {"closes": -0.2, "worsens": ["front"]}
    (tmp_path / "case.json").write_text(json.dumps(content))
    _, evidence = read_evidence(tmp_path / "case.json")
    assert (evidence.hypotheses[name].closes, evidence.hypotheses[name].worsens) == (
        -0.2,
        ("front",),
    )
    for key, wrong in (("closes", 1.5), ("closes", "much"), ("worsens", ["the weather"])):
        changed = copy.deepcopy(content)
        changed["hypotheses"][name][key] = wrong
        (tmp_path / "case.json").write_text(json.dumps(changed))
        with pytest.raises(InputError, match=key):
            read_evidence(tmp_path / "case.json")


def test_a_training_suite_holds_every_class(monkeypatch):
    calls = []
    monkeypatch.setattr(verdict_training, "make", lambda *arguments: calls.append(arguments))
    classes = training_classes(10, seed=1)
    make_training(classes, "folder", seed=1)
    ((count, _, _, draw, _),) = calls
    assert count == len(classes) > BATCH
    assert draw.classes == classes
    assert draw.style == TRAINING
    assert draw.style != BLIND
    assert all(classes.count(name) == 10 for name in known_effects())
    assert classes.count("none") == 40
    assert classes.count("unknown") == 30
    assert sum("+" in name for name in classes) == 30


def test_kinds_of_unknown_that_blind_suites_hide_are_not_learned():
    for kinds, taught in ((BLIND.unknowns, False), ((None, *TRAINING.unknowns), True)):
        for kind in kinds:
            label = {"unknown_kind": kind, "world": toy_world(0)}
            assert may_teach(label, controls=False) == may_teach(label, controls=True) == taught


def test_strong_worlds_teach_only_with_their_controls():
    label = {"unknown_kind": None, "world": toy_world(0) | {"strength": "strong"}}
    assert may_teach(label, controls=True)
    assert not may_teach(label, controls=False)
