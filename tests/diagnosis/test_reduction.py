"""The ladder of models, and sizes of gaps, on collapses by formula."""

from dataclasses import replace

import numpy as np
import pytest
from fake_points import fake_points
from toy_laboratory import ToyRunner, collapse, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.analysis import analyse
from fvcollapse.diagnosis.closing import Group, closing, fraction_closed, size
from fvcollapse.diagnosis.confirmation import FoldTest
from fvcollapse.diagnosis.ladder import climb, fold_fractions, fold_remainders
from fvcollapse.diagnosis.names import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.diagnosis.question import Question
from fvcollapse.errors import NumericalError

EFFECTS = ("lateral_friction", "cohesion", "bed_friction")
HIDDEN = {"lateral_friction": {"mu_wall": 0.22, "pressure_ratio": 0.9}}
FITTED, HELD_OUT = ((10.0, 0.1), (16.0, 0.1)), ((13.0, 0.1), (16.0, 0.2))
MU_1 = 0.462  # one standard deviation above what is stated


def filmed(folder, set_ups, first=0):
    return [
        load_experiment(
            film(folder / f"s{s:g}_w{w:g}", s, w, effects=HIDDEN, seed=first + n, mu_1=MU_1)
        )
        for n, (s, w) in enumerate(set_ups)
    ]


@pytest.fixture(scope="module")
def hold_out(tmp_path_factory):
    return filmed(tmp_path_factory.mktemp("held"), HELD_OUT, 7)


@pytest.fixture(scope="module")
def analysis(tmp_path_factory):
    experiments = filmed(tmp_path_factory.mktemp("fitted"), FITTED)
    return analyse(Question(tuple(experiments)), ToyRunner(), effects=EFFECTS)


@pytest.fixture(scope="module")
def ladder(analysis, hold_out):
    question = replace(analysis.question, held_out=tuple(hold_out))
    asked = replace(analysis, question=question)
    return climb(asked, ToyRunner(), "lateral_friction", "cohesion")


def test_the_true_cause_closes_the_gap_where_it_was_not_fitted(ladder):
    everything = slice(None)
    for group in (ladder.fitted, ladder.held_out):
        closed = {model: closing(group, model, everything, 0).fraction for model in ladder.fits}
        assert closed[BASELINE] == 0.0
        assert closed[WINNER] > 0.9
        assert closed[WINNER] > closed[RUNNER_UP] > closed[RECALIBRATED] - 0.05


def test_calibrated_parameters_come_back(analysis, ladder):
    keys = [each.key for each in ladder.quantities]
    z = dict(zip(keys, ladder.fits[WINNER].z, strict=True))
    assert set(z) == {"rheology.mu_1", "rheology.mu_2", "rheology.I_0", "boundary.mu_back_wall"}
    assert all(abs(shift) < 2.0 for shift in z.values())
    assert not ladder.fits[BASELINE].z.any()
    (closure, u) = ladder.fits[WINNER].effects["lateral_friction"]
    values = closure.values(u)
    total = values["mu_wall"] * values["pressure_ratio"]
    friction = 0.012 * z["rheology.mu_1"] + 0.5 * total * 1.4  # as the formula adds them
    assert friction == pytest.approx(0.012 + 0.5 * 0.22 * 0.9 * 1.4, abs=0.012)


def test_models_are_run_and_not_emulated(ladder, analysis, hold_out):
    """What the ladder holds is what the formula gives for the very cases."""
    points, case = ladder.fitted.points, analysis.library.cases["s10_w0.1"]
    closure, u = ladder.fits[WINNER].effects["lateral_friction"]
    z = dict(zip([each.key for each in ladder.quantities], ladder.fits[WINNER].z, strict=True))
    values = {each.key: each.value(z[each.key]) for each in ladder.quantities}
    true = case.replace(
        **values,
        **{
            "grid.cell_size": 0.75 * case.grid.cell_size,
            "effects.lateral_friction": closure.section(u),
        },
    )
    front = next(block for block in points.blocks if block.observable == "front")
    expected = np.interp(front.time, *collapse(true).front.T)
    assert ladder.fitted.simulated[WINNER][front.start : front.stop] == pytest.approx(expected)
    emulated = ladder.predicted[WINNER][front.start : front.stop]
    assert np.abs(emulated - expected).max() < 0.004
    assert not np.array_equal(emulated, expected)
    assert ladder.held_out.points.names == tuple(one.name for one in hold_out)


def test_held_out_experiments_are_the_folds(ladder):
    folds = fold_fractions(ladder)
    assert set(folds) == {("s13_w0.1", True), ("s16_w0.2", True)}
    assert all(own[WINNER] > own[RUNNER_UP] for own in folds.values())


