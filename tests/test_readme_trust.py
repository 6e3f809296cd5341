"""The table of how far to trust the solver and the diagnosis counts and reads what is stored."""

import pytest

from fvcollapse.errors import FvcollapseError
from runs import readme_reports, readme_trust
from runs.paper.settled import ON_BED
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED
from runs.table import write_table


def test_the_statements_of_the_paper_are_counted_once_each(tmp_path, monkeypatch):
    verdicts = {1: (CONFIRMED, "1.0"), 2: (REFUTED, "1.0"), 3: (ON_BED, "1.0"), 4: (OPEN, "")}
    rows = [
        {"statement": number, "verdict": verdict if first else "", "value": value}
        for number, (verdict, value) in (verdicts | {5: (OPEN, "2.0")}).items()
        for first in (True, False)
    ]
    write_table(tmp_path / "paper" / "statements.csv", rows)
    monkeypatch.setattr(readme_trust, "RUNS", tmp_path)
    bullets = "- **Measured curves** (statements 4, on fronts)\n- **The finite-element code** (4)\n"
    page = tmp_path / "paper" / "README.md"
    page.write_text(f"{bullets}- **A number for a word** (5).\n", encoding="utf-8")
    assert readme_trust.paper()[1] == (
        "1 of 5 statements; 1 not; 1 depend on the bed or on how a front is read; 2 cannot be decided, 1 of them for "
        "want of data or code, 1 for want of a number in the paper"
    )
    page.write_text(f"{bullets}- **A number for a word** (1, 5).\n", encoding="utf-8")
    with pytest.raises(FvcollapseError, match="of the undecided alone"):
        readme_trust.paper()


def test_numbers_of_statements_are_listed_or_from_one_to_another():
    text = "- **A number for a word** (2, 5–7, 9; also 24): x\n"
    assert readme_trust.named(text, "A number for a word") == {2, 5, 6, 7, 9}
    with pytest.raises(FvcollapseError, match="Measured curves"):
        readme_trust.named(text, "Measured curves")


def test_the_final_front_is_that_of_the_last_time(tmp_path, monkeypatch):
    rows = [
        {"comparison": name, "quantity": "front", "relative_difference": of}
        for name, of in (("a", 0.1), ("a", -0.014), ("b", 0.3))
    ]
    write_table(tmp_path / "comparison" / "differences.csv", rows)
    monkeypatch.setattr(readme_trust, "RUNS", tmp_path)
    assert readme_trust.final_front("a", "front") == "−1.4 %"


def test_laboratories_in_which_an_effect_is_named_wrongly_are_not_counted(tmp_path, monkeypatch):
    answers = [
        {"right": "cohesion", "called": "cohesion", "of_the_right": "0.4"},
        {"right": "cohesion", "called": "none", "of_the_right": "0.1"},
        {"right": "unknown", "called": "none", "of_the_right": "0.1"},
        {"right": "", "called": "none", "of_the_right": ""},
        {"right": "", "called": "tilt", "of_the_right": ""},
    ]
    fits = [
        {"walls": walls, "columns": 28, "runout_mean_percent": of}
        for walls, of in (("absent", -15.1), ("measured", -31.1))
    ]
    write_table(tmp_path / "laboratories" / "answers.csv", answers)
    write_table(tmp_path / "laboratories" / "columns_fit.csv", fits)
    seen = [("a1", "runout"), ("a2", "runout"), ("a3", "final_height")]
    columns = [
        {"column": column, "quantity": quantity, "walls": walls}
        for column, quantity in seen
        for walls in ("absent", "measured")
    ]
    write_table(tmp_path / "laboratories" / "columns.csv", columns)
    monkeypatch.setattr(readme_trust, "RUNS", tmp_path)
    told = readme_trust.laboratories()[1]
    assert "cohesion is the answer in 1 of 2 groupings of one data set of wetted beads" in told
    assert "(probability 40 %); no effect is named in 1 of 2 laboratories" in told
    assert "1 of 1 causes outside of the catalogue (rolling friction) is missed" in told
    assert (
        "2 columns of beads of measured runout run 31 % less far in the model, on average" in told
    )


def test_the_answers_to_another_code_are_none_or_stand_out(tmp_path, monkeypatch):
    sizes = {"regions": 0, "ratio": {"front": 0.51, "profiles": 0.666}}
    quiet = {"verdict": "none", "effects": [], "set": ["none", "gate"]} | sizes
    wrong = {"verdict": "effect", "effects": ["gate"], "set": ["gate"]} | sizes
    answers = {
        "a": quiet | {"probability": {"none": 0.5, "gate": 0.3, "unknown": 0.2}},
        "b": wrong | {"probability": {"gate": 0.66, "none": 0.34}},
    }
    for module in (readme_reports, readme_trust):
        monkeypatch.setattr(module, "stored", lambda *_: answers)
    lines = readme_reports.cross_code().splitlines()
    assert "| `a` | none 0.50 | gate 0.30 | 2 | 0 | 0.67, 0.51 |" in lines
    assert "| `b` | **gate** 0.66 | gate 0.66 | 1 | 0 | 0.67, 0.51 |" in lines
    precise = [{"called": "none"}, {"called": "unknown"}, {"called": "none"}]
    write_table(tmp_path / "cross_code" / "precision.csv", precise)
    monkeypatch.setattr(readme_trust, "RUNS", tmp_path)
    assert readme_trust.null()[1] == (
        "none is the answer to 1 of 2 questions without controls, by a rule that was made after them (the most "
        "probable other cause has 66 % at most), and to 2 of 3 with a half or a quarter of the noise"
    )
