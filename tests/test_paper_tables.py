"""What is read off the tables of the study of the paper, how uncertain it is, and verdicts under all readings of it."""

import math

import numpy as np
import pytest

from runs import table
from runs.measured import Measured, of_trend, uncertainty
from runs.paper import beds, curves, measures, settled
from runs.paper.finer import finer, shortage
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED, Claim, Clause


def run_row(case, refinement, value, complete=1):
    size = 6.0 / refinement
    row = {"case": case, "refinement": refinement, "cell_size_mm": size, "complete": complete}
    return row | {"value": value, "nothing": math.nan}


@pytest.fixture
def written(tmp_path):
    """Two cases on both grids, one on the coarse grid only, one that stopped."""
    rows = [
        run_row("muI_a22_w10", 1.0, 1.0),
        run_row("muI_a22_w10", 1.5, 1.1),
        run_row("eta1_a22_w10", 1.0, 0.8),
        run_row("eta1_a22_w10", 1.5, 0.92),
        run_row("back0.18_a22_w10", 1.0, 0.7),
        run_row("muI_a0_w10", 1.0, 0.5, complete=0),
    ]
    table.write_table(tmp_path / "group" / table.SCALARS, rows)
    run = {"case": "muI_a22_w10", "refinement": 1.0, "cell_size_mm": 6.0}
    values = np.array([0.2, 0.25, math.nan, -0.00001, 1.5])
    curve = curves.Curve("odd_m", math.nan, math.nan, "t_s", 0.0, 0.01, values, 4)
    values = np.minimum(0.2 + 0.01 * np.arange(20), 0.3)
    front = curves.Curve("front_m", math.nan, math.nan, "t_s", 0.0, 0.01, values, 4)
    dated = curves.Curve("thickness_mm", 1.76, math.nan, "x_m", 0.0, 0.006, 100 * values[:2], 1)
    lines = [table.curve_row(run, of) for of in (curve, front, dated)]
    table.write_table(tmp_path / "group" / table.CURVES, lines)
    return table.Tables(tmp_path)


def test_numbers_and_their_uncertainty(written):
    found = written.value("muI_a22_w10", "value")
    assert found[:2] == pytest.approx((1.1, 0.3))  # finer grid
    assert found.cases == {"muI_a22_w10"}
    assert written.value("back0.18_a22_w10", "value")[:2] == pytest.approx((0.7, 0.3))  # of muI
    assert math.isnan(written.value("muI_a22_w10", "nothing").value)
    assert written.cell_size("muI_a22_w10", 1.5) == 4.0


def test_what_two_runs_share_is_no_uncertainty_of_their_difference(written):
    found = written.difference("muI_a22_w10", "eta1_a22_w10", "value")
    assert found[:2] == pytest.approx((0.18, 0.06))
    assert found.cases == {"muI_a22_w10", "eta1_a22_w10"}
    found = written.difference("muI_a22_w10", "back0.18_a22_w10", "value")
    assert found[:2] == pytest.approx((0.3, math.hypot(0.3, 0.3)))


def test_the_front_is_read_at_a_thickness(written):
    assert (written.runout, written.front) == ("runout_5mm_m", "front_m")
    thin = written.read_at(1)
    assert (thin.runout, thin.front) == ("runout_1mm_m", "front_1mm_m")
    assert thin.scalars is written.scalars


@pytest.mark.parametrize(
    ("sizes", "values", "expected"),
    [
        ([6.0], [1.0], math.nan),
        ([6.0, 4.0], [1.0, 1.1], 0.3),
        ([6.0, 4.0, 3.0], [0.0, 0.0, 0.0], 0.0),
        ([6.0, 4.0, 3.0], [1.0, 1.04, 1.06], 1.25 * 0.06),  # first order: 1.12 is the limit
        ([6.0, 4.0, 3.0], [1.0, 1.04, 1.02], 3.0 * 0.04),  # oscillates
        ([6.0, 4.0, 3.0, 2.0], [1.0, 1.04, 1.06, 1.08], 1.25 * 0.04),
        ([6.0, 4.0, 3.0, 2.0], [-0.06, -0.02, 0.0, 0.02], 1.25 * 0.04),  # the same, elsewhere
        ([6.0, 4.0, 3.0, 2.0], [1.0, math.nan, 1.06, 1.08], math.nan),
    ],
)
def test_uncertainty_of_values_on_grids(sizes, values, expected):
    found = uncertainty(sizes, values)
    assert found == pytest.approx(expected, rel=1e-3, nan_ok=True)


def test_values_that_scatter_about_their_trend_are_as_uncertain_as_the_finest_three():
    sizes, values = [6.0, 4.0, 3.0, 2.0], [1.35, 1.27, 1.31, 1.27]
    assert of_trend(sizes, values) is None
    assert uncertainty(sizes, values) == uncertainty(sizes[1:], values[1:]) > 3.0 * 0.039


def test_curves_are_read_back(written):
    line = written.line("muI_a22_w10", "odd_m")
    np.testing.assert_allclose(line.at, 0.01 * np.arange(5))
    np.testing.assert_array_equal(line.values, [0.2, 0.25, math.nan, 0.0, 1.5])
    np.testing.assert_allclose(written.line("muI_a22_w10", "thickness_mm", 1.76).values, [20, 21])


