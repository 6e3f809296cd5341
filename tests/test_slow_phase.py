"""The slow phase of a front: what counts as one, on fronts whose speed is known, and the search for it."""

import argparse
import math

import numpy as np
import pytest

from runs.paper import slow_front
from runs.paper import slow_phase as search
from runs.paper.slow_front import LEAST_TIME, Phase, least_ratio, motion, slow_phase
from runs.paper.slow_sets import SHOWN, all_sets
from runs.table import as_line, read_table

CELL = 0.006  # m
TIME = np.arange(0.0, 3.0, 0.0024)  # s, about the steps of a run
PEAK_AT, PEAK, GATE = 0.3, 1.3, 0.2


def moved(after, time=TIME):
    """Front whose speed rises to 1.3 m/s at 0.3 s and then is `after(time since)` [m/s]."""
    speed = np.where(time < PEAK_AT, PEAK * time / PEAK_AT, np.maximum(after(time - PEAK_AT), 0.0))
    steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
    return GATE + np.concatenate([[0.0], np.cumsum(steps)])


def in_steps(front, share=1.0):
    """The same front that waits at each cell: 1 = it jumps from cell to cell."""
    return front + share * (CELL * np.floor(front / CELL) - front)


def in_waves(front, height=0.1):
    """The same front with a wave of one cell: its speed goes up and down by a factor 1 +- 2 pi `height`."""
    return front + height * CELL * np.sin(2.0 * np.pi * front / CELL)


READ = [lambda front: front, in_steps, lambda front: in_steps(front, 0.5), in_waves]


def with_plateau(lasts, speed=0.3):
    """1.3 m/s, in 0.2 s down to `speed`, which it keeps for `lasts`, then a stop within 0.1 s."""
    return lambda since: np.interp(
        since, [0.0, 0.2, 0.2 + lasts, 0.3 + lasts], [PEAK, speed, speed, 0]
    )


@pytest.mark.parametrize("read", READ)
@pytest.mark.parametrize("lasts", [0.4, 1.0, 2.0])
def test_a_constant_deceleration_is_no_slow_phase(read, lasts):
    of = motion(TIME, read(moved(lambda since: PEAK * (1.0 - since / lasts))), CELL)
    assert slow_phase(of).duration < LEAST_TIME
    assert not least_ratio(of) < 1.0


@pytest.mark.parametrize("read", READ)
@pytest.mark.parametrize("scale", [0.15, 0.3, 0.6, 1.2])
def test_an_exponential_decay_is_no_slow_phase(read, scale):
    of = motion(TIME, read(moved(lambda since: PEAK * np.exp(-since / scale))), CELL)
    assert slow_phase(of).duration < LEAST_TIME
    assert least_ratio(of) == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("read", READ)
@pytest.mark.parametrize(("lasts", "speed"), [(0.3, 0.3), (0.8, 0.3), (0.8, 0.15), (0.4, 0.6)])
def test_a_plateau_is_found_where_it_is(read, lasts, speed):
    found = slow_phase(motion(TIME, read(moved(with_plateau(lasts, speed))), CELL))
    # a speed is a mean over 80 ms or two cells, which blurs both ends by half of that
    blur = 0.5 * max(0.08, 2.0 * CELL / speed)
    assert found.start == pytest.approx(PEAK_AT + 0.2, abs=blur + 0.02)
    assert found.duration == pytest.approx(lasts, abs=2.0 * blur + 0.03)
    assert found.speed == pytest.approx(speed, rel=0.05)


@pytest.mark.parametrize("read", READ)
def test_a_plateau_of_a_twentieth_of_a_second_does_not_last_long_enough(read):
    of = motion(TIME, read(moved(with_plateau(0.05))), CELL)
    assert slow_phase(of).duration < LEAST_TIME


def test_a_front_that_waits_and_moves_once_more_has_no_slow_phase():
    front = moved(with_plateau(0.0))
    again = front + 0.01 * np.clip((TIME - 1.5) / 0.1, 0.0, 1.0)
    assert slow_phase(motion(TIME, again, CELL)) == Phase()


def test_a_creeping_front_has_no_slow_phase():
    of = motion(TIME, moved(with_plateau(2.0, speed=0.02)), CELL)
    assert slow_phase(of).duration < LEAST_TIME


def test_a_slow_phase_counts_up_to_where_the_run_ends():
    found = slow_phase(motion(TIME, moved(with_plateau(9.0)), CELL))
    assert found.start + found.duration == pytest.approx(TIME[-1], abs=0.08)


def test_speed_is_that_of_whole_cells_whatever_the_front_does_within():
    even = GATE + 0.3 * TIME
    for read in READ:
        of = motion(TIME, read(even), CELL)
        inside = (of.time > 0.2) & (of.time < 2.7)
        np.testing.assert_allclose(of.speed[inside], 0.3, rtol=0.06)


def test_a_coarse_grid_does_not_resolve_a_short_way():
    short = moved(with_plateau(0.25, speed=0.2))  # 5 cm: four cells of 12 mm, eight of 6 mm
    assert slow_phase(motion(TIME, short, 2.0 * CELL)) == Phase()
    assert slow_phase(motion(TIME, short, CELL)).duration > LEAST_TIME


@pytest.mark.parametrize("speed", [0.9, 0.05])
def test_a_plateau_that_is_not_slow_or_creeps_is_none(speed):
    of = motion(TIME, moved(with_plateau(1.0, speed)), CELL)
    assert slow_phase(of).duration < LEAST_TIME


def test_nothing_is_said_of_a_front_that_rests():
    of = motion(TIME, np.full_like(TIME, GATE), CELL)
    assert slow_phase(of).duration < LEAST_TIME
    assert math.isnan(least_ratio(of))


def test_slopes_are_those_of_all_beginnings():
    x, y = np.array([0.0, 1.0, 2.0, 4.0]), np.array([1.0, 2.0, 2.0, 5.0])
    for count in (2, 3, 4):
        expected = np.polyfit(x[:count], y[:count], 1)[0]
        assert slow_front.slopes(x, y)[count - 1] == pytest.approx(expected)


def test_the_speeds_of_the_figure_are_those_of_the_table(tmp_path, monkeypatch):
    """The fronts of a run on two grids: their peaks in the curves and in the table of the phases."""
    sets = {SHOWN[0]: all_sets()[SHOWN[0]] | {"time.end": 0.4}}
    for name, value in {"all_sets": lambda: sets, "SHOWN": SHOWN[:1], "FINER": (1.0, 1.5)}.items():
        monkeypatch.setattr(search, name, value)
    monkeypatch.setattr(search, "FINER_SETS", SHOWN[:1])
    options = argparse.Namespace(out=tmp_path, tables=tmp_path, cell_size=0.024, workers=1)
    assert search.search(options) == []
    phases = {row["name"]: row for row in read_table(tmp_path / "slow_phase" / "phases.csv")}
    curves = read_table(tmp_path / "slow_phase" / "speeds.csv")
    assert len(curves) == 2 * len(search.FRONTS)
    for row in curves:
        millimetres = row["quantity"].split("_")[1]
        peak = float(phases[f"{SHOWN[0]}; {row['cell_size_mm']} mm"][f"peak_{millimetres}_m_s"])
        assert as_line(row).values.max() == pytest.approx(peak, abs=5e-4)
        assert float(row["refinement"]) * float(row["cell_size_mm"]) == pytest.approx(24.0)
