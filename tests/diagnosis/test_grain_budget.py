"""The mass balance of measured profiles: exact piles, wrong scales and views, and what cannot tell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import multivariate_normal as normal
from toy_laboratory import film

from fvcollapse import load_experiment
from fvcollapse.curves import curve_text
from fvcollapse.diagnosis.grain_budget import (
    VIEW,
    WRONG,
    Budget,
    area_beyond,
    grain_budget,
    inflation,
)

TIMES = np.arange(0.0, 1.01, 0.05)
PLACES = np.arange(0.005, 1.2, 0.01)
HEIGHT, LENGTH = 0.14, 0.2  # of the column of the toy laboratory


def wedges(folder, magnified=1.0, stretched=1.0, swelling=0.0, seed=0, noise=1.0e-4, reach=1.2):
    """An experiment whose column becomes a wedge of the same area, four times as long; seen wrongly."""
    film(folder)
    rows, volume = [], []
    for time in TIMES:
        length = LENGTH * (1.0 + 3.0 * time)
        swollen = 1.0 + swelling * time
        x = PLACES / magnified
        x = np.where(x > LENGTH, LENGTH + (x - LENGTH) / stretched, x)
        top = 2.0 * HEIGHT * LENGTH * swollen / length
        rows.append(
            np.column_stack(
                [np.full_like(x, time), PLACES, top * np.maximum(1.0 - x / length, 0.0)]
            )
        )
        volume.append((time, swollen - 1.0))
    table = np.vstack([each[each[:, 1] < reach] for each in rows])
    table[:, 2] += noise * np.random.default_rng(seed).standard_normal(len(table))
    (folder / "profiles.csv").write_text(curve_text("profiles", table), encoding="utf-8")
    (folder / "volume.csv").write_text(curve_text("volume", np.array(volume)), encoding="utf-8")
    return load_experiment(folder)


@pytest.mark.parametrize("swelling", [0.0, 0.06])
def test_all_grains_are_in_view(tmp_path, swelling):
    found = grain_budget([wedges(tmp_path / "wedges", swelling=swelling)])
    assert found.mean == pytest.approx([0.0, 0.0], abs=2e-3)
    assert found.log_odds(WRONG) < 0.0
    assert found.log_odds(VIEW) < 0.0


@pytest.mark.parametrize("magnified", [0.94, 1.05])
def test_a_wrong_scale_is_there_from_the_first_picture_on(tmp_path, magnified):
    found = grain_budget([wedges(tmp_path / "wedges", magnified=magnified)])
    assert found.mean[0] == pytest.approx(magnified - 1.0, abs=5e-3)
    assert found.log_odds(WRONG) > max(found.log_odds(VIEW), 4.0)


@pytest.mark.parametrize("stretched", [0.85, 1.1])
def test_a_view_from_a_side_stretches_what_has_passed_the_gate(tmp_path, stretched):
    found = grain_budget([wedges(tmp_path / "wedges", stretched=stretched)])
    # B = (s - 1) phi_true, and what is measured beyond the gate is s phi_true of 1 + B
    assert found.mean[1] == pytest.approx((stretched - 1.0) / stretched, rel=0.15)
    assert abs(found.mean[0]) < 0.02
    assert found.log_odds(VIEW) > max(found.log_odds(WRONG), 4.0)


def test_experiments_together_know_more_than_each(tmp_path):
    both = [wedges(tmp_path / name, magnified=1.04, seed=n) for n, name in enumerate("ab")]
    one, two = grain_budget(both[:1]), grain_budget(both)
    assert two.covariance[0, 0] == pytest.approx(0.5 * one.covariance[0, 0], rel=0.02)
    assert two.log_odds(WRONG) > one.log_odds(WRONG) + 2.0


def test_what_cannot_tell_says_nothing(tmp_path):
    cut = wedges(tmp_path / "cut", reach=0.22)  # grains run out of view
    assert grain_budget([cut]) is None
    (tmp_path / "cut" / "profiles.csv").unlink()
    assert grain_budget([load_experiment(tmp_path / "cut")]) is None
    whole = wedges(tmp_path / "whole")
    alone, beside = grain_budget([whole]), grain_budget([cut, whole])
    np.testing.assert_array_equal(alone.mean, beside.mean)


def test_without_a_measured_volume_the_grains_may_have_swollen(tmp_path):
    known = grain_budget([wedges(tmp_path / "wedges")])
    (tmp_path / "wedges" / "volume.csv").unlink()
    unknown = grain_budget([load_experiment(tmp_path / "wedges")])
    assert unknown.covariance[1, 1] > 2.0 * known.covariance[1, 1]


@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2))
def test_odds_grow_with_what_is_off_and_never_without_it(shift, stretch):
    covariance = np.diag([0.012, 0.015]) ** 2
    found = Budget(np.array([shift, stretch]), covariance)
    assert found.log_odds((0.0, 0.0)) == pytest.approx(0.0, abs=1e-9)
    farther = found._replace(mean=found.mean * 1.1)
    for spread in (WRONG, VIEW):
        assert farther.log_odds(spread) >= found.log_odds(spread) - 1e-12
    assert Budget(np.zeros(2), covariance).log_odds(WRONG) < 0.0


def test_odds_are_a_ratio_of_normal_densities():
    mean, covariance = np.array([0.03, -0.02]), np.array([[2.0, 0.6], [0.6, 3.0]]) * 1e-4
    wide = covariance + np.diag(np.square(WRONG))
    expected = normal(cov=wide).logpdf(mean) - normal(cov=covariance).logpdf(mean)
    assert Budget(mean, covariance).log_odds(WRONG) == pytest.approx(expected)


def test_area_beyond_the_gate_between_two_places():
    x = np.linspace(0.0, 1.0, 11)
    assert area_beyond(x, 1.0 - x, 0.25) == pytest.approx(0.5 * 0.75**2, rel=1e-12)


def test_neighbours_in_time_that_are_alike_count_less():
    rng = np.random.default_rng(0)
    fresh = rng.standard_normal(4000)
    drifting = fresh.copy()
    for n in range(1, len(drifting)):
        drifting[n] += 0.6 * drifting[n - 1]
    assert inflation(fresh) == pytest.approx(1.0, abs=0.1)
    assert inflation(drifting) == pytest.approx(4.0, rel=0.15)
    assert inflation(np.zeros(5)) == 1.0
