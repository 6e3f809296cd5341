"""Separability: collinear and orthogonal signatures, classes, the null test."""

import numpy as np
import pytest
from fake_points import fake_points

from fvcollapse.diagnosis.covariance import discrepancy_kernel, ensemble_covariance
from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.evidence import ModelComparison
from fvcollapse.diagnosis.separability import null_test, separability

N = 6


def effect(*values):
    """A response that is the same everywhere."""
    difference = np.zeros(N)
    difference[: len(values)] = values
    return Response.fit([[0.2], [0.9]], [difference, difference])


def test_collinear_signatures_are_one_and_orthogonal_ones_their_own():
    effects = {
        "a": effect(5.0),
        "b": effect(-3.0),
        "c": effect(0.0, 4.0),
        "d": effect(0.0, 0.0, 1.0),
    }
    found = separability(np.eye(N), np.zeros((N, N)), effects)
    np.testing.assert_allclose(found.snr, [5.0, 3.0, 4.0, 1.0])
    assert found.distance[0, 1] == found.distance[1, 0] == 0.0
    assert found.cosine[0, 1] == pytest.approx(-1.0)
    assert found.distance[0, 2] == pytest.approx(25.0)
    assert found.distance[2, 0] == pytest.approx(16.0)
    np.testing.assert_allclose(found.unique_snr, [0.0, 0.0, 4.0, 1.0], atol=1e-9)
    assert found.classes == (("a", "b"),)  # d is not alike, it is not visible
    assert found.insufficient == ("a", "b", "d")


def test_what_the_calibration_can_imitate_does_not_count():
    effects = {"a": effect(5.0, 1.0), "b": effect(5.0, -1.0)}
    calibrated = np.zeros((N, N))
    before = separability(np.eye(N), np.zeros((N, N)), effects)
    calibrated[0, 0] = 1.0e6
    after = separability(np.eye(N) + calibrated, np.zeros((N, N)), effects)
    assert before.cosine[0, 1] == pytest.approx(24.0 / 26.0)
    assert after.cosine[0, 1] == pytest.approx(-1.0, abs=1e-4)
    assert after.snr[0] == pytest.approx(1.0, abs=1e-4)
    as_discrepancy = separability(np.eye(N), calibrated / 0.04, effects)
    np.testing.assert_allclose(as_discrepancy.cosine, after.cosine)


def test_signatures_are_taken_at_the_given_strength():
    response = Response.fit([[0.0], [1.0]], [np.zeros(N), np.r_[10.0, np.zeros(N - 1)]])
    half = separability(np.eye(N), np.zeros((N, N)), {"a": [response, effect(7.0)]})
    full = separability(np.eye(N), np.zeros((N, N)), {"a": response}, at={"a": np.array([0.9])})
    assert half.snr == pytest.approx([5.0])
    assert full.snr == pytest.approx([9.0])
    assert half.unique_snr == pytest.approx([5.0])


def test_null_test_flags_what_looks_like_a_mis_calibration():
    """The ensemble moves the front; an effect that does the same wins where one does not."""
    points = fake_points(1)
    rng = np.random.default_rng(2)
    front = np.where(points.observable == "front", points.time, 0.0)
    wave = np.where(points.observable == "profiles", np.sin(9.0 * points.x), 0.0)
    samples = points.measured + 0.10 * rng.standard_normal((20, 1)) * front
    mean, ensemble = ensemble_covariance(samples)
    measurement = np.diag(points.sigma**2)
    effects = {
        "alike": Response.of_one_level(0.2 * front),
        "other": Response.of_one_level(0.02 * wave),
    }
    kernel = discrepancy_kernel(points, points.sigma)
    shares = {}
    for name, known in (("marginalised", ensemble), ("ignored", 0.0 * ensemble)):
        comparison = ModelComparison(measurement + known, kernel, effects, points)
        shares[name] = null_test(samples, mean, comparison, measurement, rng)
        assert sum(shares[name].values()) == pytest.approx(1.0)
        assert "other" not in shares[name]
    assert shares["ignored"]["alike"] >= 0.3
    assert shares["ignored"].get("none", 0.0) <= 0.4
    assert shares["marginalised"]["none"] >= 0.6


def test_no_effect_that_shows_leaves_nothing_to_separate():
    found = separability(np.eye(3), np.zeros((3, 3)), {})
    assert found.names == found.classes == found.insufficient == ()
    assert found.cosine.shape == found.distance.shape == (0, 0)
    assert found.snr.shape == found.unique_snr.shape == (0,)
