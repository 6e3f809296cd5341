"""What statements read off the tables: how a deceleration bends, shapes in units of their length, counts of solves."""

import math

import numpy as np
import pytest

from runs import table
from runs.paper import measures, statement_terms, statements_cost
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED, Clause

PEAK, RISE, FALL = 1.3, 30, 120  # m/s, points


def slowing(after):
    """Front velocity that rises to its peak and then is `after(share of the fall)` times it, 10 ms apart."""
    return PEAK * np.concatenate(
        [np.linspace(0.0, 1.0, RISE, endpoint=False), after(np.linspace(0.0, 1.0, FALL))]
    )


def test_a_constant_deceleration_does_not_bend():
    assert measures.convexity(slowing(lambda s: 1.0 - s)) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("bend", [-0.8, -0.3, 0.4, 0.9])
def test_the_bend_of_a_parabola_is_that_of_its_part(bend):
    """v = 1 - (1 + b/2) s + (b/2) s^2 decelerates by 1 + b/2 at the peak and by 1 - b/2 at the end."""
    velocity = slowing(lambda s: 1.0 - (1.0 + bend / 2.0) * s + bend / 2.0 * s * s)
    levels = np.array([measures.BENDS_FROM, measures.BENDS_TO])
    levels *= measures.peak_velocity(velocity) / PEAK  # a kink is no parabola: it is a little lower

    def time_of(level):
        roots = np.roots([bend / 2.0, -(1.0 + bend / 2.0), 1.0 - level])
        return float(roots[(roots > 0.0) & (roots < 1.0)][0])

    part = time_of(levels[1]) - time_of(levels[0])
    expected = bend * part**2 / (levels[0] - levels[1])
    assert measures.convexity(velocity) == pytest.approx(expected, rel=0.05)


def test_fast_then_slow_bends_upwards_and_too_short_a_fall_says_nothing():
    assert measures.convexity(slowing(lambda s: np.exp(-4.0 * s))) > 0.5
    assert measures.convexity(slowing(lambda s: np.sqrt(1.0 - s))) < -0.3
    assert math.isnan(measures.convexity(slowing(lambda s: np.where(s < 0.02, 1.0, 0.0))))


def about_its_peak(time):
    """1.3 m/s at 0.4 s, a parabola in time, zero at 0 and 0.8 s."""
    return PEAK * np.maximum(1.0 - ((time - 0.4) / 0.4) ** 2, 0.0)


def test_the_peak_of_a_parabola_is_exact_and_a_ripple_hardly_moves_it():
    time = measures.STEP * np.arange(120)
    assert measures.peak_velocity(about_its_peak(time)) == pytest.approx(PEAK, rel=1e-9)
    for phase in np.linspace(0.0, 2.0 * np.pi, 7):
        ripple = 1.0 + 0.03 * np.sin(
            2.0 * np.pi * time / 0.05 + phase
        )  # 6 cm at 1.3 m/s: ten cells
        rough = about_its_peak(time) * ripple
        assert rough.max() > 1.025 * PEAK
        assert measures.peak_velocity(rough) == pytest.approx(PEAK, rel=0.012)


@pytest.mark.parametrize("about", statement_terms.PEAKS.values())
def test_all_windows_of_a_peak_give_that_of_a_parabola(about):
    velocity = about_its_peak(measures.STEP * np.arange(120))
    assert measures.peak_velocity(velocity, about) == pytest.approx(PEAK, rel=1e-9)


def test_the_largest_value_keeps_its_ripple():
    rough = about_its_peak(measures.STEP * np.arange(120))
    rough[40] *= 1.05
    assert measures.peak_velocity(rough, 1.0) == rough[40] == pytest.approx(1.05 * PEAK)


def test_windows_of_a_deceleration_agree_on_one_that_is_constant():
    velocity = slowing(lambda s: 1.0 - s)
    bends = [measures.convexity(velocity, *window) for window in statement_terms.BENDS.values()]
    assert bends == pytest.approx([0.0] * len(bends), abs=1e-9)


def test_a_peak_at_the_end_or_of_a_few_values_is_the_largest_value():
    assert measures.peak_velocity(0.01 * np.arange(50.0)) == pytest.approx(0.49)
    single = np.zeros(60)
    single[30:33] = [0.5, 1.0, 0.4]
    assert measures.peak_velocity(single) == 1.0


@pytest.fixture
def shapes(tmp_path):
    """Three shapes at peak velocity: one, the same a tenth longer and lower, and another of the first length."""
    x = 0.005 * np.arange(121)
    of = {
        "one": 140.0 * np.clip(1.0 - x / 0.4, 0.0, None),
        "longer": 140.0 / 1.1 * np.clip(1.0 - x / 0.44, 0.0, None),
        "other": 210.0 * np.clip(1.0 - x / 0.4, 0.0, None) ** 2,
    }
    lines = [
        table.curve_row(
            {"case": name, "refinement": 1.0, "cell_size_mm": 6.0},
            table.Curve("peak_thickness_mm", 0.3, math.nan, "x_m", 0.0, 0.005, values, 3),
        )
        for name, values in of.items()
    ]
    table.write_table(tmp_path / "group" / table.CURVES, lines)
    return table.Tables(tmp_path)


def test_the_distance_of_shapes_in_units_of_length_tells_what_is_no_stretch(shapes):
    def distance(case, least):
        return statement_terms.shape_distance(shapes, case, "one", 1.0, least)

    assert distance("longer", None) > 8.0
    assert distance("longer", 5.0) < 0.7  # fronts at 5 mm
    assert min(distance("other", least) for least in (5.0, None)) > 15.0


def test_solves_are_counted_on_each_grid_that_all_cases_were_run_on(tmp_path):
    """What round-off changes is uncertain; a grid that needs more makes no other one uncertain."""
    rows = [
        {"case": case, "refinement": r, "cell_size_mm": 6.0 / r, "complete": 1, "sweeps": count}
        for case, counts in {"muI": (300, 200, 520, 400), "eta": (200, 260, 500)}.items()
        for r, count in zip((1.0, 1.5, 2.0, 3.0), counts, strict=False)
    ]
    table.write_table(tmp_path / "group" / table.SCALARS, rows)
    found = list(statements_cost.ratios(table.Tables(tmp_path), ["muI"], ["eta"], "sweeps"))
    assert [size for size, _ in found] == [6.0, 4.0, 3.0]
    assert [ratio.value for _, ratio in found] == pytest.approx([1.5, 200 / 260, 1.04])
    verdicts = [Clause("", of, "within", (1.0, 2.0), of_paper=True).verdict for _, of in found]
    assert verdicts == [CONFIRMED, REFUTED, OPEN]
