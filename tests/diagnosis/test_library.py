"""What is read off the runs of a diagnosis, and what a failed one costs; the solver runs in test_diagnose_solver."""

from math import inf

import numpy as np
import pytest
from toy_laboratory import PlannedQuestion, ToyRunner, film

from fvcollapse import load_experiment
from fvcollapse.diagnosis.baseline import refined
from fvcollapse.diagnosis.grid_correction import reference_level
from fvcollapse.diagnosis.levels import design
from fvcollapse.diagnosis.library import build_library
from fvcollapse.diagnosis.nuisances import ensemble_runs, nuisances
from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.reading import Reading
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import NumericalError


def test_library_holds_baselines_ensemble_and_responses(experiments, cases):
    runner = ToyRunner()
    found = build_library(
        PlannedQuestion(experiments[:2], planned=cases), runner, ["gate", "bed_friction"], draws=6
    )
    size = len(found.points)
    assert found.points.names == ("s10_w0.1", "s16_w0.1")
    assert found.coarse.shape == found.fine.shape == (size,)
    assert 0.0 < np.abs(found.fine - found.coarse).max() < 0.03
    assert found.samples.shape == (6, size)
    assert found.draws.shape == (6, len(found.quantities))
    assert set(found.responses) == {"gate", "bed_friction"}
    (response,) = found.responses["bed_friction"]
    level = found.closures["bed_friction"][0].levels()[2]
    assert response.at(level) == pytest.approx(response.differences[2], abs=1e-9)
    assert len(runner.asked) == 2 * (2 + 6 + 4 + len(design(4)) + 2)  # two on the finer grid


def test_a_response_is_that_of_the_finer_grid_where_it_was_run_there(experiments, cases):
    """At the level of reference exactly; at the others in proportion to their own response."""
    one = experiments[0]
    found = build_library(
        PlannedQuestion((one,), planned=cases), ToyRunner(), ["bed_friction"], draws=4
    )
    (closure,), (response,) = found.closures["bed_friction"], found.responses["bed_friction"]
    level = closure.levels()[reference_level(closure.levels())]
    case = cases[one.name].replace(**{"effects.bed_friction": closure.section(level)})
    seen, _ = ToyRunner().observations({("fine", 0, one.name): (one, refined(case))})
    fine = Reading(found.points, seen, {}).vector("fine", 0)
    assert response.at(level) == pytest.approx(fine - found.fine, abs=1e-9)
    correction = found.corrections["bed_friction", 0]
    assert correction.change.any()
    assert correction(0.5 * correction.reference) == pytest.approx(0.5 * (fine - found.fine))
    assert not correction(np.zeros(len(fine))).any()


def test_a_hidden_effect_acts_in_the_experiments_and_shared_physics_everywhere(experiments, cases):
    found = build_library(
        PlannedQuestion(experiments[:1], controls=experiments[1:2], planned=cases),
        ToyRunner(),
        ["bed_friction"],
        draws=4,
    )
    control = found.points.of("s16_w0.1")
    (response,) = found.responses["bed_friction"]
    assert not response.differences[:, control].any()
    own = found.points.of("s10_w0.1")
    everywhere = found.everywhere["bed_friction"] * np.sqrt(len(response.differences))
    assert everywhere[:, own] == pytest.approx(response.differences[:, own])
    assert np.abs(everywhere[:, control]).max() > 0.0
    assert np.ptp(found.samples[:, control], axis=0).max() > 0.0


def test_walls_act_only_where_there_are_some(experiments, cases):
    mixed = cases | {
        "s10_w0.1": cases["s10_w0.1"].replace(**{"geometry.channel_width": inf}),
    }
    found = build_library(
        PlannedQuestion(experiments[:2], planned=mixed), ToyRunner(), ["lateral_friction"], draws=4
    )
    for response in found.responses["lateral_friction"]:
        assert not response.differences[:, found.points.of("s10_w0.1")].any()
        assert response.differences[:, found.points.of("s16_w0.1")].any()


def test_an_effect_without_a_trace_is_left_out(tmp_path):
    folder = film(tmp_path / "only_volume")
    for name in ("front", "profiles", "interface"):
        (folder / f"{name}.csv").unlink()
    one = load_experiment(folder)
    found = build_library(Question((one,)), ToyRunner(), ["cohesion"], draws=4)
    assert found.left_out == {"cohesion": "it changes nothing that was measured"}
    assert found.responses == {}