def test_the_smaller_gap_wins_where_nothing_is_left_beyond_the_noise(ladder):
    tie = FoldTest("deposit", True, 1.0, 1.0, 0.6, 0.8)
    assert tie.is_won
    assert not tie._replace(winner_left=0.8).is_won
    assert not tie._replace(winner_left=0.9).is_won
    assert tie._replace(rival=None, rival_left=None).is_won
    left = fold_remainders(ladder)
    for fold, closed in fold_fractions(ladder).items():  # elsewhere both have the same order
        order = sorted(left[fold], key=left[fold].get)
        assert [closed[model] for model in order] == sorted(closed.values(), reverse=True)


def test_without_held_out_experiments_each_is_left_out(analysis):
    ladder = climb(analysis, ToyRunner(), "lateral_friction", "cohesion")
    assert ladder.held_out is None
    folds = fold_fractions(ladder)
    assert set(folds) == {("s10_w0.1", False), ("s16_w0.1", False)}
    assert all(own[WINNER] > own[RUNNER_UP] for own in folds.values())
    assert set(folds["s10_w0.1", False]) == {RECALIBRATED, WINNER, RUNNER_UP}


def test_without_a_cause_there_are_two_models(analysis):
    ladder = climb(analysis, ToyRunner())
    assert set(ladder.fits) == {BASELINE, RECALIBRATED}


def test_two_effects_together_are_added_together(tmp_path):
    hidden = {"gate": {"speed": 0.8, "delay": 0.03}, "bed_friction": {"mu_bed": 0.22}}
    one = load_experiment(film(tmp_path / "both", effects=hidden))
    found = analyse(Question((one,)), ToyRunner(), effects=("gate", "bed_friction", "cohesion"))
    pair = "bed_friction+gate"
    assert pair in found.evidence.hypotheses
    ladder = climb(found, ToyRunner(), pair, "gate")
    assert set(ladder.fits[WINNER].effects) == {"bed_friction", "gate"}
    closed = [
        closing(ladder.fitted, model, slice(None), 0).fraction for model in (WINNER, RUNNER_UP)
    ]
    assert closed[0] > closed[1]


class FailingWinner(ToyRunner):
    def observations(self, wanted, phase=""):
        seen, _ = super().observations(wanted)
        failures = {label: NumericalError("it blew up") for label in wanted if label[0] == WINNER}
        return {label: each for label, each in seen.items() if label not in failures}, failures


def test_a_model_whose_runs_fail_is_named_and_left_out(analysis):
    ladder = climb(analysis, FailingWinner(), "lateral_friction", "cohesion")
    assert WINNER not in ladder.fitted.simulated
    assert RUNNER_UP in ladder.fitted.simulated
    assert any("winner" in line and "it blew up" in line for line in ladder.failures)


# -- sizes of gaps -------------------------------------------------------------------------------


def test_size_is_beyond_the_noise():
    rng = np.random.default_rng(0)
    noise = rng.standard_normal(20000)
    assert size(noise, np.ones(20000)) < 0.15
    assert size(2.0 + noise, np.ones(20000)) == pytest.approx(2.0, abs=0.05)


def test_fraction_closed_is_bounded_and_zero_without_a_gap():
    noise = np.ones(10)
    assert fraction_closed(2.0, 0.5, noise) == 0.75
    assert fraction_closed(2.0, 9.0, noise) == -1.0
    assert fraction_closed(0.0, 0.0, noise) == 0.0
    assert fraction_closed(0.0, 1.0, noise) == -1.0


def test_the_range_holds_the_value_and_what_was_left_out():
    points = fake_points(runs=2, kinds=())
    covariance = np.diag(points.sigma**2)
    rng = np.random.default_rng(1)
    truth = points.measured + 0.0
    noisy = points.sigma * rng.standard_normal(len(points))
    points = type(points)((), points.blocks, truth + noisy, points.sigma, points.runs)
    shift = 5.0 * points.sigma
    simulated = {BASELINE: truth + shift, WINNER: truth + 0.4 * shift}
    nothing = dict.fromkeys(simulated, np.zeros(len(points)))
    group = Group(points, {}, nothing, covariance, simulated)
    found = closing(group, WINNER, slice(None), 0)
    assert found.before == pytest.approx(5.0, abs=0.3)
    assert found.after == pytest.approx(2.0, abs=0.3)
    assert found.fraction == pytest.approx(1.0 - found.after / found.before)
    low, high = found.interval
    assert low < found.fraction < high
    assert high - low < 0.2
    wide = closing(group, WINNER, slice(None), 0, values=[0.1, 0.7])
    assert wide.interval == (0.1, max(0.7, high))
    front = points.observable == "front"
    metres = closing(group, WINNER, front, 0, in_units=True)
    assert metres.before == pytest.approx(0.05, abs=0.01)
