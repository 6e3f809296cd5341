"""`import-curves`: curves become an experiment in its units, whole or not at all, and what looks wrong is asked for."""

from pathlib import Path

import numpy as np
import pytest

from fvcollapse import load_experiment
from fvcollapse.__main__ import main
from fvcollapse.errors import OutputError
from fvcollapse.measure import digitised

EXPORTS = Path(__file__).parent / "conventions" / "tool_exports"
SET_UP = ["geometry.slope_angle_deg=16", "geometry.height_0=0.14", "geometry.length_0=0.2"]


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "front.txt").write_text("0;20\n50;24,5\n")
    (tmp_path / "late.txt").write_text("0 13\n30 2.5\n")
    (tmp_path / "early.txt").write_text("0\t14\n20\t14\n")
    (tmp_path / "volume.txt").write_text("0,0\n50,2.5\n")
    return tmp_path


def imported(*arguments):
    return main(["import-curves", "--out", "beads", *arguments])


CURVES = ["--front", "front.txt", "--volume", "volume.txt", "--interface", "0.1=late.txt"]
PROFILES = ["--profile", "0.2=late.txt", "--profile", "0=early.txt"]
UNITS = ["--length-unit", "cm", "--time-unit", "ms", "--volume-unit", "%"]


def test_curves_become_an_experiment(files, capsys):
    arguments = [word for setting in SET_UP for word in ("--set", setting)]
    assert imported(*CURVES, *PROFILES, *UNITS, *arguments, "--set", "title=beads, by hand") == 0
    assert capsys.readouterr().out.count("\n") == 9  # files, and ranges of the curves
    experiment = load_experiment(files / "beads")
    assert experiment.settings.title == "beads, by hand"
    assert experiment.settings.geometry.height_0 == 0.14
    front, profiles = experiment.curves["front"], experiment.curves["profiles"]
    np.testing.assert_allclose(front.time, [0.0, 0.05])
    np.testing.assert_allclose(front.value, [0.2, 0.245])
    np.testing.assert_allclose(profiles.time, [0.0, 0.0, 0.2, 0.2])
    np.testing.assert_allclose(profiles.x, [0.0, 0.2, 0.0, 0.3])
    np.testing.assert_allclose(profiles.value, [0.14, 0.14, 0.13, 0.025])
    np.testing.assert_allclose(experiment.curves["volume"].value, [0.0, 0.025])
    np.testing.assert_allclose(experiment.curves["interface"].time, [0.1, 0.1])


