"""Curves of digitising tools: every style of numbers, units, and what is refused."""

from pathlib import Path

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from fvcollapse import load_experiment
from fvcollapse.__main__ import main
from fvcollapse.errors import InputError, OutputError
from fvcollapse.measure import digitised
from fvcollapse.measure.digitised import read_pairs
from fvcollapse.measure.digitised_table import STYLES

EXPORTS = Path(__file__).parent / "conventions" / "tool_exports"
POINTS = [(0.0, 20.0), (0.05, 21.5), (0.1, -1.25e-3)]
SET_UP = ["geometry.slope_angle_deg=16", "geometry.height_0=0.14", "geometry.length_0=0.2"]


def text_in(between, decimal, pairs=POINTS):
    mark = "  " if between is None else between
    quote = '"' if between == decimal else ""
    lines = (mark.join(f"{quote}{float(value)!r}{quote}" for value in pair) for pair in pairs)
    return "\n".join(line.replace(".", decimal) for line in lines) + "\n"


@pytest.mark.parametrize(("between", "decimal"), STYLES)
def test_every_style_is_read(tmp_path, between, decimal):
    path = tmp_path / "curve.txt"
    path.write_text(text_in(between, decimal))
    np.testing.assert_array_equal(read_pairs(path), POINTS)


@settings(max_examples=60)
@given(
    pairs=st.lists(
        st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)),
        min_size=1,
        max_size=8,
        unique_by=lambda pair: pair[0],
    ),
    style=st.sampled_from(STYLES),
)
def test_style_does_not_change_the_numbers(tmp_path_factory, pairs, style):
    path = tmp_path_factory.mktemp("curve") / "curve.txt"
    path.write_text(text_in(*style, pairs))
    np.testing.assert_array_equal(read_pairs(path), sorted(pairs))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1, 2\n3, 4\n", [(1, 2), (3, 4)]),
        ("1 ; 2,5\n", [(1, 2.5)]),
        ("0,1 ; 2\n3 ; 4\n", [(0.1, 2), (3, 4)]),
        ("1,5\t2\n", [(1.5, 2)]),
        ("1,5 -2,5e-3\n", [(1.5, -2.5e-3)]),
        ("x;y\n1;2\n", [(1, 2)]),
        ("# tool 4.5\n\n 2\t1 \r\n1\t3\r\n", [(1, 3), (2, 1)]),
        ("\ufeff1 2\n", [(1, 2)]),
        ("1 2\n1 4\n0 5\n", [(0, 5), (1, 3)]),  # clicked twice
        ("Default Dataset,\nX,Y\n1,2\n", [(1, 2)]),
        ("h at t = 0.2 s,\nX,Y\n1.5,2\n", [(1.5, 2)]),
        ("0.2 s,\nX,Y\n1.5,2\n", [(1.5, 2)]),
        ("x,Curve1\n1,2\n", [(1, 2)]),
        ('"x";"y"\n"1,5";"2"\n', [(1.5, 2)]),
        ('"1,50000", "2,50000"\n', [(1.5, 2.5)]),
        ("\ufeffsep=;\nx;y\n1,5;2\n", [(1.5, 2)]),
        ("sep=|\n1|2\n", [(1, 2)]),
        ("Empty,,front,\nX,Y,X,Y\n,,1,2\n,,3,4\n", [(1, 2), (3, 4)]),  # one of two sets is empty
        ("1,2,\n3,4,\n", [(1, 2), (3, 4)]),
    ],
)
def test_what_tools_write(tmp_path, text, expected):
    path = tmp_path / "curve.txt"
    path.write_text(text, encoding="utf-8")
    np.testing.assert_array_equal(read_pairs(path), expected)


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("", "file", "no points"),
        ("x,y\n", "file", "no points"),
        ("1 2\n3 four\n", "line 2", "'3 four'"),
        ("1 2 3\n", "line 1", "'1 2 3'"),
        ("1,5 2,5\n1.5 2.5\n", "line 2", "'1.5 2.5'"),
        ("1 nan\n", "line 1", "'1 nan'"),
        ("0,1,0,2\n", "line 1", "'0,1,0,2'"),
        ("x,y\n0,1,0,2\n", "line 2", "4 columns of numbers if no comma is a decimal mark"),
        ("A,,B,\nX,Y,X,Y\n0,1,0,2\n", "line 3", "4 columns of numbers under A, B"),
        ("x,Curve1,Curve2\n0,1,2\n", "line 2", "3 columns of numbers under x, Curve1, Curve2"),
        ("1\n2\n", "line 1", "1 column of numbers"),
        ("x,y\n1,2\nx,y\n3,4\n", "line 3", "words below numbers"),
        ("nan;nan\n1;2\n", "line 1", "'nan;nan'"),
        ("1,2\n3,\n", "line 2", "'3,'"),
        ("1;2,5\n1.5;2.5\n", "line 2", "'1.5;2.5'"),
        ('"1,234","5,678"\n', "file", "may be decimal marks or stand between thousands"),
        ("1_0 2\n", "line 1", "'1_0 2'"),
        ("1 \u0662\n", "line 1", "'1 \u0662'"),
        ("1 1e999\n", "line 1", "'1 1e999'"),
        ("a\nb\nc\nd\n1 2\n", "line 4", "'d'"),
        ('{"dataset": [1, 2]}\n', "file", "a JSON document"),
        ('<?xml version="1.0"?>\n1 2\n', "file", "an XML document"),
    ],
)
def test_what_is_no_curve_is_refused(tmp_path, text, key, words):
    path = tmp_path / "curve.txt"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_pairs(path)
    assert caught.value.key == key
    assert words in caught.value.found


@pytest.mark.parametrize(
    ("data", "words"), [(b"PK\x03\x04\xff", "a ZIP archive"), ("1;2\n".encode("utf-16"), "UTF-16")]
)
def test_a_spreadsheet_is_named(tmp_path, data, words):
    path = tmp_path / "curve.xlsx"
    path.write_bytes(data)
    with pytest.raises(InputError, match=words):
        read_pairs(path)


@pytest.mark.parametrize(
    ("file", "count", "first", "last"),
    [
        ("front_wpd.csv", 20, (0.000496854507139, 20.0), (0.951338671379642, 52.76119531113468)),
        ("h_0.2s_wpd.csv", 14, (1.0, 13.55), (27.0, 1.41)),
        ("curve_default.csv", 20, (0.0, 0.2), (0.95, 0.527612)),
        ("curve_cs_CZ.csv", 20, (0.0, 0.2), (0.95, 0.52761)),
    ],
)
def test_exports_of_tools_are_read(file, count, first, last):
    pairs = read_pairs(EXPORTS / file)
    assert len(pairs) == count
    assert (tuple(pairs[0]), tuple(pairs[-1])) == (first, last)


def test_one_mark_for_two_things_is_not_guessed():
    with pytest.raises(
        InputError, match=r"line 2: found '0,00000,0,20000', 4 columns .* semicolons"
    ):
        read_pairs(EXPORTS / "curve_et_EE.csv")


# -- the folder --------------------------------------------------------------------------------


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
