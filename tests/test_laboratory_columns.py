"""Columns of a laboratory with one friction of the grains for all: the cases, the fit, and the stored tables."""

import pytest

from plots import laboratory_columns as figure
from runs.laboratories import columns
from runs.table import RUNS, read_table, write_table

FOLDER = RUNS / "experiments" / columns.FOLDER
STORED = RUNS / "laboratories"
TRUTH = 0.7


def law(factor):
    """A run-out that grows as the friction falls, as a parabola of the factor."""
    return 0.5 - 0.3 * factor + 0.1 * factor**2


def rows(sigma=0.01):
    """Nine columns that all have the friction `TRUTH`."""
    return [
        {
            "column": f"a{number}",
            "aspect": float(number),
            "quantity": quantity,
            "walls": walls,
            "measured": number * law(TRUTH),
            "sigma": sigma,
            **{f"computed_{f:g}": number * law(f) for f in columns.FACTORS},
        }
        for number in range(1, 10)
        for quantity in columns.QUANTITIES
        for walls in columns.WALLS
    ]


def test_the_fit_finds_the_one_friction_and_closes_the_gap_of_the_columns_held_out():
    found = columns.fit(rows(), "measured")
    assert found["columns"] == 9
    assert found["factor"] == pytest.approx(TRUTH, abs=2e-3)
    assert found["rms_held_out"] > 5.0
    assert found["rms_held_out_after"] < 0.2
    assert found["closed_held_out"] > 0.95
    assert found["runout_mean_percent"] == pytest.approx(100 * (law(1.0) / law(TRUTH) - 1), abs=0.1)
    stated = columns.fit(rows(), "absent")  # no other friction was run without walls
    assert stated["factor"] == 1.0
    assert stated["closed_fitted"] == 0.0


def test_every_third_column_is_held_out_and_does_not_fit():
    wrong = [
        row | {"measured": 2.0 * row["measured"]} if row["column"] in ("a2", "a5", "a8") else row
        for row in rows()
    ]
    assert columns.fit(wrong, "measured")["factor"] == pytest.approx(TRUTH, abs=2e-3)


def test_the_cases_state_what_was_measured():
    found = columns.read_columns(FOLDER)
    assert len(found) == 28
    assert [one.aspect for one in found] == sorted(one.aspect for one in found)
    cases = columns.cases_of(found[:1], None)
    assert len(cases) == 1 + len(columns.FACTORS)
    name, material = found[0].name, found[0].experiment.settings.material
    stated, lower = cases[name, "absent", 1.0], cases[name, "measured", 0.5]
    assert stated.rheology.mu_1 == pytest.approx(material.mu_1)
    assert stated.effects.lateral_friction is None
    assert lower.effects.lateral_friction.mu_wall == pytest.approx(material.mu_wall)
    assert lower.rheology.mu_1 == pytest.approx(0.5 * material.mu_1)
    step = lower.rheology.mu_2 - lower.rheology.mu_1
    assert step == pytest.approx(stated.rheology.mu_2 - stated.rheology.mu_1)


def test_the_stored_fit_follows_from_the_stored_columns(tmp_path):
    stored = read_table(STORED / "columns.csv")
    assert len({row["column"] for row in stored}) == 28
    for row in stored:
        row["aspect"] = float(row["aspect"])
    write_table(tmp_path / "fit.csv", [columns.fit(stored, walls) for walls in columns.WALLS])
    assert read_table(STORED / "columns_fit.csv") == read_table(tmp_path / "fit.csv")


def test_the_figure_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr(figure, "SOURCE", tmp_path)
    monkeypatch.setattr(figure, "HERE", tmp_path)
    (tmp_path / "figures").mkdir()
    fitted = [row | {"computed_fitted": row["measured"]} for row in rows()]
    write_table(tmp_path / "columns.csv", fitted)
    write_table(tmp_path / "columns_fit.csv", [columns.fit(rows(), w) for w in columns.WALLS])
    figure.main()
    assert (tmp_path / "figures" / "laboratory_columns.png").stat().st_size > 10_000
    caption = (tmp_path / "figures" / "laboratory_columns.txt").read_text(encoding="utf-8")
    assert "0.70 of the stated friction" in caption


def test_a_row_has_the_numbers_that_were_run(monkeypatch):
    class Seen:
        def __init__(self, scalars):
            self.scalars = scalars

    column = columns.read_columns(FOLDER)[0]
    results = {
        (column.name, walls, factor): factor
        for walls, factors in columns.WALLS.items()
        for factor in factors
    }
    seen = {name: 0.1 for name in columns.QUANTITIES}
    monkeypatch.setattr(
        columns,
        "observe",
        lambda factor, _: Seen({name: factor * value for name, value in seen.items()}),
    )
    rows = list(columns.rows_of(column, results))
    assert len(rows) == len(column.experiment.scalars) * len(columns.WALLS)
    for row in rows:
        for factor in columns.FACTORS:
            was_run = factor in columns.WALLS[row["walls"]]
            assert row[f"computed_{factor:g}"] == (pytest.approx(0.1 * factor) if was_run else "")