def test_velocity_follows_from_the_front(written):
    line = written.line("muI_a22_w10", table.VELOCITY)
    assert np.isnan(line.values[: measures.EARLIEST]).all()
    assert line.values[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "ask",
    [
        lambda of: of.row("muI_a0_w10"),  # stopped before its end
        lambda of: of.row("muI_a22_w10", 2.0),
        lambda of: of.line("muI_a22_w10", "thickness_mm", 0.5),
        lambda of: of.columns("muI_a22_w10", "shear_per_s"),
    ],
)
def test_what_is_not_there_is_named(written, ask):
    with pytest.raises(table.MissingRun, match="muI_a"):
        ask(written)


def test_reference_has_the_same_slope_and_width():
    assert table.reference("mu38_bed38_a10_winf") == "muI_a10_winf"
    assert table.reference("rate_min5e-3_a22_winf") == "muI_a22_winf"


# -- readings ------------------------------------------------------------------------------------


def claim_of(value, needed=0.5, error=0.1, front=True, of_paper=True):
    """A claim that reads its value, by front and bed, off a dictionary instead of tables."""

    def measure(of):
        at = value[of.folder.name, of.front_mm] if isinstance(value, dict) else value
        measured = Measured(at, error, frozenset({"muI_a22_w10"}))
        return [Clause("", measured, "above", needed, of_paper=of_paper)]

    return Claim("3", "said", "criterion", measure, front)


@pytest.fixture
def two_beds(written, tmp_path):
    rough = table.Tables(tmp_path / "rough")
    rough.scalars = {("muI_a22_w10", r): {} for r in table.REFINEMENTS[:3]}
    return {beds.SLIDES: written, beds.ROUGH: rough}


def by_reading(folder, slides, rough):
    """Values at 5, 1, 10 mm on both beds."""
    return {
        (bed, mm): value
        for bed, values in ((folder, slides), ("rough", rough))
        for mm, value in zip(settled.FRONTS, values, strict=True)
    }


@pytest.mark.parametrize(
    ("slides", "rough", "verdict"),
    [
        ((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), CONFIRMED),
        ((0.0, 0.0, 0.0), (0.0, 0.55, 0.0), REFUTED),
        ((1.0, 0.55, 1.0), (0.45, 1.0, 1.0), CONFIRMED),
        ((1.0, 1.0, 1.0), (0.0, 1.0, 1.0), settled.ON_BED),
        ((1.0, 0.0, 1.0), (1.0, 0.0, 1.0), settled.ON_FRONT),
        ((0.55, 1.0, 1.0), (1.0, 1.0, 1.0), OPEN),
    ],
)
def test_verdict_under_all_readings(two_beds, tmp_path, slides, rough, verdict):
    claim = claim_of(by_reading(tmp_path.name, slides, rough))
    (found,) = settled.settle([claim], two_beds)
    assert len(found.readings) == 6
    assert found.verdict == verdict
    assert (found.contrary() is None) == (verdict not in (settled.ON_BED, settled.ON_FRONT))


@pytest.mark.parametrize(
    ("rough", "verdict"), [(0.45, OPEN), (0.7, CONFIRMED), (0.3, settled.ON_BED)]
)
def test_a_reading_that_contradicts_with_our_limit_alone_leaves_a_statement_open(
    two_beds, tmp_path, rough, verdict
):
    """The limit is 0.5, and 0.375 or 0.625 to another reader."""
    values = by_reading(tmp_path.name, (1.0, 1.0, 1.0), (rough, 1.0, 1.0))
    claim = claim_of(values, error=0.01, of_paper=False)
    (found,) = settled.settle([claim], two_beds)
    assert found.verdict == verdict


def test_a_claim_without_front_has_one_reading_a_bed(two_beds, tmp_path):
    claim = claim_of(by_reading(tmp_path.name, (1.0, 0, 0), (0.0, 0, 0)), front=False)
    (found,) = settled.settle([claim], two_beds)
    assert found.verdict == settled.ON_BED
    assert found.others() == "not confirmed: rough bed"


def test_finer_grids_are_asked_for_where_they_decide(two_beds):
    def asked(value, error, finest=3.0):
        (found,) = settled.settle([claim_of(value, error=error, front=False)], two_beds)
        return finer([found], two_beds, finest)

    # on two grids so far where the grains slide; the rough bed does not decide in the place of the paper's reading
    assert asked(0.55, 0.1) == [("", "muI_a22_w10", 2.0)]
    assert asked(0.55, 0.1, finest=2.0) == [("", "muI_a22_w10", 2.0)]
    assert asked(0.55, 0.01) == []  # decided
    assert asked(0.501, 0.1) == []  # on its limit
    assert asked(0.55, math.nan) == []
    clause = Clause("", Measured(0.55, 0.1), "above", 0.5, of_paper=True)
    assert shortage(clause) == pytest.approx(2.0)
    assert shortage(clause._replace(of_paper=False)) == math.inf  # no grid moves it off the limits
    far = clause._replace(measured=Measured(0.7, 0.1), of_paper=False)
    assert shortage(far) == pytest.approx(0.1 / 0.075)
