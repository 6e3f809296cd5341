"""The mass balance of measured profiles: exact piles, wrong scales and views, and what cannot tell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import multivariate_normal as normal
from toy_laboratory import film

from fvcollapse import load_experiment
from fvcollapse.diagnosis import mass_balance as module
from fvcollapse.diagnosis.mass_balance import (
    CHANGES,
    MassBalance,
    area_beyond,
    column_area,
    inflation,
    mass_balance,
)
from fvcollapse.diagnosis.names import UNKNOWN
from fvcollapse.diagnosis.report.limits import grain_words
from fvcollapse.measure.curves import curve_text

TIMES = np.arange(0.0, 1.01, 0.05)
PLACES = np.arange(0.005, 1.2, 0.01)
HEIGHT, LENGTH = 0.14, 0.2  # of the column of the toy laboratory
VIEW, WRONG = CHANGES["transverse_profile"][1], CHANGES[UNKNOWN][1]
SMALL = np.diag([0.012, 0.015]) ** 2


def wedges(folder, magnified=1.0, stretched=1.0, swelling=0.0, zero=0.0, film_volume=False, **keys):
    """An experiment whose column becomes a wedge of the same area, four times as long; seen wrongly.

    `swelling` within a tenth of the duration; `zero` of the heights; `film_volume`: V is the area that is seen.
    """
    film(folder)
    reach, spacing = keys.get("reach", 1.2), keys.get("every", 1)
    rows, volume, front = [], [], []
    for time in keys.get("times", TIMES):
        length = LENGTH * (1.0 + 3.0 * time)
        swollen = 1.0 + swelling * min(time / 0.1, 1.0)
        x = PLACES[::spacing] / magnified
        x = np.where(x > LENGTH, LENGTH + (x - LENGTH) / stretched, x)
        height = 2.0 * HEIGHT * LENGTH * swollen / length * np.maximum(1.0 - x / length, 0.0)
        rows.append(np.column_stack([np.full_like(x, time), PLACES[::spacing], height + zero]))
        volume.append(
            (time, (height.sum() / rows[0][:, 2].sum() if film_volume else swollen) - 1.0)
        )
        front.append((time, magnified * (LENGTH + stretched * (length - LENGTH))))
    table = np.vstack([each[each[:, 1] < reach] for each in rows])
    table[:, 2] += 1.0e-4 * np.random.default_rng(keys.get("seed", 0)).standard_normal(len(table))
    for name, curve in (("profiles", table), ("volume", volume), ("front", front)):
        (folder / f"{name}.csv").write_text(curve_text(name, np.array(curve)), encoding="utf-8")
    return load_experiment(folder)


def balance(*experiments):
    return mass_balance(experiments, {one.name: one.case() for one in experiments})


@pytest.mark.parametrize("swelling", [0.0, 0.06])
def test_all_grains_are_in_view(tmp_path, swelling):
    found = balance(wedges(tmp_path / "wedges", swelling=swelling))
    assert found.mean == pytest.approx([0.0, 0.0], abs=4e-3)
    assert found.log_odds(WRONG) < 0.0
    assert found.logit("transverse_profile") == 0.0
    assert grain_words(found) == []


@pytest.mark.parametrize(("magnified", "side"), [(0.92, "less"), (1.08, "more")])
def test_a_wrong_scale_is_there_from_the_first_frame_on(tmp_path, magnified, side):
    found = balance(wedges(tmp_path / "wedges", magnified=magnified))
    assert found.mean[0] == pytest.approx(magnified - 1.0, abs=8e-3)
    assert found.logit(UNKNOWN) > 2.0
    (words,) = grain_words(found)
    assert f"{side} than the column" in words


@pytest.mark.parametrize(("stretched", "pace"), [(0.85, "slower"), (1.1, "faster")])
def test_a_view_from_a_side_stretches_what_has_passed_the_gate(tmp_path, stretched, pace):
    found = balance(wedges(tmp_path / "wedges", stretched=stretched))
    # B = (s - 1) phi, and what is seen beyond the gate is s phi of 1 + B
    assert found.mean[1] == pytest.approx((stretched - 1.0) / stretched, rel=0.15)
    assert abs(found.mean[0]) < 0.02
    assert found.logit("transverse_profile") == found.logit("gate+transverse_profile") > 3.0
    assert found.logit(UNKNOWN) < 0.0
    assert found.logit("gate") == 0.0
    (words,) = grain_words(found)
    assert pace in words


def test_a_volume_off_the_same_film_is_no_evidence_against_a_view(tmp_path):
    found = balance(wedges(tmp_path / "wedges", stretched=0.85, film_volume=True))
    assert found.mean[1] == pytest.approx(0.0, abs=0.02)
    assert found.logit("transverse_profile") == 0.0


def test_a_zero_that_is_off_accuses_no_length(tmp_path):
    """Where the bare bed is in view it tells how wrong the zero can be: 1 mm is 4 % of the area."""
    found = balance(wedges(tmp_path / "wedges", zero=1.0e-3))
    assert max(found.mean) > 0.005
    assert found.logit(UNKNOWN) < 0.7
    assert grain_words(found) == []


def test_without_a_measured_volume_the_grains_may_have_swollen(tmp_path):
    wedges(tmp_path / "wedges", swelling=0.05)
    (tmp_path / "wedges" / "volume.csv").unlink()
    found = balance(load_experiment(tmp_path / "wedges"))
    assert found.mean[0] > 0.03
    assert found.logit(UNKNOWN) < 0.5
    assert grain_words(found) == []
    text = "t_s,relative_volume_change\n0.0,0.3\n1.0,0.35\n"  # grains do not swell at once
    (tmp_path / "wedges" / "volume.csv").write_text(text)
    again = balance(load_experiment(tmp_path / "wedges"))
    np.testing.assert_array_equal(again.mean, found.mean)


def test_experiments_share_the_errors_of_the_camera_and_not_those_of_the_column(tmp_path):
    many = [wedges(tmp_path / f"n{n}", seed=n) for n in range(6)]
    one, all_of_them = balance(many[0]), balance(*many)
    assert 0.3 < all_of_them.covariance[0, 0] / one.covariance[0, 0] < 0.9
    assert all_of_them.covariance[1, 1] > module.RIM[1] ** 2


@pytest.mark.parametrize(
    "keys",
    [
        {"reach": 0.22},  # grains run out of view
        {"every": 8},  # few places
        {"times": TIMES[:7]},  # few frames
        {"times": np.linspace(0.9, 1.0, 21)},  # all of the same reach
    ],
    ids=str,
)
def test_what_cannot_tell_says_nothing(tmp_path, keys):
    poor = wedges(tmp_path / "poor", **keys)
    assert balance(poor) is None
    whole = wedges(tmp_path / "whole")
    np.testing.assert_array_equal(balance(whole).mean, balance(poor, whole).mean)
    (tmp_path / "poor" / "profiles.csv").unlink()
    assert balance(load_experiment(tmp_path / "poor")) is None


def test_a_lost_picture_is_left_out(tmp_path):
    whole = balance(wedges(tmp_path / "wedges"))
    path = tmp_path / "wedges" / "profiles.csv"
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    rows[np.isclose(rows[:, 0], 0.5), 2] = 0.0
    path.write_text(curve_text("profiles", rows))
    found = balance(load_experiment(tmp_path / "wedges"))
    assert found.mean == pytest.approx(whole.mean, abs=5e-3)


def test_the_column_may_be_a_polygon(tmp_path):
    one = wedges(tmp_path / "wedges")
    slumped = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.1, 0.14], [0.0, 0.14]]
    case = one.case().replace(**{"geometry.polygon": slumped})
    assert column_area(case.geometry) == pytest.approx(0.028 - 0.002)
    found = mass_balance([one], {one.name: case})
    assert found.mean[0] == pytest.approx(0.028 / 0.026 - 1.0, abs=5e-3)


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_odds_grow_with_what_is_off_and_stay_bounded(shift, stretch):
    found = MassBalance(np.array([shift, stretch]), SMALL)
    farther = found._replace(mean=found.mean * 1.1)
    for spread in (WRONG, VIEW):
        assert farther.log_odds(spread) >= found.log_odds(spread) - 1e-12
    for name in ("transverse_profile", UNKNOWN, "gate"):
        assert -0.3 < found.logit(name) < 6.5
    assert MassBalance(np.zeros(2), SMALL).log_odds(WRONG) < 0.0


def test_odds_are_a_ratio_of_normal_densities():
    mean, covariance = np.array([0.03, -0.02]), np.array([[2.0, 0.6], [0.6, 3.0]]) * 1e-4
    wide = covariance + np.diag(np.square(WRONG))
    expected = normal(cov=wide).logpdf(mean) - normal(cov=covariance).logpdf(mean)
    assert MassBalance(mean, covariance).log_odds(WRONG) == pytest.approx(expected)


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
    assert inflation(np.zeros(20)) == pytest.approx(1.05 / 0.95)
