"""Measured collapses whose cause is known: their folders, and the table of what a diagnosis says of them."""

import json
from pathlib import Path

import numpy as np
import pytest
from report_example import example

from fvcollapse import load_experiment
from fvcollapse.diagnosis.names import UNKNOWN
from fvcollapse.diagnosis.oddities import oddities_of
from fvcollapse.diagnosis.question import Question
from runs import readme_reports
from runs.experiments import convert
from runs.laboratories import study
from runs.laboratories.folders import SLOT_CASES, of_repeats, pairwise, wet_beads
from runs.study import parse
from runs.table import read_table, write_table

SHIPPED = Path(convert.__file__).parent
STORED = study.HERE / study.ANSWERS
FOLDERS = sorted(
    {
        folder
        for one in study.LABORATORIES.values()
        for folder in (*one.experiments, *one.controls, *one.held_out)
    }
)


@pytest.mark.parametrize("folder", FOLDERS)
def test_an_experiment_states_its_sources_and_is_plausible(folder):
    one = load_experiment(SHIPPED / folder)
    assert one.settings.title
    assert len(one.settings.source) > 100
    assert oddities_of([one]) == []


def test_the_folders_are_small():
    new = ("alfarizki2023", "bui2008_bars", "narrow_slot")
    files = [path for name in new for path in (SHIPPED / name).rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 30_000


@pytest.mark.parametrize("name", study.LABORATORIES)
def test_a_laboratory_is_a_question(name):
    one = study.LABORATORIES[name]
    parts = (one.experiments, one.held_out, one.controls)
    loaded = [tuple(load_experiment(SHIPPED / folder) for folder in part) for part in parts]
    Question(*loaded).check()
    assert not set(one.right) & set(one.wrong)
    assert one.known


def test_wet_and_dry_beads_differ_by_the_water_alone():
    """And the water shortens the run and steepens the pile."""
    for size in ("d06mm", "d10mm"):
        dry, wet = (
            load_experiment(SHIPPED / "alfarizki2023" / f"{size}_{water}")
            for water in ("dry", "wet5")
        )
        for section in ("geometry", "gate", "material", "uncertainty", "common"):
            assert getattr(dry.settings, section) == getattr(wet.settings, section)
        assert dry.has_common("height_0")
        values = [{each.name: each.value for each in one.scalars} for one in (dry, wet)]
        assert values[1]["runout"] < values[0]["runout"] - 0.02
        assert values[1]["final_height"] > values[0]["final_height"] + 0.01


def test_the_columns_of_lajeunesse_follow_their_rule():
    """Those of aspect ratio 0.7 to 6 with run-out and height, in order; every third is held out."""
    one = study.LABORATORIES["lajeunesse"]
    found = {}
    for folder in (SHIPPED / "lajeunesse2005").iterdir():
        column = load_experiment(folder)
        geometry = column.settings.geometry
        aspect = geometry.height_0 / geometry.length_0
        if 0.7 < aspect < 6.0 and len(column.scalars) == 2:
            found[aspect] = f"lajeunesse2005/{folder.name}"
    names = [found[aspect] for aspect in sorted(found)]
    assert one.held_out == tuple(names[2::3])
    assert one.experiments == tuple(name for name in names if name not in one.held_out)


def test_bars_have_neither_walls_nor_a_gate():
    one = load_experiment(SHIPPED / "bui2008_bars")
    case = one.case()
    assert case.geometry.channel_width == case.gate.speed == np.inf
    assert case.rheology.mu_1 == pytest.approx(np.tan(np.radians(19.8)), abs=1e-5)
    assert one.assumed()["material.mu_2"].value == pytest.approx(case.rheology.mu_1 + 0.25)
    curve = one.curves["profiles"]
    area = np.trapezoid(curve.value, curve.x)
    assert area == pytest.approx(0.02, rel=0.02)


def test_the_slot_cases_differ_by_rolling_friction_alone():
    slot = [load_experiment(SHIPPED / "narrow_slot" / name) for name in SLOT_CASES]
    assert len({one.settings.material for one in slot}) == 1
    fronts = {one.name: one.scalars[0].value for one in slot}
    assert fronts["mur0.1_a2"] < fronts["mur0_a2"]
    assert fronts["mur0.1_a4"] < fronts["mur0_a4"]


def test_repeats_become_a_mean_and_its_error():
    value, sigma = of_repeats([0.27, 0.28, 0.288, 0.289, 0.288])
    assert value == pytest.approx(0.283)
    assert sigma == pytest.approx(np.hypot(0.0081 / np.sqrt(5.0), 0.001), rel=0.01)
    points = pairwise(np.array([[0.0, 2.0], [1.0, 4.0], [2.0, 6.0]]))
    assert points.tolist() == [[0.5, 3.0]]


def test_the_table_of_repeats_becomes_folders(tmp_path):
    rows = ["grain_diameter_mm,water_percent_of_grain_mass,repeat,quantity,value"]
    table = {
        "front_from_back_wall_m": (0.28, -0.03),
        "final_height_m": (0.08, 0.02),
        "top_angle_deg": (22.0, 8.0),
    }
    for quantity, (dry, more) in table.items():
        for diameter in (6, 10):
            rows += [
                f"{diameter},{water},{n},{quantity},{dry + (water == 5) * more + 0.001 * n}"
                for water in (0, 3, 5)
                for n in range(5)
            ]
    (tmp_path / "runs.csv").write_text("\n".join([*rows, ""]), encoding="utf-8")
    wet_beads(tmp_path, tmp_path / "out")
    names = sorted(path.name for path in (tmp_path / "out" / "alfarizki2023").iterdir())
    assert names == ["d06mm_dry", "d06mm_wet5", "d10mm_dry", "d10mm_wet5"]
    wet = load_experiment(tmp_path / "out" / "alfarizki2023" / "d10mm_wet5")
    assert [each.value for each in wet.scalars] == pytest.approx([0.252, 0.102])
    assert wet.settings.material.mu_1 == pytest.approx(np.tan(np.radians(22.002)), abs=1e-6)
    assert wet.settings.material.grain_diameter == 0.01


# -- the answers ---------------------------------------------------------------------------------


def asked(tmp_path, *more):
    return parse(study.STUDY, ["diagnose", "--tables", str(tmp_path), *more])


def test_answers_are_kept_and_given_once(tmp_path, monkeypatch):
    given = []

    def diagnosed(name, options):
        given.append(name)
        if len(given) == 3:
            raise KeyboardInterrupt
        return example("effect" if name == "bars" else "unknown", probable=0.7)

    monkeypatch.setattr(study, "diagnosed", diagnosed)
    with pytest.raises(KeyboardInterrupt):
        study.diagnose(asked(tmp_path))
    stored = json.loads((tmp_path / study.ANSWERS).read_text(encoding="utf-8"))
    assert list(stored) == given[:2]
    study.diagnose(asked(tmp_path))
    assert sorted(given) == sorted([*study.LABORATORIES, given[2]])
    rows = {row["laboratory"]: row for row in read_table(tmp_path / "answers.csv")}
    assert list(rows) == list(study.LABORATORIES)
    assert rows["narrow_slot"]["called"] == UNKNOWN
    assert float(rows["narrow_slot"]["of_the_right"]) == pytest.approx(0.7)
    assert rows["lajeunesse"]["right"] == rows["lajeunesse"]["of_the_right"] == ""


def test_what_cannot_act_is_counted(tmp_path):
    """Friction of lateral walls that are not there, alone or beside another effect."""
    report = example("effect", probable=0.7)
    answer = study.answer_of(report, study.LABORATORIES["bars"])
    row = study.row_of("bars", answer)
    wrong = study.LABORATORIES["bars"].wrong
    chances = answer["probability"].items()
    expected = sum(p for name, p in chances if set(name.split("+")) & set(wrong))
    assert row["of_the_impossible"] == pytest.approx(expected)
    assert row["called"] == "+".join(sorted(answer["effects"]))
    ladder = report.details.ladder
    assert [one["model"] for one in answer["models"]] == [rung.model for rung in ladder]
    best = max(rung.fitted.fraction_closed or 0.0 for rung in ladder)
    assert row["closed"] == pytest.approx(best, abs=1e-3)
    assert answer["headline"]
    json.dumps(answer, allow_nan=False)


def test_an_unknown_laboratory_is_named(tmp_path, capsys):
    assert study.main(["diagnose", "--only", "beach", "--tables", str(tmp_path)]) == 2
    assert "--only: found beach" in capsys.readouterr().err
    assert study.main(["folders", "--tables", str(tmp_path)]) == 2
    assert "--data: found none" in capsys.readouterr().err


def test_the_stored_answers_are_of_these_questions(tmp_path):
    answers = json.loads(STORED.read_text(encoding="utf-8"))
    assert list(answers) == list(study.LABORATORIES)
    for name, answer in answers.items():
        one = study.LABORATORIES[name]
        assert answer["experiments"] == [folder.rpartition("/")[2] for folder in one.experiments]
        assert answer["held_out"] == [folder.rpartition("/")[2] for folder in one.held_out]
        assert sum(answer["probability"].values()) == pytest.approx(1.0, abs=2e-3)
    write_table(tmp_path / "answers.csv", [study.row_of(*item) for item in answers.items()])
    assert read_table(study.HERE / "answers.csv") == read_table(tmp_path / "answers.csv")


def test_the_readme_says_which_laboratories_are_not_asked_yet(tmp_path, monkeypatch):
    """And of the others what they are called."""
    (tmp_path / "laboratories").mkdir()
    monkeypatch.setattr(readme_reports, "RUNS", tmp_path)
    one = study.answer_of(example("effect", probable=0.7), study.LABORATORIES["wet_beads"])
    row = study.row_of("wet_beads", one)
    write_table(tmp_path / "laboratories" / "answers.csv", [row])
    lines = {line.split("`")[1]: line for line in readme_reports.laboratories().splitlines()[2:]}
    assert list(lines) == list(study.LABORATORIES)
    assert f"{row['called']} 0.70" in lines["wet_beads"]
    assert f"cohesion {row['of_the_right']:.2f}" in lines["wet_beads"]
    assert "not asked yet" in lines["bars"]
