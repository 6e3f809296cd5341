"""The study of the effects: who is run, what is shared, tables, pictures."""

import pytest
from fake_simulation import FakeSimulation
from PIL import Image

from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import OBSERVATION
from fvcollapse.output import run as output
from plots import effects as figures
from runs.effects import study
from runs.table import CURVES, read_table

CELL = 0.02
SOME = ("gate", "front_saltation", "time_origin")


def short_baseline(slope, cell_size, whole=study.baseline):
    return whole(slope, cell_size).replace(**{"time.end": 0.1, "time.field_interval": 0.1})


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Tables and figures of a study of fake collapses with `SOME` effects: folder, runs, members."""
    folder = tmp_path_factory.mktemp("study")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        patch.setattr(study, "CATALOGUE", {name: CATALOGUE[name] for name in SOME})
        patch.setattr(study, "baseline", short_baseline)
        arguments = ["catalogue", "--workers", "1", "--out", folder / "data", "--tables", folder]
        assert study.main([str(word) for word in [*arguments, "--cell-size", CELL]]) == 0
        figures.main(folder, folder / "figures")
        return folder, len(list((folder / "data").iterdir())), study.members(CELL)


def test_every_effect_variant_strength_and_slope_is_a_member():
    members = study.members(CELL)
    wanted = len(study.SLOPES) * (
        1 + len(study.STRENGTHS) * sum(len(effect.variants) for effect in CATALOGUE.values())
    )
    assert len(members) == len({member.name for member in members}) == wanted
    for member in members:
        assert member.case.geometry.slope_angle_deg == member.slope
        on = {name for name in CATALOGUE if getattr(member.case.effects, name) is not None}
        assert on == {member.effect} - {study.BASELINE}


def test_what_is_only_seen_shares_the_run_of_the_baseline():
    members = study.members(CELL)
    runs = study.shared_runs(members)
    names = [name for name, _ in runs.values()]
    for member in members:
        only_seen = CATALOGUE.get(member.effect, CATALOGUE["gate"]).kind == OBSERVATION
        assert not only_seen or member.name not in names
    assert not any(name.startswith(("front_saltation", "time_origin")) for name in names)
    assert not any(name.startswith("transverse_profile_wall") for name in names)
    assert sum(name.startswith("transverse_profile_average") for name in names) == 9
    assert not any(name.startswith("tilt_middle") for name in names)  # the median is no tilt


def test_tables_hold_every_member(made):
    folder, count, members = made
    assert count == len(study.shared_runs(members))
    numbers = read_table(folder / study.NUMBERS)
    assert [row["effect"] for row in numbers] == [member.effect for member in members]
    assert float(numbers[0]["cost_factor"]) == 1.0
    curves = read_table(folder / CURVES)
    assert len(curves) == 2 * len(members)
    of = {(*(row[name] for name in study.MEMBER), row["quantity"]): row for row in curves}
    front = of["none", "", "", "16", "front_m"]["values"].split()
    later = of["time_origin", "", "strong", "16", "front_m"]["values"].split()
    assert float(front[0]) < float(later[0])  # the clock starts late
    seen = {
        row["strength"]: float(row["runout_m"])
        for row in numbers
        if row["effect"] == "front_saltation" and row["slope_deg"] == "0"
    }
    assert seen["weak"] < seen["strong"]


def test_every_effect_has_a_picture_with_its_caption(made):
    folder, *_ = made
    for name in SOME:
        with Image.open(folder / "figures" / f"effects_{name}.png") as picture:
            assert picture.width > 800
        text = " ".join((folder / "figures" / f"effects_{name}.txt").read_text().split())
        assert all(f"{key}=" in text for key in CATALOGUE[name].priors)
        assert "20 mm" in text


def test_bad_arguments_are_one_line(capsys, tmp_path):
    assert study.main(["catalogue", "--workers", "0"]) == 2
    assert study.main(["catalogue", "--cell-size", "0.2", "--out", str(tmp_path / "data")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    assert "--workers" in lines[0]
    assert "grid.cell_size" in lines[1]
