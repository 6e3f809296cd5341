"""Verdicts do not hang on a choice: other limits and other windows must give the same."""

import math

import pytest

from runs import table
from runs.measured import Measured
from runs.paper import statement_terms, statements
from runs.paper.verdicts import CONFIRMED, OPEN, OURS, REFUTED, Clause

PAPER = table.RUNS / "paper"


@pytest.mark.parametrize(
    ("value", "error", "sense", "limit", "verdict"),
    [
        (1.30, 0.04, "above", 1.0, CONFIRMED),
        (1.26, 0.04, "above", 1.0, OPEN),  # not with a limit of 1.25
        (0.70, 0.04, "above", 1.0, REFUTED),
        (0.90, 0.04, "above", 1.0, OPEN),  # confirmed with a limit of 0.75
        (0.70, 0.04, "below", 1.0, CONFIRMED),
        (0.80, 0.04, "below", 1.0, OPEN),
        (-0.1, 0.04, "below", 0.0, CONFIRMED),  # a sign is no choice
        (0.4, 0.01, "within", (0.1, 1.0), CONFIRMED),
        (0.8, 0.01, "within", (0.1, 1.0), OPEN),  # 0.133 to 0.75 is the narrower range
        (1.2, 0.01, "within", (0.1, 1.0), OPEN),  # 0.075 to 1.33 is the wider one
        (1.5, 0.01, "within", (0.1, 1.0), REFUTED),
        (0.005, 0.001, "below", (0.01, 0.1), CONFIRMED),
        (0.054, 0.027, "below", (0.01, 0.1), OPEN),  # small with one limit, not with another
        (0.2, 0.05, "below", (0.01, 0.1), REFUTED),
    ],
)
def test_a_limit_of_ours_must_not_decide(value, error, sense, limit, verdict):
    assert OURS == 0.25
    clause = Clause("", Measured(value, error), sense, limit)
    assert clause.verdict == verdict


def test_the_limit_of_the_paper_is_taken_as_it_is():
    clause = Clause("", Measured(1.26, 0.04), "above", 1.0, of_paper=True)
    assert clause.verdict == clause.as_read == CONFIRMED
    assert clause._replace(of_paper=False).as_read == CONFIRMED


@pytest.mark.parametrize(
    ("other", "verdict"),
    [((0.2, 0.1), CONFIRMED), ((0.2, 0.3), OPEN), ((-0.2, 0.1), OPEN), ((0.2, math.nan), OPEN)],
)
def test_all_windows_must_give_the_same(other, verdict):
    windows = (("narrow", Measured(0.3, 0.1)), ("wide", Measured(*other)))
    clause = Clause("10°", Measured(0.3, 0.1), "above", 0.0, "m/s", windows=windows)
    assert clause.verdict == verdict
    assert clause.as_read == CONFIRMED
    assert ("wide" in clause.text()) == (verdict == OPEN)
    assert "narrow" not in clause.text()


def test_windows_that_refute_refute():
    windows = (("wide", Measured(-0.2, 0.1)),)
    assert Clause("", Measured(-0.3, 0.1), "above", 0.0, windows=windows).verdict == REFUTED


def test_a_number_is_read_in_each_window_on_each_grid():
    class Grids:
        def measure(self, function):
            return Measured(function(2.0), abs(function(2.0) - function(1.0)))

    found = statement_terms.clause_in(
        Grids(), {"first": 1.0, "second": 10.0}, lambda r, window: r * window, "22°", "above", 0.0
    )
    assert found.measured == (2.0, 1.0, frozenset())
    assert found.windows == (("second", Measured(20.0, 10.0)),)


def test_every_window_has_its_row_in_the_committed_table():
    rows = table.read_table(PAPER / "statements.csv")
    peaks = [row for row in rows if row["claim"].startswith("velocities are slightly higher")]
    (number,) = {row["statement"] for row in peaks}
    of = [row for row in rows if row["statement"] == number and row["label"] == "10°"]
    windows = ["", *list(statement_terms.PEAKS)[1:]]
    assert [row["window"] for row in of[: len(windows)]] == windows


def test_what_the_beds_stand_for_is_said_with_the_numbers_of_the_tables(tmp_path):
    of = {"": table.Tables(PAPER), "rough": table.Tables(PAPER / "rough")}
    text = " ".join(statements.about_beds(of).split())
    assert "1.614, 1.657, 1.673, 1.686 m on cells of 6, 4, 3, 2 mm (1.69 ± 0.0150 m" in text
    assert "equation (12) and Table I" in text
    assert "glued beads" in statements.about_beds({"": table.Tables(tmp_path)})
    assert "1.614" not in statements.about_beds({"": table.Tables(tmp_path)})
