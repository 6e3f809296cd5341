"""What sealed checks say stands beside an answer and beside a recommended experiment."""

import pytest
from msgspec.structs import replace
from report_example import FITTED, example
from report_page import blank, small, written
from toy_laboratory import ToyRunner, film

from fvcollapse import load_experiment
from fvcollapse.case.case import case_from_text
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.next_candidates import candidates
from fvcollapse.diagnosis.next_experiment import Choice
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.report.findings import next_experiments
from fvcollapse.diagnosis.report.next_words import next_words, planned, with_case
from fvcollapse.diagnosis.report.schema import NextExperiment
from fvcollapse.diagnosis.report.sealed import PATH, right_words, sealed_scores
from fvcollapse.diagnosis.report.sentences import answer
from fvcollapse.diagnosis.report.words import percent
from runs import sealed_scores as shipped


def proposal(description, gain, **set_up):
    return NextExperiment(description, ["cohesion", "gate"], gain, set_up=set_up)


def with_plan(first, *others, report=None):
    report = report or small(experiments=(FITTED[0],), observables=())
    details = replace(report.details, alternatives=list(others))
    return replace(report, next_experiment=first, details=details)


def test_the_shipped_numbers_are_those_of_the_tables():
    """Else: `python -m runs.sealed_scores`."""
    numbers = shipped.sealed_scores()
    found = sealed_scores()
    for way in shipped.WAYS:
        assert {key: getattr(getattr(found, way), key) for key in numbers[way]} == numbers[way]
    assert found.next.cases == numbers["next"]["cases"]
    assert found.next.margin == pytest.approx(
        abs(numbers["next"]["expected"] - numbers["next"]["gained"])
    )
    assert PATH.is_file()


def test_the_answer_says_how_often_such_answers_are_right():
    report, scores = example(), sealed_scores()
    alone = right_words(report)
    assert f"{scores.alone.cases} sealed cases without controls" in alone
    for way in (scores.alone, scores.controls):
        assert percent(way.first_right) in alone
        assert percent(way.confident_errors) in alone
    assert "bring controls" in alone
    assert any(alone[1:] in line for line in answer(report))
    taught = right_words(replace(report, details=replace(report.details, expected={"front": 0.01})))
    assert f"{scores.controls.cases} sealed cases with controls" in taught
    assert "bring controls" not in taught


def test_untested_probabilities_are_told_from_tested_ones():
    report = example()
    bare = {name: replace(one, conformal_p=None) for name, one in report.details.hypotheses.items()}
    text = " ".join(answer(replace(report, details=replace(report.details, hypotheses=bare))))
    assert "how often such an answer is right was not tested." in text
    assert "sealed cases without controls" not in text  # what other answers were worth


def test_experiments_that_cannot_be_told_apart_are_no_ranking(tmp_path):
    margin = sealed_scores().next.margin
    report = with_plan(
        proposal("z, at 6°", 1.3, slope=6.0),
        proposal("a, at 2°", 1.3 - 0.9 * margin, slope=2.0),
        proposal("m, at 4°", 1.3 - 1.1 * margin, slope=4.0),
    )
    alike, less = planned(report)
    assert [one.description for one in alike] == ["a, at 2°", "z, at 6°"]
    assert [one.description for one in less] == ["m, at 4°"]
    first, _, last = next_words(report)
    assert first == "one of 2 experiments that the plan cannot tell apart: a, at 2°; z, at 6°."
    assert last.startswith(f"In {sealed_scores().next.cases} sealed cases a recommended experiment")
    text = written(report, tmp_path, blank).text
    chapter = text[text.index("What to measure next") :]
    assert "the plan expected" in chapter[: chapter.index("Measurement")]
    assert "Repeats" not in chapter


def test_one_experiment_is_named_and_none_is_left_out():
    one = with_plan(proposal("z, at 6°", 1.3, slope=6.0))
    assert next_words(one)[0] == "z, at 6°."
    assert next_words(replace(one, next_experiment=None)) == []


def test_the_case_file_is_of_a_set_up_that_was_not_measured(tmp_path):
    """Where measuring more in the same set-up comes first, the case of it is the one that was run."""
    folder = film(tmp_path / "s16", effects={"cohesion": {"kappa_0": 20.0}})
    (folder / "volume.csv").unlink()
    (experiment,) = (load_experiment(folder),)
    analysis = analyse(Question((experiment,)), ToyRunner(), effects=("cohesion", "gate"))
    base = analysis.library.cases[experiment.name]
    more, other, *_ = candidates(experiment, base)
    assert not more.changes
    choices = [
        Choice(each, ("cohesion", "gate"), gain, 1.0, 1)
        for each, gain in ((more, 1.0), (other, 0.9))
    ]
    first, second = next_experiments(analysis, choices)
    assert (first.set_up, second.case) == ({}, "")
    assert case_from_text(first.case) == base.replace(**other.changes)
    assert with_case(with_plan(first, second)) == second
