"""The answer after some of the experiments is that of a diagnosis of these alone."""

import pytest
from toy_laboratory import ToyRunner, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.diagnose import judge
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.sequence import after, sequence

EFFECTS = ("lateral_friction", "gate", "cohesion", "bed_friction")


@pytest.fixture(scope="module")
def experiments(tmp_path_factory):
    """Three collapses between the same walls, which rub."""
    folder = tmp_path_factory.mktemp("walls")
    hidden = {"lateral_friction": {"mu_wall": 0.22, "pressure_ratio": 0.9}}
    set_ups = ((10.0, 0.1), (16.0, 0.1), (16.0, 0.2))
    return [
        load_experiment(film(folder / f"s{slope:g}_w{width:g}", slope, width, hidden, seed))
        for seed, (slope, width) in enumerate(set_ups)
    ]


@pytest.fixture(scope="module")
def whole(experiments):
    return analyse(Question(tuple(experiments)), ToyRunner(), effects=EFFECTS, refinements=0)


@pytest.mark.parametrize("count", [1, 2])
def test_a_part_is_as_if_there_were_no_more(whole, experiments, count):
    part = after(whole, count)
    alone = analyse(
        Question(tuple(experiments[:count])), ToyRunner(), effects=EFFECTS, refinements=0
    )
    assert part.experiments == alone.experiments
    assert part.gap == pytest.approx(alone.gap)
    found, expected = part.evidence.log_evidence(), alone.evidence.log_evidence()
    assert set(EFFECTS) <= set(found) & set(expected)
    for name in ("none", *EFFECTS):
        difference = found[name] - found["none"]
        assert difference == pytest.approx(expected[name] - expected["none"], abs=1.0, rel=2e-3)


def test_one_answer_less_than_experiments(whole, experiments):
    answers = sequence(whole, judge)
    names = [one.name for one in experiments]
    assert [given for given, _ in answers] == [tuple(names[:1]), tuple(names[:2])]
    assert all(sum(each.probability.values()) == pytest.approx(1.0) for _, each in answers)
