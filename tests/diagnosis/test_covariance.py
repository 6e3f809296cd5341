"""Covariances are symmetric positive definite, and hold what they say."""

import numpy as np
import pytest
from experiment_folder import FILES, write_experiment
from fake_points import fake_points
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fvcollapse.diagnosis.covariance import (
    discrepancy_amplitude,
    discrepancy_kernel,
    ensemble_covariance,
    measurement_covariance,
    numerical_covariance,
)
from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.diagnosis.points import Sensitivity
from fvcollapse.measure.experiment import load_experiment

N = 12


def assert_positive_definite(matrix, slack=0.0):
    """Symmetric, and no eigenvalue of the correlation below round-off (or not positive)."""
    np.testing.assert_array_equal(matrix, matrix.T)
    deviation = np.sqrt(np.diag(matrix))
    assert (deviation > 0.0).all()
    smallest = np.linalg.eigvalsh(matrix / np.outer(deviation, deviation)).min()
    assert smallest > -1.0e-12 * len(matrix) if slack else smallest > 0.0


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Points of two experiments on disk; one states no uncertainty of its ruler."""
    folder = tmp_path_factory.mktemp("measured")
    stated = "[uncertainty]\nheight_0 = 0.0014\nlength_0 = 0.004\ntime = 0.02\nthickness = 1.0e-8\n"
    plain = "[geometry]\nslope_angle_deg = 0\nheight_0 = 0.14\nlength_0 = 0.2\n"
    later = {
        stem: FILES[f"{stem}.csv"].replace("0.1", "0.12")
        for stem in ("front", "profiles", "volume", "interface")
    }
    return choose_points(
        [
            load_experiment(write_experiment(folder / "a", plain + stated)),
            load_experiment(write_experiment(folder / "b", plain, **later)),
        ]
    )


@settings(max_examples=30)
@given(st.data())
def test_measurement_covariance_is_positive_definite(measured, data):
    """Whatever a simulation makes of the rates, and with a stated uncertainty of next to nothing."""
    values = arrays(float, len(measured), elements=st.floats(-100.0, 100.0))
    sensitivity = Sensitivity(data.draw(values), data.draw(values))
    assert_positive_definite(measurement_covariance(measured, sensitivity))


def test_run_level_errors_stay_in_their_run_and_have_their_size(measured):
    ones = Sensitivity(np.ones(len(measured)), np.zeros(len(measured)))
    clock = measurement_covariance(measured, ones)
    a, b = measured.of("a"), measured.of("b")
    assert not clock[a, b].any()
    volume = np.flatnonzero(measured.observable[a] == "volume")
    assert clock[volume[0], volume[-1]] == pytest.approx(0.02**2)  # stated
    front = b.start + np.flatnonzero(measured.observable[b] == "front")
    assert clock[front[0], front[1]] == pytest.approx(0.005**2)  # default
    none = Sensitivity(np.zeros(len(measured)), np.zeros(len(measured)))
    scale = measurement_covariance(measured, none)
    own = np.flatnonzero(measured.observable[a] == "profiles")[:2]
    expected = 0.01**2 * np.prod(measured.measured[own])  # 1.4 mm of 140 mm
    assert scale[own[0], own[1]] == pytest.approx(expected)
    origin = measurement_covariance(measured, Sensitivity(none.clock, ones.clock))
    assert origin[front[0], front[1]] == pytest.approx(0.001**2)


def test_a_common_error_is_one_error_of_all_runs(tmp_path):
    plain = (
        "[geometry]\nslope_angle_deg = 0\nheight_0 = 0.14\nlength_0 = 0.2\n[common]\ntime = true\n"
    )
    stems = ("front", "profiles", "volume", "interface")
    later = {stem: FILES[f"{stem}.csv"].replace("0.1", "0.12") for stem in stems}
    points = choose_points(
        [
            load_experiment(write_experiment(tmp_path / "a", plain)),
            load_experiment(write_experiment(tmp_path / "b", plain, **later)),
        ]
    )
    ones = Sensitivity(np.ones(len(points)), np.zeros(len(points)))
    clock = measurement_covariance(points, ones)
    a, b = (points.of(name).start for name in "ab")
    assert points.observable[a] == points.observable[b] == "front"
    assert clock[a, b] == pytest.approx(0.005**2)
    origin = measurement_covariance(points, Sensitivity(ones.origin, ones.clock))
    assert origin[a, b] == 0.0


def test_numerical_covariance_is_richardson_run_by_run():
    points = fake_points(2)
    fine = np.linspace(0.0, 1.0, len(points))
    coarse = fine + 0.3 * (1.0 + np.arange(len(points)))
    first = points.of("r0")
    for used, factor in (("fine", 1.0 / 3.0), ("coarse", 4.0 / 3.0)):
        matrix = numerical_covariance(points, coarse, fine, 2.0, 2.0, used)
        error = factor * (coarse - fine)
        np.testing.assert_allclose(matrix[first, first], np.outer(error[first], error[first]))
        assert np.linalg.matrix_rank(matrix) == 2
        assert not matrix[first, points.of("r1")].any()


@given(st.integers(2, 30).flatmap(lambda m: arrays(float, (m, N), elements=st.floats(-10.0, 10.0))))
def test_ensemble_covariance_is_never_singular(samples):
    mean, covariance = ensemble_covariance(samples)
    assert_positive_definite(covariance)
    np.testing.assert_allclose(mean, samples.mean(axis=0), atol=1e-12)
    np.linalg.cholesky(covariance)


def test_a_large_ensemble_keeps_its_correlation():
    rng = np.random.default_rng(4)
    shape = rng.standard_normal((3, N))
    samples = rng.standard_normal((4000, 3)) @ shape + 0.1 * rng.standard_normal((4000, N))
    _, covariance = ensemble_covariance(samples)
    truth = shape.T @ shape + 0.01 * np.eye(N)
    assert np.abs(covariance - truth).max() < 0.06 * np.abs(truth).max()


def test_shrinkage_comes_nearer_to_the_truth_than_the_sample_covariance():
    rng = np.random.default_rng(5)
    truth = np.exp(-np.abs(np.subtract.outer(np.arange(40), np.arange(40))) / 3.0)
    factor = np.linalg.cholesky(truth)
    errors = []
    for _ in range(50):
        samples = rng.standard_normal((12, 40)) @ factor.T
        _, covariance = ensemble_covariance(samples)
        sample = np.cov(samples.T)
        errors.append(
            [
                np.linalg.norm(covariance / (1.0 + 1.0 / 12.0) - truth),
                np.linalg.norm(sample - truth),
            ]
        )
    shrunk, plain = np.mean(errors, axis=0)
    assert shrunk < 0.8 * plain


@settings(max_examples=20)
@given(st.integers(1, 3), st.integers(1, 6), st.integers(0, 10_000))
def test_kernel_is_positive_semi_definite(runs, places, seed):
    points = fake_points(runs, places, (("final_height", "value"), ("runout", "upper")))
    amplitude = np.random.default_rng(seed).lognormal(size=len(points))
    assert_positive_definite(discrepancy_kernel(points, amplitude), slack=1.0)


def test_kernel_correlates_what_is_one_and_nothing_else():
    points = fake_points(2, kinds=(("final_height", "value"), ("runout", "value")))
    kernel = discrepancy_kernel(points, np.full(len(points), 2.0))
    name, run, time = points.observable, points.experiment, points.time
    first = run == "r0"
    last = np.flatnonzero((name == "front") & first)[-1]
    runout = np.flatnonzero((name == "runout") & first)[0]
    assert kernel[last, runout] == pytest.approx(4.0)  # both at rest
    other = np.flatnonzero((name == "front") & ~first)[-1]
    assert kernel[last, other] == pytest.approx(2.0)  # half of it in another run
    assert not kernel[np.ix_(name == "front", name == "profiles")].any()
    front = np.flatnonzero((name == "front") & first)
    distance = (0.4 / 0.4 - time[front[1]] / 0.4) / 0.30
    at_duration = kernel[front[1], front] / 4.0
    expected = np.exp(-np.sqrt(3.0) * distance) * (1.0 + np.sqrt(3.0) * distance)
    assert np.interp(0.4, time[front], at_duration) == pytest.approx(expected, abs=0.02)


def test_amplitude_follows_the_parameters_with_a_floor():
    points = fake_points(1)
    variance = np.zeros(len(points))
    np.testing.assert_allclose(discrepancy_amplitude(points, variance), points.sigma)
    variance[points.observable == "front"] = 0.3**2
    variance[0] = 0.0
    amplitude = discrepancy_amplitude(points, variance)
    assert amplitude[1] == pytest.approx(0.3 * np.hypot(1.0, 0.3), rel=0.01)
    assert amplitude[0] == pytest.approx(0.3 * 0.3, rel=0.1)
