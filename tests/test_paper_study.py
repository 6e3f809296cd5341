"""The study of the paper: what is read off curves and fields, verdicts, tables, the committed files."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fvcollapse.case.case import GRAVITY, Case
from plots import paper, paper_front_slow_phase
from runs import table
from runs.paper import cases, curves, measures, members, pressure, readings, statements, study
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED, Clause, Statement, claims, combined
from runs.study import main as call

PAPER = table.RUNS / "paper"
TIME = measures.STEP * np.arange(201)


# -- fronts --------------------------------------------------------------------------------------


def rising_to(peak, after):
    """A velocity that rises to its peak at 0.3 s and then follows `after(time since)`."""
    return np.where(TIME < 0.3, peak * TIME / 0.3, np.maximum(after(TIME - 0.3), 0.0))


def two_slopes(since):
    """1.2 m/s, falls to 0.4 in 0.2 s, stays within 0.05 for 0.8 s, then stops in 0.1 s."""
    return np.interp(since, [0.0, 0.2, 1.0, 1.1], [1.2, 0.4, 0.35, 0.0])


def test_velocity_of_a_parabolic_front_is_exact():
    front = 0.2 + 0.5 * TIME + 0.3 * TIME**2
    np.testing.assert_allclose(measures.front_velocity(front), 0.5 + 0.6 * TIME, atol=1e-9)


def test_plateau_is_found_where_it_is():
    found = measures.plateau(rising_to(1.2, two_slopes))
    # the slope is a fit over 140 ms, so that each end is blurred by about half of that
    assert found.start == pytest.approx(0.5, abs=0.07)
    assert found.duration == pytest.approx(0.8, abs=0.12)
    assert found.velocity == pytest.approx(0.375, abs=0.02)


@pytest.mark.parametrize(
    "after",
    [
        lambda since: 1.2 - since,  # constant deceleration
        lambda since: 1.2 * np.exp(-since / 0.3),
        lambda since: 1.2 * (1.0 - (since / 1.2) ** 2),  # slow first, then fast
        lambda since: np.where(since < 0.5, 1.2, 0.0),  # fast all the time: not slow
    ],
)
def test_no_plateau(after):
    assert measures.plateau(rising_to(1.2, after)).duration < measures.PLATEAU_LEAST


def test_noise_of_a_few_per_cent_hides_no_plateau_and_makes_none():
    noise = 0.02 * np.sin(2.0 * np.pi * TIME / 0.05)
    assert measures.plateau(rising_to(1.2, two_slopes) + noise).duration > 0.6
    straight = rising_to(1.2, lambda since: 1.2 - since)
    assert measures.plateau(straight + noise * (straight > 0.1)).duration < measures.PLATEAU_LEAST


def test_a_front_that_does_not_move_has_no_plateau():
    assert measures.plateau(np.zeros(100)) == measures.Plateau()


def test_tail_ratio():
    straight = rising_to(1.2, lambda since: 1.2 - since)
    assert measures.tail_ratio(straight) == pytest.approx(1.0, abs=0.05)
    assert measures.tail_ratio(rising_to(1.2, two_slopes)) > 4.0
    assert math.isnan(measures.tail_ratio(rising_to(1.2, lambda since: 1.2 - 0.1 * since)))


def test_early_acceleration_is_the_slope_between_two_levels():
    velocity = np.minimum(4.0 * TIME, 1.0)
    assert measures.early_acceleration(TIME, velocity, 0.4, 0.8) == pytest.approx(4.0)
    assert math.isnan(measures.early_acceleration(TIME, velocity, 2.0, 3.0))


# -- profiles ------------------------------------------------------------------------------------

X = np.linspace(0.0, 1.2, 241)


def test_roughness_of_a_smooth_surface_is_nothing_and_of_a_wave_its_rms():
    cubic = 0.05 - 0.03 * X + 0.01 * X**2 - 0.004 * X**3
    assert measures.roughness(X, cubic, 0.1, 1.1) < 1e-9
    wave = 2e-3 * np.sin(2.0 * np.pi * X / 0.06)
    rms = 2e-3 / math.sqrt(2.0)
    # a wave of 6 cm is not quite removed by a smoothing over 15 cm
    assert measures.roughness(X, cubic + wave, 0.1, 1.1) == pytest.approx(rms, rel=0.25)
    assert math.isnan(measures.roughness(X, cubic, 0.1, 0.2))


def test_interface_of_a_parabola():
    static = np.maximum(0.06 - 0.1 * X - 0.15 * X**2, 0.0)
    found = measures.interface(X, static, static + 0.01)
    assert found.curvature == pytest.approx(0.3, rel=1e-6)
    end = X[static > 0.006][-1]  # 10 % of the top
    start = X[static <= 0.048][0]
    chord = (np.interp(start, X, static) - np.interp(end, X, static)) / (end - start)
    assert found.angle == pytest.approx(math.degrees(math.atan(chord)), rel=0.02)


def test_no_interface_where_all_or_nothing_moves():
    h = np.maximum(0.06 - 0.05 * X, 0.0)
    assert math.isnan(measures.interface(X, np.zeros_like(X), h).angle)
    assert math.isnan(measures.interface(X, h, h).angle)


def test_surface_slope_of_a_wedge():
    wedge = np.maximum(0.1 - 0.2 * X, 0.0)
    angle = math.degrees(math.atan(0.2))
    assert measures.surface_slope(X, wedge, 0.01) == pytest.approx(angle)


# -- columns -------------------------------------------------------------------------------------


def test_bands_are_counted_per_column():
    z = np.linspace(0.0, 1.0, 40)
    single = np.exp(-(((z - 0.5) / 0.2) ** 2))
    double = np.exp(-(((z - 0.25) / 0.08) ** 2)) + np.exp(-(((z - 0.75) / 0.08) ** 2))
    flowing = np.ones((2, 40), bool)
    assert measures.bands(np.array([single, single]), flowing) == 1.0
    assert measures.bands(np.array([single, double]), flowing) == 1.5
    ripple = single * (1.0 + 0.05 * np.sin(40.0 * z))
    assert measures.bands(np.array([ripple, ripple]), flowing) == 1.0
    flowing[:, 3:] = False
    assert math.isnan(measures.bands(np.array([single, double]), flowing))


def test_unevenness_sees_bands_thinner_than_its_length():
    z = 1e-3 * (np.arange(60) + 0.5)
    smooth, flowing = np.full((3, 60), 20.0), np.ones((3, 60), bool)
    assert measures.unevenness(smooth, flowing, 1e-3, 0.012) < 1e-9
    banded = smooth * (1.0 + np.sin(2.0 * np.pi * z / 0.006))
    assert measures.unevenness(banded, flowing, 1e-3, 0.012) > 0.5


def test_weighted_quantiles():
    values, weights = np.array([3.0, 1.0, 2.0]), np.array([1.0, 8.0, 1.0])
    found = measures.weighted_quantiles(values, weights, (0.5, 0.9, 1.0))
    np.testing.assert_allclose(found, [1.0, 2.0, 3.0])


# -- the pressure --------------------------------------------------------------------------------


def flow_field(case, slope=-0.1, stretch=0.5, shear=10.0, dx=0.005):
    """A sheared and stretched layer whose pressure is that of equation 22, cell means included."""
    nx, nz = 60, 24
    x_node, z_node = dx * np.arange(nx + 1), dx * np.arange(nz + 1)
    h_node = 0.060 + slope * (x_node - 0.15)
    level_set = z_node[None, :] - h_node[:, None]
    z = dx * (np.arange(nz) + 0.5)
    u = shear * z[None, :] + stretch * x_node[:, None]
    h = 0.5 * (h_node[:-1] + h_node[1:])[:, None]
    low = z[None, :] - 0.5 * dx
    depth = h - 0.5 * (low + np.minimum(low + dx, h))
    alpha = math.radians(case.geometry.slope_angle_deg)
    factor = math.cos(alpha) - math.sin(alpha) * (slope + 2.0 * stretch / shear)
    p = case.rheology.density_bulk * GRAVITY * factor * np.maximum(depth, 0.0)
    fields = {"level_set": level_set, "u": u, "w": np.zeros((nx, nz + 1)), "pressure": p}
    return fields | {"dx": dx, "dz": dx, "time": 0.0, "shear_rate": np.full((nx, nz), shear)}


def test_equation_22_is_recognised_and_differs_from_hydrostatic():
    case = Case()
    found = pressure.columns(flow_field(case), case)
    assert pressure.flowing_share_valid(found) > 0.9
    assert pressure.misfit(found, "equation_22") < 1e-6
    alpha = math.radians(22.0)
    expected = 1.0 - math.cos(alpha) / (math.cos(alpha) - math.sin(alpha) * (-0.1 + 0.1))
    assert pressure.misfit(found, "hydrostatic") == pytest.approx(abs(expected), abs=1e-6)
    steeper = pressure.columns(flow_field(case, slope=-0.3), case)
    factor = math.cos(alpha) - math.sin(alpha) * (-0.3 + 0.1)
    gap = 1.0 - math.cos(alpha) / factor
    assert pressure.misfit(steeper, "hydrostatic") == pytest.approx(gap, rel=1e-3)


def test_where_nothing_shears_equation_22_is_not_compared():
    case = Case()
    found = pressure.columns(flow_field(case, shear=1e-3, stretch=1.0), case)
    assert pressure.flowing_share_valid(found) == 0.0
    assert math.isnan(pressure.misfit(found, "equation_22"))


def test_viscosity_of_equation_6():
    """By hand: 0.25 * 1000 / (10 + 0.279/0.035 sqrt(1000))."""
    field = {"pressure": np.array([1000.0]), "shear_rate": np.array([10.0])}
    expected = 0.25 * 1000.0 / (10.0 + 0.279 / 0.035 * math.sqrt(1000.0))
    assert readings.eta_I(field, Case()) == pytest.approx(expected)


# -- verdicts ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "error", "sense", "limit", "verdict"),
    [
        (1.0, 0.1, "above", 0.5, CONFIRMED),
        (0.3, 0.1, "above", 0.5, REFUTED),
        (0.55, 0.1, "above", 0.5, OPEN),
        (0.45, 0.1, "above", 0.5, OPEN),
        (0.0, 0.0, "above", 0.0, REFUTED),
        (0.3, 0.1, "below", 0.5, CONFIRMED),
        (1.0, 0.1, "below", 0.5, REFUTED),
        (0.45, 0.1, "below", 0.5, OPEN),
        (1.6, 0.05, "within", (1.5, 1.7), CONFIRMED),
        (1.6, 0.2, "within", (1.5, 1.7), OPEN),
        (1.9, 0.1, "within", (1.5, 1.7), REFUTED),
        (math.nan, 0.1, "above", 0.5, OPEN),
        (1.0, math.nan, "above", 0.5, OPEN),
    ],
)
def test_verdict_on_a_clause(value, error, sense, limit, verdict):
    assert Clause("", value, error, sense, limit).verdict == verdict


def test_verdict_on_a_statement():
    assert combined([CONFIRMED, CONFIRMED]) == CONFIRMED
    assert combined([CONFIRMED, OPEN]) == OPEN
    assert combined([CONFIRMED, OPEN, REFUTED]) == REFUTED
    assert combined([]) == OPEN
    clauses = [
        Clause("10°", 0.123456, 0.00071, "above", 0.02, "m"),
        Clause("0°", 0.01, math.nan, "above", 0.02, "m"),
    ]
    statement = Statement("3", "claim", "criterion", clauses, "more")
    assert statement.measured() == "10° 0.123 ± 0.0007; 0° 0.0100 ± ? m (1 of 2 confirmed). more"
    many = Statement("3", "claim", "criterion", clauses * 4)
    assert many.measured().startswith("8 values, 0.0100 to 0.123 m; of these 0° 0.0100 ± ?; 0°")
    assert many.measured().endswith("m (4 of 8 confirmed)")


def test_a_missing_run_leaves_a_claim_open():
    listed, claim = claims()

    @claim("3", "said", "criterion")
    def measure(of):
        return [Clause("", of.row("muI_a0_w10")["end_s"], 0.0, "above", 0.0)]

    statement = listed[0].statement(table.Tables("no such folder"))
    assert statement.verdict == OPEN
    assert "not run: muI_a0_w10" in statement.measured()


# -- tables --------------------------------------------------------------------------------------


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
    assert written.value("muI_a22_w10", "value") == pytest.approx((1.1, 0.3))  # finer grid
    assert written.value("back0.18_a22_w10", "value") == pytest.approx((0.7, 0.3))  # of muI
    assert math.isnan(written.value("muI_a22_w10", "nothing").value)
    assert written.cell_size("muI_a22_w10", 1.5) == 4.0


def test_where_there_is_a_convergence_study_its_index_is_the_uncertainty(written):
    assert written.index("muI_a22_w10", "runout_5mm_m") > 0.0
    assert written.index("eta1_a22_winf", "runout_5mm_m") > 0.0
    assert written.index("muI_a22_w10", "value") == 0.0
    assert written.index("muI_a10_w10", "runout_5mm_m") == 0.0


def test_what_two_runs_share_is_no_uncertainty_of_their_difference(written):
    found = written.difference("muI_a22_w10", "eta1_a22_w10", "value")
    assert found == pytest.approx((0.18, 0.06))
    found = written.difference("muI_a22_w10", "back0.18_a22_w10", "value")
    assert found == pytest.approx((0.3, math.hypot(0.3, 0.3)))


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


# -- cases ---------------------------------------------------------------------------------------


def test_every_case_is_listed_once_and_is_a_case():
    found = cases.runs(cases.GROUPS, 0.006)  # raises if a case is refused or listed twice
    physics = {}
    for run, (_, name, refinement, case) in found.items():
        same = case.replace(**{"time.end": 1.0, "time.output_times": ()}).to_toml()
        assert same not in physics, f"{run} is {physics[same]} again"
        physics[same] = run
        assert refinement == 1.0 or case.grid.cell_size < 0.006, name
    for group in cases.GROUPS.values():
        for member in group.values():
            assert set(member.keep) <= set(curves.KEPT)
            assert set(member.profiles) <= set(cases.TIMES)


# -- the command ---------------------------------------------------------------------------------


@pytest.fixture
def short(monkeypatch):
    """One short case on two coarse grids instead of all."""
    settings = cases.collapse(22, "w10", end=0.12)
    keep = tuple(curves.KEPT)
    listed = {"muI_a22_w10": cases.Member(settings, (1.0, 1.5), (0.1,), keep)}
    for module in (cases, study, members):
        monkeypatch.setattr(module, "GROUPS", {"lateral_friction": listed})
    shorter = replace(study.STUDY, parts={"lateral_friction": listed})
    monkeypatch.setattr(study, "main", partial(call, shorter))
    return listed


def study_in(folder, *arguments):
    options = ["--out", str(folder / "runs"), "--tables", str(folder)]
    return study.main([*options, "--workers", "1", "--cell-size", "0.035", *arguments])


def test_study_writes_tables_and_runs_nothing_twice(short, tmp_path, monkeypatch):
    assert study_in(tmp_path) == 0
    found = table.Tables(tmp_path)
    assert found.row("muI_a22_w10", 1.5)["cell_size_mm"] == pytest.approx(35.0 / 1.5, rel=1e-5)
    assert found.row("muI_a22_w10")["cpu_s"] > 0.0
    assert found.line("muI_a22_w10", "front_m").values[0] == pytest.approx(0.2, abs=0.002)
    assert found.line("muI_a22_w10", "thickness_mm", 0.1).values.max() > 100.0
    first = (tmp_path / "lateral_friction" / table.CURVES).read_bytes()
    monkeypatch.setattr("fvcollapse.output.run.Simulation", None)  # a second run would need it
    assert study_in(tmp_path) == 0
    assert (tmp_path / "lateral_friction" / table.CURVES).read_bytes() == first


def test_a_run_that_stopped_is_left_out_and_named(short, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(study, "run_in_folders", lambda *_: None)
    assert study_in(tmp_path) == 1
    assert "muI_a22_w10_35mm" in capsys.readouterr().err
    assert not (tmp_path / "lateral_friction").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["figure_3"], "PART: found figure_3; allowed: lateral_friction"),
        (["--workers", "0"], "--workers: found 0"),
        (["--cell-size", "0.2"], "--cell-size 0.2: grid.cell_size"),
    ],
)
def test_bad_arguments_are_one_line(tmp_path, capsys, arguments, words):
    assert study_in(tmp_path, *arguments) == 2
    captured = capsys.readouterr().err
    assert words in captured
    assert captured.count("\n") == 1


# -- the committed tables ------------------------------------------------------------------------


def test_committed_tables_are_readable_and_small():
    found = table.Tables(PAPER)
    assert found.scalars
    for row in found.scalars.values():
        assert row["complete"] == 1.0
    for lines in found.curves.values():
        for line in lines:
            assert np.isfinite(table.as_line(line).values).any()
    size = sum(path.stat().st_size for path in PAPER.glob("**/*.csv"))
    assert size < 650_000


def test_committed_statements_follow_from_the_committed_tables(tmp_path):
    found = statements.all_statements(table.Tables(PAPER))
    text = (PAPER / "statements.md").read_text(encoding="utf-8")
    for number, statement in enumerate(found, start=1):
        assert f"| {number} | {statement.place} | {statement.claim} | " in text
        assert statement.measured().replace("|", "/") in text
    rows = table.read_table(PAPER / "statements.csv")
    assert [row["verdict"] for row in rows] == [
        row["verdict"] for row in statements.clause_rows(found)
    ]


def test_figures_and_statements_share_what_a_slow_phase_is():
    assert paper_front_slow_phase.PLATEAU_LEAST == measures.PLATEAU_LEAST


def test_the_labels_of_the_sensitivities_are_those_of_the_cases(tmp_path):
    study.write_labels(tmp_path / table.LABELS)
    stored = PAPER / "sensitivity" / table.LABELS
    assert (tmp_path / table.LABELS).read_bytes() == stored.read_bytes()


@pytest.mark.slow
def test_everything_is_remade(tmp_path, monkeypatch):
    """All cases on the coarsest grids that are allowed, the statements and the figures."""
    monkeypatch.setattr("plots.paper_style.FIGURES", tmp_path / "figures")
    options = ["--out", str(tmp_path / "runs"), "--tables", str(tmp_path), "--cell-size", "0.035"]
    assert study.main(options) in (0, 1)  # on such grids a run may fail; it is named and left out
    paper.main(tmp_path)
    of = table.Tables(tmp_path)
    assert len(of.scalars) > 150
    assert (tmp_path / "statements.md").exists()
    assert len(list((tmp_path / "figures").glob("*.png"))) > 10
