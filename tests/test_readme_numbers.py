"""Numbers of the generated parts of the README files: how they are told, and what is read off the tables."""

import pytest

from fvcollapse.errors import FvcollapseError
from runs import (
    readme_acceptance,
    readme_comparison,
    readme_convergence,
    readme_facts,
    readme_particles,
    readme_stamps,
    readme_thin_layers,
    readme_walls,
)
from runs.readme_tables import change, require, rounded, signed, span
from runs.table import write_table

# -- how a number is told ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "digits", "scale", "told"),
    [
        ("74.5", 0, 1, "75"),  # Python rounds this half to even
        ("-14.5", 0, 1, "−15"),
        ("0.0208", 1, 1000, "20.8"),
        ("-0.04", 1, 1, "0.0"),
        ("0.00285", 2, 1000, "2.85"),
        (1e-5, 1, 1, "0.0"),
    ],
)
def test_halves_are_rounded_away_from_zero(value, digits, scale, told):
    assert rounded(value, digits, scale) == told


@pytest.mark.parametrize(
    ("value", "told"), [("20.8", "+21"), ("-0.4", "0"), ("-1.6", "−2"), ("-0", "0")]
)
def test_a_sign_stands_before_all_but_zero(value, told):
    assert signed(value) == told


def test_a_span_of_one_number_is_that_number():
    assert span([0.1, 0.1], str) == "0.1"
    assert span([2.0, -1.0, 0.5], signed) == "−1 to +2"


def test_a_change_is_of_the_first_number():
    assert change("2.0", "2.1") == pytest.approx(5.0)


# -- the solver of a table -----------------------------------------------------------------------


def test_a_table_without_a_valid_stamp_is_of_an_earlier_solver(tmp_path, monkeypatch):
    monkeypatch.setattr(readme_stamps, "ROOT", tmp_path)
    for name in ("a", "b"):
        write_table(tmp_path / "runs" / f"{name}.csv", [{"value": name}])
    stamp = {"code": "1+x", "content": readme_stamps.digest(tmp_path / "runs" / "a.csv")}
    monkeypatch.setattr(readme_stamps, "read_stamps", lambda: {"runs/a.csv": stamp})
    assert readme_stamps.solver_line("a.csv") == "\nMade by solver `1+x`: `a.csv`.\n"
    assert "an earlier solver: `a.csv`, `b.csv`" in readme_stamps.solver_line("a.csv", "b.csv")
    write_table(tmp_path / "runs" / "a.csv", [{"value": "changed"}])
    assert "an earlier solver" in readme_stamps.solver_line("a.csv")


# -- particles -----------------------------------------------------------------------------------


def layers(front, thickness, variant, experiment=readme_thin_layers.TEACHER):
    """A row of thin_layers.csv, m."""
    return {
        "experiment": experiment,
        "variant": variant,
        "front_difference": f"{front}",
        "final_thickness_rms": f"{thickness}",
    }


def references(*fronts_and_thicknesses):
    """Rows of the lengths in their order."""
    return [
        layers(*both, f"thickness, L = {length:g} d")
        for length, both in zip(readme_thin_layers.LENGTHS, fronts_and_thicknesses, strict=True)
    ]


def test_the_rule_takes_the_least_length_within_both_limits():
    too_far, too_thick = (0.008, 0.004), (0.002, 0.005)
    good = (-0.006, 0.0045)
    assert readme_thin_layers.chosen(references(too_far, too_thick, good, good, good)) == (
        f"thickness, L = {readme_thin_layers.LENGTHS[2]:g} d"
    )
    assert readme_thin_layers.chosen(references(*[too_far] * 5)) is None


def test_references_within_both_limits_are_counted():
    rows = [layers(*both, "without") for both in ((0.015, 0.0045), (-0.02, 0.004), (0.0, 0.005))]
    assert readme_thin_layers.reach(rows) == ("−20.0 to +15.0 mm", "4.0 to 5.0 mm", "1 of 3")


def test_what_a_variant_closes_of_a_gap():
    rows = {}
    for name in readme_particles.SHAPED:
        rows[name, "without"] = {"at_back_wall": "-10"}
        rows[name, "more"] = {"at_back_wall": "-7.5"}
    assert readme_particles.closed(rows, "more", "at_back_wall") == "25 %"


# -- walls ---------------------------------------------------------------------------------------


def test_the_friction_that_another_change_needs_is_interpolated():
    first = {"pair": "22°", "mobilised": "0.1", "added": ""}
    rows = [
        first | {"of": "grains", "front": "-90"},
        first | {"of": "model", "mu_w_K_w": "0.1", "front": "-40"},
        first | {"of": "model", "mu_w_K_w": "0.3", "front": "-100"},
        first | {"of": "model, needed", "mu_w_K_w": "0.2667", "front": "-90"},
    ]
    pair = readme_walls.Pair("22°", rows)
    assert pair.run(1.0)["front"] == "-40"
    assert pair.needed() == pytest.approx(0.2667)
    assert pair.needed_for(-70.0) == pytest.approx(0.2)
    assert pair.needed_for(-20.0) == pytest.approx(0.05)


