"""The question of a diagnosis: checked at once, and everything in it computed once."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from toy_laboratory import film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.diagnosis.question import Question
from fvcollapse.errors import InputError


@pytest.fixture(scope="module")
def experiments(tmp_path_factory):
    folder = tmp_path_factory.mktemp("asked")
    slopes = (10.0, 13.0, 16.0)
    return [
        load_experiment(film(folder / f"s{slope:g}", slope, seed=n))
        for n, slope in enumerate(slopes)
    ]


def test_everything_is_computed_once_and_cannot_be_changed(experiments):
    fitted, held, control = experiments
    question = Question((fitted,), (held,), (control,), cell_size=0.02)
    question.check()
    assert question.points is question.points
    assert question.all_points.names == ("s10", "s16")
    assert question.held_out_points.names == ("s13",)
    assert question.cases is question.cases
    assert set(question.cases) == {"s10", "s16"}
    assert set(question.held_out_cases) == {"s13"}
    assert question.baseline is question.cases["s10"]
    with pytest.raises(FrozenInstanceError):
        question.seed = 1


def test_the_points_of_one_experiment_are_those_that_it_has_alone(experiments):
    together = choose_points(experiments)
    for experiment in experiments:
        alone, part = choose_points([experiment]), together.parts[experiment.name]
        assert part.experiments == alone.experiments
        assert part.runs == alone.runs
        assert np.array_equal(part.measured, alone.measured)
        assert np.array_equal(part.sigma, alone.sigma)
        assert [b[:3] + b[5:] for b in part.blocks] == [b[:3] + b[5:] for b in alone.blocks]
        assert np.array_equal(part.x, alone.x, equal_nan=True)
        assert np.array_equal(part.time, alone.time, equal_nan=True)


def test_an_experiment_is_given_once(experiments):
    with pytest.raises(InputError, match="it is given twice"):
        Question((experiments[0],), controls=(experiments[0],)).check()


@pytest.mark.parametrize("role", ["experiments", "held_out", "controls"])
def test_cells_too_large_for_any_column_are_refused_before_anything_runs(experiments, role):
    roles = {"experiments": (experiments[0],)} | {role: (experiments[1],)}
    with pytest.raises(InputError, match="--cell-size"):
        Question(**roles, cell_size=0.05).check()
