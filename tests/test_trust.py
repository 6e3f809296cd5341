"""How far to trust a result: what is judged, by which limits, and where it is said."""

import math
import re
from pathlib import Path

import pytest

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.output import run as output
from fvcollapse.output import trust
from fvcollapse.output.summary import cell_words
from fvcollapse.output.trust import Trust, trust_of

COARSE = {"grid.cell_size": 0.02, "time.end": 0.05, "geometry.channel_width": math.inf}


def case_of(**changes):
    return Case().replace(**COARSE | changes)


@pytest.mark.parametrize(
    ("status", "drift", "capped", "expected"),
    [
        ("complete", 0.002, 20, "fine"),
        ("complete", -0.0021, 0, "look at it: volume drifts 0.21 %"),
        ("complete", 0.138, 81, "do not use: volume drifts 13.8 %; 81 % of the steps are capped"),
        ("complete", 0.0, 21, "look at it: 21 % of the steps are capped"),
        ("running", 0.0, 0, "look at it: not at its end (running)"),
        ("failed: a guard", 0.0, 0, "do not use: failed: a guard"),
        ("stopped: a limit", 0.0, 0, "look at it: stopped: a limit"),
    ],
)
def test_what_makes_a_result_to_be_trusted(status, drift, capped, expected):
    assert str(trust_of(status, [0.0, drift, 0.0], 0.07, capped, 100, Case())) == expected


def test_the_readme_has_the_limits_of_trust():
    text = Path("fvcollapse/output/README.md").read_text(encoding="utf-8")
    table = [line for line in text.split("## Trust")[1].splitlines() if line.startswith("| ")]
    rows = {cells[1].strip(): cells[2:4] for cells in (line.split("|") for line in table)}
    stated = {
        name: [float(word) for cell in cells for word in re.findall(r"above ([\d.]+) %", cell)]
        for name, cells in rows.items()
    }
    limits = {
        "largest drift": (trust.VOLUME_LOOK, trust.VOLUME_USELESS),
        "sum of the corrections": (trust.CORRECTED_LOOK, trust.CORRECTED_USELESS),
        "share of capped steps": (trust.CAPPED_LOOK,),
    }
    for name, values in limits.items():
        (found,) = (of for row, of in stated.items() if row.startswith(name))
        assert found == pytest.approx([100.0 * value for value in values])
    assert rows["energy lost to the discretisation"][0].strip() == "not judged"


def test_grains_that_dilate_within_their_law_are_trusted():
    """From 0.62 to nu_eq(I = 1) = 0.60 - 0.15: the volume may grow by 38 %."""
    case = Case().replace(**{"effects.dilatancy": {"dilatancy_factor": 4.0}})
    assert trust_of("complete", [0.0, 0.37], 0.05, 0, 1, case).verdict == "fine"
    assert trust_of("complete", [0.0, 0.40], 0.05, 0, 1, case).verdict == "do not use"
    assert trust_of("complete", [0.0, -0.005], 0.05, 0, 1, case).verdict == "look at it"


def test_cohesive_grains_may_loosen_by_what_they_lose_of_the_solid_fraction():
    loss = {"effects.cohesion.adhesion": 20.0, "effects.cohesion.solid_fraction_loss": 0.02}
    case = Case().replace(**loss)  # 0.62 to 0.60: the volume grows by 3.3 %
    assert trust_of("complete", [0.0, 0.033], 0.05, 0, 1, case).verdict == "fine"
    assert trust_of("complete", [0.0, 0.037], 0.05, 0, 1, case).verdict == "look at it"
    without = case.replace(**{"effects.cohesion.solid_fraction_loss": 0.0})
    assert trust_of("complete", [0.0, 0.033], 0.05, 0, 1, without).verdict == "do not use"


def test_the_result_and_its_summary_say_how_far_to_trust_it(tmp_path, capsys):
    case = tmp_path / "case.toml"
    case.write_text("grid.cell_size = 0.02\ntime.end = 0.01\n")
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    printed = capsys.readouterr().out
    few = "7 cells in the height of the column, fewer than 12"
    assert f"trust                               look at it: {few}" in printed
    assert "what finer cells would change is not judged" in printed
    assert "20 mm along the bed, 20 mm normal to it; 10 x 7 in the column" in printed
    result = open_result(tmp_path / "out")
    assert (result.status, result.trust) == ("complete", Trust("look at it", (few,)))
    summary = result.summary()
    assert (summary["status"], summary["trust"], summary["trust_reasons"]) == (
        "complete",
        "look at it",
        few,
    )


def test_a_result_older_than_its_status_is_judged_from_its_record(tmp_path):
    import h5py

    output.run_case(case_of(**{"time.end": 0.01}), tmp_path, quiet=True)
    with h5py.File(tmp_path / "result.h5", "r+") as file:
        for name in ("status", "trust", "trust_reasons"):
            del file.attrs[name]
        file["series/relative_volume"][-1] = 0.02
    result = open_result(tmp_path)
    assert result.status == "complete"
    few = "7 cells in the height of the column, fewer than 12"
    assert str(result.trust) == f"do not use: volume drifts 2 %; {few}"


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (0.14 / 12, "fine"),
        (0.0117, "look at it: 11.9 cells in the height of the column, fewer than 12"),
        (0.035, "4 cells in the height of the column, fewer than 12"),
    ],
)
def test_the_cells_in_the_column_are_judged(size, words):
    """As many as a diagnosis takes by itself are enough."""
    case = Case().replace(**{"grid.cell_size": size})
    assert words in str(trust_of("complete", [0.0], 0.0, 0, 1, case))


def test_cells_that_are_fitted_to_the_gate_are_said():
    case = Case().replace(**{"grid.cell_size": 0.03})
    assert "28.57 mm along the bed (cell_size = 30 mm, fitted to the gate), 30 mm" in cell_words(
        case
    )


def test_corrections_of_the_volume_are_judged():
    """A column ten times as high as long leaves the back wall at 22 degrees: 86 % of its volume is corrected."""
    verdicts = [
        trust_of("complete", [0.0], corrected, 0, 1, Case()) for corrected in (0.1, 0.35, 0.86)
    ]
    assert [trust.verdict for trust in verdicts] == ["fine", "look at it", "do not use"]
    assert "corrections of the volume sum to 86 % of it" in str(verdicts[2])