def test_the_front_with_the_mean_friction_of_the_grains_is_interpolated(tmp_path, monkeypatch):
    """Means 0.05 and 0.15 at mu_w = 0.1 and 0.3: that of the grains, 0.1, takes 0.2, half way between the fronts."""
    walls = [
        {"pair": name, "of": "grains", "mobilised": "0.1", "front": f"{front}", "added": ""}
        for name, front in ((readme_walls.STEEP, -90), (readme_walls.FLAT, -10))
    ]
    walls += [
        {"pair": readme_walls.STEEP, "of": "model", "added": "", "mu_w_K_w": of, "front": front}
        for of, front in (("0.1", "-40"), ("0.3", "-100"))
    ]
    means = [
        {"pair": readme_walls.STEEP, "grains": "0.1", "mu_wall": of, "whole_run": mean}
        for of, mean in (("0.1", "0.05"), ("0.3", "0.15"))
    ]
    write_table(tmp_path / readme_walls.TABLE, walls)
    write_table(tmp_path / readme_walls.MOBILISED, means)
    monkeypatch.setattr(readme_walls, "RUNS", tmp_path)
    monkeypatch.setattr(
        readme_walls, "PAIRS", dict.fromkeys((readme_walls.STEEP, readme_walls.FLAT))
    )
    row = readme_walls.alike()[readme_walls.STEEP]
    assert row["alike"] == pytest.approx(0.2)
    assert row["front"] == pytest.approx(-70.0)
    assert row["front_grains"] == -90.0


# -- grids ---------------------------------------------------------------------------------------


def test_changes_between_grids_are_held_against_what_was_asked(tmp_path, monkeypatch):
    values = {10: 1.0, 8: 1.0, 6: 1.0, 4: 1.01, 3: 1.03, 2: 1.035}
    rows = [
        {"name": f"{words}; {size} mm"} | dict.fromkeys(readme_facts.READ, value)
        for size, value in values.items()
        for words in (readme_facts.ROUGH, "no slip")
    ]
    rows.append(
        {"name": f"{readme_facts.ROUGH}; 6 mm; 1.2 ms"} | dict.fromkeys(readme_facts.READ, 1.001)
    )
    write_table(tmp_path / "paper_facts" / "grid.csv", rows)
    finer = {"dx6mm": 1.0, "dx3mm": 1.1}
    write_table(
        tmp_path / "acceptance" / "grid.csv",
        [{"name": name} | dict.fromkeys(readme_acceptance.READ, of) for name, of in finer.items()],
    )
    monkeypatch.setattr(readme_facts, "RUNS", tmp_path)
    coarse, fine, steps, _, tongue = readme_facts.grid_says().splitlines()
    assert "10 mm +3.00 %" in coarse
    assert coarse.endswith("not met at 10 mm, 5 mm, 1 mm, x₉₉.")
    assert fine.endswith("met by all four.")
    assert "by more than 0.10 %" in steps
    assert "10 mm +10.00 %" in tongue


# -- sentences that the tables must bear out -----------------------------------------------------


def test_a_sentence_that_is_no_longer_true_is_refused():
    require(True, "the front moves")
    with pytest.raises(FvcollapseError, match="no longer say: the front moves"):
        require(False, "the front moves")


def test_the_slope_of_the_least_and_the_largest_gap():
    size = dict(zip(readme_particles.SHAPED, (3, 1, 4, 5, 2, 9, 6), strict=True))
    assert readme_particles.slopes(min, lambda name, _: size[name]) == "10°"
    assert readme_particles.slopes(max, lambda name, _: size[name]) == "22°"

    def other(name, column):
        return size[name] if column == "at_back_wall" else -size[name]

    assert readme_particles.slopes(max, other) == (
        "22° (at the back wall) and 10° (in front of the middle)"
    )


def test_an_order_is_that_of_monotone_differences_on_the_finest_grids():
    coarse = {"behaviour": "monotone", "order": 1.0}
    found = {
        name: {"runout": {"triplets": [coarse, {"behaviour": behaviour, "order": 1.5}]}}
        for name, behaviour in (("a", "monotone"), ("b", "oscillatory"))
    }
    assert readme_convergence.orders(found, "runout") == [1.5, None]


def test_outside_of_the_measured_fronts_is_above_or_below():
    beads = [{"h_at_2": "0.2"}, {"h_at_2": "0.3"}, {"h_at_2": ""}]
    rows = [{"h_at_2": "0.1"}, {"h_at_2": "0.35"}]
    above, below = (readme_comparison.outside(rows, beads, ("h_at_2",), of) for of in (True, False))
    assert above == pytest.approx([0.0, 0.05])
    assert below == pytest.approx([0.1, 0.0])
    assert readme_comparison.worst(rows, beads, ("h_at_2",)) == pytest.approx(0.1)
