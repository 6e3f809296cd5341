"""Gap map: false alarms under correlation, a planted gap, bounds, shares, words."""

import numpy as np
import pytest
from fake_points import fake_points
from scipy.stats import binom

from fvcollapse.diagnosis.covariance import discrepancy_kernel
from fvcollapse.diagnosis.gap_map import clusters, gap_map, neighbours
from fvcollapse.diagnosis.report.regions import region_lines

DRAWS = 200


def correlated(points):
    """A covariance with smooth parts twice as large as the scatter of single points."""
    return np.diag(points.sigma**2) + discrepancy_kernel(points, 2.0 * points.sigma)


def test_false_alarms_of_the_family_are_five_percent():
    points = fake_points(2, kinds=(("final_height", "value"), ("runout", "upper")))
    covariance = correlated(points)
    factor, rng = np.linalg.cholesky(covariance), np.random.default_rng(11)
    alarms = 0
    for _ in range(DRAWS):
        error = factor @ rng.standard_normal(len(points))
        alarms += bool(gap_map(points, points.measured + error, covariance, rng).regions)
    low, high = binom.ppf([0.005, 0.995], DRAWS, 0.05)
    assert low <= alarms <= high


def test_a_planted_gap_is_found_where_it_is_and_told_in_words():
    points = fake_points(2)
    covariance = np.diag(points.sigma**2)
    late = (points.experiment == "r1") & (points.observable == "front") & (points.time > 0.5)
    simulated = points.measured + np.where(late, 0.08, 0.0)
    found = gap_map(points, simulated, covariance, np.random.default_rng(0))
    (region,) = found.regions
    assert (region.experiment, region.observable, region.units) == ("r1", "front", "m")
    np.testing.assert_array_equal(region.points, np.flatnonzero(late))
    assert region.t_range == (points.time[late].min(), 1.0)
    assert region.x_range is None
    assert region.gap == pytest.approx(0.08)
    assert region.uncertainty == pytest.approx(0.01 / np.sqrt(late.sum()))
    assert region.significance == pytest.approx(region.gap / region.uncertainty)
    assert region.p_value <= 0.002
    words = "front position 8.0 ± 0.4 cm too far from 0.55 s on; nothing significant before 0.55 s"
    assert region_lines(points, found.regions) == [words]
    np.testing.assert_array_equal(found.discoveries, late)
    best = max(found.shares, key=lambda share: share.share)
    assert (best.experiment, best.observable, best.phase, best.sign) == (
        "r1",
        "front",
        "deposit",
        1,
    )
    level = next(e for e in found.by_observable if (e.experiment, e.observable) == ("r1", "front"))
    assert level.combined == pytest.approx(0.01)
    assert level.ratio == pytest.approx(8.0 * np.sqrt(late[points.of("r1")].sum() / 12.0))


def test_a_patch_of_a_profile_has_a_place_and_a_sign():
    points = fake_points(1, places=20)
    covariance = np.diag(points.sigma**2)
    patch = (points.observable == "profiles") & (points.time > 0.15) & (points.time < 0.4)
    patch &= (points.x > 0.2) & (points.x < 0.35)
    simulated = points.measured - np.where(patch, 0.01, 0.0)
    (region,) = gap_map(points, simulated, covariance, np.random.default_rng(0)).regions
    np.testing.assert_array_equal(np.sort(region.points), np.flatnonzero(patch))
    assert region.t_range == (0.2, 0.3)
    assert region.x_range[0] > 0.2
    assert region.x_range[1] < 0.35
    (text,) = region_lines(points, [region])
    assert text.startswith("thickness 1.00 ± 0.0")
    assert "too small, X = 22 to 35 cm from 0.20 to 0.30 s" in text


def test_a_bound_counts_only_beyond():
    points = fake_points(1, kinds=(("final_height", "upper"), ("runout", "lower")))
    covariance, rng = np.diag(points.sigma**2), np.random.default_rng(0)
    kept = points.measured.copy()
    kept[-2:] += (-1.0, 1.0)
    inside = gap_map(points, kept, covariance, rng)
    assert not inside.gap.any()
    assert inside.regions == ()
    kept[-2:] = points.measured[-2:] + (0.012, -0.1)
    beyond = gap_map(points, kept, covariance, rng)
    np.testing.assert_allclose(beyond.z[-2:], [6.0, -10.0])
    texts = region_lines(points, beyond.regions)
    assert texts[0] == "runout 10.0 ± 1.0 cm not far enough (beyond the lower bound)"
    assert texts[1] == "final height 1.2 ± 0.2 cm too large (beyond the upper bound)"


def test_shares_sum_to_one_and_are_not_negative():
    points = fake_points(2)
    rng = np.random.default_rng(3)
    simulated = points.measured + 0.01 * rng.standard_normal(len(points))
    shares = [share.share for share in gap_map(points, simulated, correlated(points), rng).shares]
    assert min(shares) >= 0.0
    assert sum(shares) == pytest.approx(1.0)


def test_clusters_join_neighbours_of_one_sign():
    block = fake_points(1, places=4).blocks[1]
    z = np.zeros((5, 4))
    z[0, 0], z[1, 0], z[1, 1] = 3.0, 4.0, -5.0  # the last has the other sign
    z[3, 3], z[4, 2] = 2.5, 3.5  # diagonal: apart
    labels, masses = clusters(z.reshape(1, -1), neighbours(block))
    found = {tuple(sorted(m)): mass for m, mass in zip(labels["members"], masses, strict=True)}
    assert found == pytest.approx({(0, 4): 3.0, (5,): 3.0, (15,): 0.5, (18,): 1.5})
