"""The film of a truth: places and times as stated, errors of the size that is stated."""

import io

import numpy as np
import pytest

from fvcollapse.blind.measurement import (
    drifting_errors,
    film,
    frames,
    heavy_tailed,
    jumping_errors,
    kept_frames,
    mixed,
    mixed_series,
)
from fvcollapse.blind.set_ups import SET_UPS, errors_of
from fvcollapse.blind.truth import View

ERRORS = errors_of(SET_UPS["slope16_width10"], "careful", 1.0)
EXACT = ERRORS._replace(**dict.fromkeys(ERRORS._fields, 0.0))
END, REACH = 0.8, 0.7


def a_view():
    """A wedge whose foot moves from 0.2 to 0.6 m in 1 s."""
    time, x = np.linspace(0.0, 1.0, 51), np.linspace(0.0, 1.0, 101)
    foot = 0.2 + 0.4 * time
    thickness = np.maximum(0.1 * (1.0 - x / foot[:, None]), 0.0)
    front = np.column_stack([time, foot])
    volume = np.column_stack([time, 0.05 * time])
    return View(front, volume, time, x, thickness, 0.5 * thickness)


def table(texts, name):
    return np.loadtxt(io.StringIO(texts[name]), delimiter=",", skiprows=1)


def test_without_errors_the_film_is_the_truth_to_a_pixel():
    texts = film(a_view(), END, REACH, EXACT, np.random.default_rng(0))
    t, front = table(texts, "front.csv").T
    assert front == pytest.approx(0.2 + 0.4 * t, abs=0.5001e-3)
    t, x, h = table(texts, "profiles.csv").T
    exact = np.maximum(0.1 * (1.0 - x / (0.2 + 0.4 * t)), 0.0)
    assert h == pytest.approx(exact, abs=0.0015)  # at the foot between two nodes
    t, x, z = table(texts, "interface.csv").T
    assert z == pytest.approx(0.05 * (1.0 - x / (0.2 + 0.4 * t)), abs=0.0015)
    t, volume = table(texts, "volume.csv").T
    assert volume == pytest.approx(0.05 * t, abs=0.3e-3)


def test_errors_of_a_whole_run():
    rng = np.random.default_rng(5)
    late = [
        np.interp(0.4, *table(film(a_view(), END, REACH, errors, rng), "front.csv").T)
        for errors in [EXACT._replace(time=0.05)] * 60
    ]
    assert np.std(late) == pytest.approx(0.4 * 0.05, rel=0.35)
    moved = [
        np.interp(0.4, *table(film(a_view(), END, REACH, errors, rng), "front.csv").T)
        for errors in [EXACT._replace(offset=0.01)] * 60
    ]
    assert np.std(moved) == pytest.approx(0.01, rel=0.35)
    high = [
        table(film(a_view(), END, REACH, errors, rng), "profiles.csv")[0, 2]
        for errors in [EXACT._replace(scale=0.05)] * 60
    ]
    assert np.std(high) / 0.0975 == pytest.approx(0.05, rel=0.35)


def test_readings_have_the_stated_scatter():
    rng = np.random.default_rng(2)
    gaps = []
    for _ in range(20):
        texts = film(a_view(), END, REACH, EXACT._replace(thickness=ERRORS.thickness), rng)
        t, x, h = table(texts, "profiles.csv").T
        exact = 0.1 * (1.0 - x / (0.2 + 0.4 * t))
        gaps.append((h - exact)[exact > 0.01])
    assert np.std(np.concatenate(gaps)) == pytest.approx(ERRORS.thickness, rel=0.1)


@pytest.mark.parametrize(
    "errors",
    [
        lambda rng: heavy_tailed(60, rng),
        lambda rng: drifting_errors(10, np.linspace(0.0, 0.3, 31), rng).ravel(),
        lambda rng: jumping_errors(60, rng),
        lambda rng: mixed(drifting_errors(10, np.linspace(0.0, 0.3, 31), rng), rng).ravel(),
    ],
    ids=["heavy_tailed", "drifting", "jumping", "mixed"],
)
def test_errors_have_unit_variance(errors):
    rng = np.random.default_rng(3)
    drawn = np.concatenate([errors(rng) for _ in range(300)])
    assert np.mean(drawn) == pytest.approx(0.0, abs=0.05)
    assert np.std(drawn) == pytest.approx(1.0, rel=0.06)


def test_a_drift_ends_at_its_standard_deviation():
    rng = np.random.default_rng(4)
    last = [mixed_series(20, rng)[-1] for _ in range(2000)]
    assert np.std(last) == pytest.approx(1.0, rel=0.08)


def test_neighbours_share_errors_of_thickness():
    rng = np.random.default_rng(6)
    rows = np.concatenate([drifting_errors(3, np.array([0.0, 0.01, 0.3]), rng) for _ in range(500)])
    correlation = np.corrcoef(rows.T)
    assert correlation[0, 1] > 0.9
    assert abs(correlation[0, 2]) < 0.1


def test_frames_are_missing_now_and_then_but_not_the_first_and_last():
    rng = np.random.default_rng(7)
    every = frames(1.0)
    assert every[-1] == pytest.approx(1.0)
    kept = [kept_frames(every, rng) for _ in range(200)]
    assert all(time[0] == 0.0 and time[-1] == every[-1] for time in kept)
    assert 0.02 < 1.0 - np.mean([len(time) / len(every) for time in kept]) < 0.08


def test_a_front_that_leaves_the_picture_is_not_measured_any_more():
    texts = film(a_view(), END, 0.4, EXACT, np.random.default_rng(0))
    t, front = table(texts, "front.csv").T
    assert front.max() <= 0.4
    assert t.max() <= 0.5 + 1e-9
    assert table(texts, "volume.csv")[-1, 0] == t.max()
    assert table(texts, "profiles.csv")[-1, 0] == pytest.approx(END)
