"""Physics that controls and experiments share is found in the controls, and carried over to the experiments."""

import numpy as np
import pytest
from fake_points import fake_points

from fvcollapse.diagnosis.controls import Shown, condition, learn
from fvcollapse.diagnosis.covariance import discrepancy_amplitude, discrepancy_kernel
from fvcollapse.diagnosis.shared_physics import covariance_of, shared_physics

APART = 2.0  # of the set-ups of the two runs: a smooth discrepancy says little of the other run


@pytest.fixture(scope="module")
def runs():
    """Points of an experiment r0 and a control r1, their covariances, and the responses of two effects."""
    points = fake_points(2, kinds=())
    known = np.diag(points.sigma**2)
    amplitude = discrepancy_amplitude(points, (3.0 * points.sigma) ** 2)
    kernel = discrepancy_kernel(points, amplitude)
    time, x = np.nan_to_num(points.time), np.nan_to_num(points.x)
    far = np.where(points.experiment == "r0", 2.0, 1.0)  # the effects act more in the experiment
    shapes = {
        "drag": -far * (8.0 * points.sigma) * np.tanh(4.0 * time),
        "scatter": far * (8.0 * points.sigma) * np.cos(9.0 * x) * np.sin(3.0 * time),
    }
    levels = np.array([0.3, 0.6, 0.9])[:, None] / np.sqrt(3.0)
    return points, known, kernel, {name: levels * shape for name, shape in shapes.items()}, shapes


def measured(runs, truth, seed=0):
    """A gap of an effect of some size, with noise, and which points are those of the control."""
    points, *_, shapes = runs
    noise = points.sigma * np.random.default_rng(seed).standard_normal(len(points))
    gap = sum((size * shapes[name] for name, size in truth.items()), noise)
    return gap, points.experiment == "r1"


@pytest.mark.parametrize("name", ["drag", "scatter"])
def test_the_effect_that_acts_is_found_in_the_control(runs, name):
    points, known, kernel, columns, _ = runs
    gap, control = measured(runs, {name: 0.7})
    found = shared_physics(columns, control, gap, known, kernel)
    assert set(found) == {name}
    assert found[name] == 1.0


def test_where_nothing_acts_nothing_is_found(runs):
    points, known, kernel, columns, _ = runs
    for seed in range(20):
        gap, control = measured(runs, {}, seed)
        assert shared_physics(columns, control, gap, known, kernel) == {}


def test_two_effects_are_found_one_after_the_other(runs):
    points, known, kernel, columns, _ = runs
    gap, control = measured(runs, {"drag": 0.7, "scatter": 0.8})
    assert set(shared_physics(columns, control, gap, known, kernel)) == {"drag", "scatter"}


def test_what_a_control_shows_is_expected_of_the_experiment_in_its_own_size(runs):
    points, known, kernel, columns, shapes = runs
    gap, control = measured(runs, {"drag": 0.7})
    run = np.where(control, 1, 0)
    apart = APART * (run[:, None] != run)
    rest = {}
    for physics in ({}, columns):
        learned = learn(Shown(points, control, gap), known, kernel, apart, physics)
        expected = condition(control, ~control, gap, known + learned.covariance)
        rest[bool(physics)] = 0.7 * shapes["drag"][~control] - expected.mean
    deviation = np.sqrt(np.diag(expected.covariance))  # with the effect
    assert np.sqrt(np.mean((rest[True] / deviation) ** 2)) < 2.0
    size = np.sqrt(np.mean(shapes["drag"][~control] ** 2))
    assert np.sqrt(np.mean(rest[True] ** 2)) < 0.1 * size  # by its response
    assert np.sqrt(np.mean(rest[False] ** 2)) > 0.3 * size  # by smoothness alone


def test_covariance_is_that_of_the_levels(runs):
    points, _, _, columns, shapes = runs
    found = covariance_of(columns, {"drag": 0.5}, len(points))
    expected = 0.5 * np.mean([0.3**2, 0.6**2, 0.9**2]) * np.outer(shapes["drag"], shapes["drag"])
    assert found == pytest.approx(expected)