def test_an_effect_that_the_case_refuses_is_left_out(experiments, cases, monkeypatch):
    prior = CATALOGUE["cohesion"].priors["adhesion"]._replace(first=1.0e4, second=1.0e6)
    effect = CATALOGUE["cohesion"]._replace(priors={"adhesion": prior})
    monkeypatch.setitem(CATALOGUE, "cohesion", effect)
    effects = ["cohesion", "bed_friction"]
    found = build_library(
        PlannedQuestion(experiments[:1], planned=cases), ToyRunner(), effects, draws=4
    )
    assert set(found.responses) == {"bed_friction"}
    assert "effects.cohesion.adhesion cannot be" in found.left_out["cohesion"]


def test_reading_is_in_the_order_of_the_points(experiments, cases):
    points = choose_points(experiments)
    wanted = {("x", None, one.name): (one, cases[one.name]) for one in experiments}
    seen, _ = ToyRunner().observations(wanted)
    whole = points.simulated({one.name: seen["x", None, one.name] for one in experiments})
    assert np.array_equal(Reading(points, seen, {}).vector("x", None), whole)


# -- runs that fail ------------------------------------------------------------------------------


class Failing(ToyRunner):
    """Fails where a label says so."""

    def __init__(self, fails):
        super().__init__()
        self.fails = fails

    def observations(self, wanted, phase=""):
        seen, _ = super().observations(wanted)
        failures = {label: NumericalError("it blew up") for label in wanted if self.fails(label)}
        return {label: each for label, each in seen.items() if label not in failures}, failures


def test_a_failed_run_on_the_finer_grid_costs_the_correction_only(experiments, cases):
    runner = Failing(lambda label: label[1] == "fine")
    found = build_library(
        PlannedQuestion(experiments[:1], planned=cases), runner, ["bed_friction"], draws=4
    )
    assert set(found.responses) == {"bed_friction"}
    assert found.corrections == {}


def test_failed_runs_cost_a_draw_or_an_effect_not_the_diagnosis(experiments, cases):
    fails = lambda label: label[0] == "draw" and label[1] == 2  # noqa: E731
    found = build_library(
        PlannedQuestion(experiments[:2], planned=cases), Failing(fails), ["cohesion"], draws=6
    )
    assert found.samples.shape[0] == found.draws.shape[0] == 5
    fails = lambda label: label[0] == ("cohesion", 0) and label[1] != 0  # noqa: E731
    found = build_library(
        PlannedQuestion(experiments[:2], planned=cases),
        Failing(fails),
        ["cohesion", "gate"],
        draws=4,
    )
    assert set(found.responses) == {"gate"}
    assert "6 of its 7 runs fail: it blew up" in found.left_out["cohesion"]


def test_a_draw_that_is_no_legal_case_is_a_failed_draw(experiments, cases):
    """mu_2 = mu_1 has no well-posed range, which the regularised law needs."""
    one = experiments[0]
    case = cases[one.name].replace(**{"rheology.law": "mu_I_regularised"})
    quantities = nuisances((one,), {one.name: case})
    z = np.zeros((3, len(quantities)))
    z[1, [quantity.key for quantity in quantities].index("rheology.mu_1")] = 40.0
    drawn, refused = ensemble_runs((one,), {one.name: case}, quantities, z)
    assert [label[1] for label in drawn] == [0, 2]
    assert [label[1] for label in refused] == [1]
    assert "rheology.mu_1 cannot be" in str(refused["draw", 1, one.name])


@pytest.mark.parametrize("what", ["fine", "coarse"])
def test_a_baseline_that_fails_ends_it(experiments, cases, what):
    runner = Failing(lambda label: label[0] == what)
    with pytest.raises(NumericalError, match="it blew up"):
        build_library(
            PlannedQuestion(experiments[:1], planned=cases), runner, ["cohesion"], draws=4
        )


def test_too_few_draws_are_an_error(experiments, cases):
    runner = Failing(lambda label: label[0] == "draw" and label[1] > 2)
    with pytest.raises(NumericalError, match="5 of 8 draws of the calibrated parameters fail"):
        build_library(
            PlannedQuestion(experiments[:1], planned=cases), runner, ["cohesion"], draws=8
        )