def test_what_is_not_known_is_asked_for_and_later_curves_join(files, capsys):
    assert imported("--front", "front.txt", *UNITS) == 0
    assert "still to be filled in" in (out := capsys.readouterr().out)
    assert "geometry.slope_angle_deg, geometry.height_0, geometry.length_0 in " in out
    path = files / "beads" / "experiment.toml"
    text = path.read_text()
    for line in ("slope_angle_deg = 16", "height_0 = 0.14", "length_0 = 0.2"):
        assert f"\n# {line.split()[0]} =" in text
        text = text.replace(f"\n# {line.split()[0]} =", f"\n{line}", 1)
    path.write_text(text)
    assert imported(*PROFILES, "--length-unit", "cm") == 0
    assert list(load_experiment(files / "beads").curves) == ["front", "profiles"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--profile", "late.txt"], "--profile: found 'late.txt'; allowed: T=FILE"),
        (["--profile", "nan=late.txt"], "--profile: found 'nan=late.txt'"),
        (["--profile", "0.1="], "--profile: found '0.1='"),
        (["--front", "none.txt"], "none.txt: file: found no such file"),
        (["--length-unit", "inch"], "invalid choice: 'inch'"),
        (
            ["--profile", "0.1=late.txt", "--profile", "0.1=early.txt"],
            "early.txt: file: found a second file for profiles at 0.1 s, beside late.txt",
        ),
        (["--set", "geometry.hight_0=1"], "geometry.hight_0: found an unknown key"),
        (["--set", "geometry.height_0=-1"], "geometry.height_0: found -1; allowed: a number > 0"),
        (["--set", "height"], "--set height: found no key or no '='"),
        (["--set", "title=\udcff"], "--set: found a byte that is not UTF-8 in 'title="),
        (
            ["--set", "geometry=1", "--set", "geometry.height_0=1"],
            "geometry: found 1; allowed: a table",
        ),
        (["--set", "geometry=1"], "geometry: found 1; allowed: a table"),
    ],
)
def test_bad_arguments_are_one_line_and_write_nothing(files, capsys, arguments, words):
    assert imported(*arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not (files / "beads").exists()


def test_nothing_is_overwritten(files, capsys):
    assert imported("--front", "front.txt") == 0
    before = {path.name: path.read_bytes() for path in (files / "beads").iterdir()}
    assert imported("--front", "late.txt") == 2
    assert "front.csv: file: found one that is already there" in capsys.readouterr().err
    assert imported("--volume", "volume.txt", "--set", "title=other") == 2
    assert before == {path.name: path.read_bytes() for path in (files / "beads").iterdir()}


def test_a_forgotten_unit_is_told_before_anything_is_written(files, capsys):
    """The exports are in cm."""
    curves = [
        *("--front", str(EXPORTS / "front_wpd.csv")),
        *("--profile", f"0.2={EXPORTS / 'h_0.2s_wpd.csv'}"),
        *(word for setting in SET_UP for word in ("--set", setting)),
    ]
    assert imported(*curves) == 2
    error = capsys.readouterr().err
    assert "front.csv: x_front_m: found" in error
    assert "in cm instead of m?" in error
    assert error.count("\n") == 1
    assert not (files / "beads").exists()
    assert imported(*curves, "--length-unit", "cm") == 0
    experiment = load_experiment(files / "beads")
    assert [len(experiment.curves[name].time) for name in ("front", "profiles")] == [20, 14]


def test_abscissae_that_are_one_in_the_file_are_refused(files, capsys):
    """Seven digits are written."""
    (files / "front.txt").write_text("1.00000001 0.2\n1.00000002 0.3\n")
    assert imported("--front", "front.txt") == 2
    assert "t_s: found 1 after 1 in line 3" in capsys.readouterr().err
    assert not (files / "beads").exists()


def test_a_full_disk_leaves_no_half_of_an_experiment(files, capsys, monkeypatch):
    def full(path, data, running=True):
        if path.name == "experiment.toml":
            raise OutputError(path, "no space left", running)
        path.write_bytes(data)

    monkeypatch.setattr(digitised, "write_atomic", full)
    assert imported("--front", "front.txt") == 2
    assert "no space left" in capsys.readouterr().err
    assert not (files / "beads").exists()


def test_positions_from_the_gate_become_positions_from_the_wall(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("f.txt").write_text("0 0\n100 4\n200 11\n")
    front = ["--front", "f.txt", "--length-unit", "cm", "--time-unit", "ms", "--front-from", "gate"]
    assert imported(*front) == 2
    assert "--set geometry.length_0=VALUE" in capsys.readouterr().err
    assert not Path("beads").exists()
    assert imported(*front, "--set", "geometry.length_0=0.2") == 0
    rows = Path("beads/front.csv").read_text().splitlines()[1:]
    assert [float(row.split(",")[1]) for row in rows] == pytest.approx([0.20, 0.24, 0.31])
    assert imported(*front, "--force") == 0  # the length is in the folder now


def test_a_folder_of_nothing_is_not_made(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert imported() == 2
    assert "no curve and no --set" in capsys.readouterr().err
    assert not Path("beads").exists()


def test_the_ranges_are_told_and_a_front_of_metres_is_asked_for(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("front.csv").write_text("0,20\n0.5,50\n1,70\n")
    assert imported("--front", "front.csv") == 0
    printed = capsys.readouterr().out
    assert "front.csv: 3 points, t = 0 to 1 s, x_front = 20 to 70 m\n" in printed
    assert "in cm? --length-unit cm" in printed
    assert imported("--front", "front.csv", "--length-unit", "cm", "--force") == 0
    printed = capsys.readouterr().out
    assert "x_front = 0.2 to 0.7 m" in printed
    assert "in cm?" not in printed
