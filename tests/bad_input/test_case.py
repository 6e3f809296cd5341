"""A malformed case: exit status 2, and one line that names file, key, found and allowed."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fvcollapse.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
LINE = re.compile(r"(?P<file>.+?): (?P<key>[^:]+): found (?P<found>.+); allowed: (?P<allowed>.+)\n")

# name: (text of the case file, key in the message, words of what is found, of what is allowed)
MALFORMED = {
    # wrong types
    "string for a number": (
        'geometry.height_0 = "0.14"',
        "geometry.height_0",
        '"0.14"',
        "a number",
    ),
    "boolean for a number": ("geometry.height_0 = true", "geometry.height_0", "true", "a number"),
    "list for a number": ("geometry.height_0 = [0.14]", "geometry.height_0", "[0.14]", "a number"),
    "table for a number": ("geometry.height_0.x = 1", "geometry.height_0", "a table", "a number"),
    "date for a number": ("time.end = 2020-01-01", "time.end", "2020-01-01", "a number"),
    "number for a string": ("rheology.law = 3", "rheology.law", "3", '"mu_I" or'),
    "number for a boolean": (
        "numerics.unilateral = 1",
        "numerics.unilateral",
        "1",
        "true or false",
    ),
    "string for a boolean": (
        'numerics.unilateral = "yes"',
        "numerics.unilateral",
        '"yes"',
        "true or false",
    ),
    "fraction of a sweep": ("numerics.max_sweeps = 3.5", "numerics.max_sweeps", "3.5", "a whole"),
    "number for a list": ("time.output_times = 0.5", "time.output_times", "0.5", "a list"),
    "string in a list": ('time.output_times = ["a"]', "time.output_times", '"a" at [0]', "a list"),
    "number for a section": ("geometry = 3", "geometry", "3", "a table"),
    "list of sections": ("[[geometry]]", "geometry", "a list", "a table"),
    "number for an effect": (
        "effects.lateral_friction = 0.18",
        "effects.lateral_friction",
        "0.18",
        "a table",
    ),
    "boolean for an effect": (
        "effects.lateral_friction = true",
        "effects.lateral_friction",
        "true",
        "a table",
    ),
    # not finite
    "nan height": ("geometry.height_0 = nan", "geometry.height_0", "nan", "a number >= 1e-06"),
    "nan width": ("geometry.channel_width = nan", "geometry.channel_width", "nan", "or inf"),
    "nan friction": ("boundary.mu_bed = nan", "boundary.mu_bed", "nan", "or inf"),
    "nan slope": ("geometry.slope_angle_deg = nan", "geometry.slope_angle_deg", "nan", ">= 0"),
    "nan output time": ("time.output_times = [0, nan]", "time.output_times", "nan", "a list"),
    "inf height": ("geometry.height_0 = inf", "geometry.height_0", "inf", "<= 1000"),
    "inf end": ("time.end = inf", "time.end", "inf", "<= 100000"),
    "inf mu_2": ("rheology.mu_2 = inf", "rheology.mu_2", "inf", "<= 10"),
    "inf output time": ("time.output_times = [inf]", "time.output_times", "inf", "finite"),
    "inf vertex": ("geometry.polygon = [[0,0],[inf,0],[0,1]]", "geometry.polygon", "inf", "a list"),
    "-inf gate speed": ("gate.speed = -inf", "gate.speed", "-inf", ">= 0"),
    # out of range
    "negative height": ("geometry.height_0 = -0.1", "geometry.height_0", "-0.1", ">= 1e-06"),
    "no length": ("geometry.length_0 = 0", "geometry.length_0", "0", ">= 1e-06"),
    "no width": ("geometry.channel_width = 0", "geometry.channel_width", "0", ">= 1e-06"),
    "uphill": ("geometry.slope_angle_deg = -1", "geometry.slope_angle_deg", "-1", ">= 0"),
    "too steep": ("geometry.slope_angle_deg = 30.1", "geometry.slope_angle_deg", "30.1", "<= 30"),
    "negative cell": ("grid.cell_size = -0.006", "grid.cell_size", "-0.006", ">= 1e-09"),
    "no cell": ("grid.cell_size_z = 0", "grid.cell_size_z", "0", ">= 1e-09"),
    "negative end": ("time.end = -1", "time.end", "-1", ">= 0"),
    "negative output time": ("time.output_times = [-0.1]", "time.output_times", "-0.1", ">= 0"),
    "no output interval": ("time.output_interval = 0", "time.output_interval", "0", "> 0"),
    "step of zero": ("time.step_max = 0", "time.step_max", "0", ">= 1e-07"),
    "step of an hour": ("time.step_max = 3600", "time.step_max", "3600", "<= 0.1"),
    "step of an attosecond": ("time.step_max = 1e-18", "time.step_max", "1e-18", ">= 1e-07"),
    "courant of ten": ("time.cfl = 10", "time.cfl", "10", "<= 1"),
    "integer of 5000 digits": (
        "time.end = 0x" + "f" * 5000,
        "time.end",
        "0xfff",
        "<= 100000",
    ),
    "negative viscosity": ("rheology.viscosity = -1", "rheology.viscosity", "-1", ">= 0"),
    "no sweep": ("numerics.max_sweeps = 0", "numerics.max_sweeps", "0", ">= 1"),
    "unknown law": ('rheology.law = "mu(I)"', "rheology.law", '"mu(I)"', '"mu_I" or'),
    "unknown method": ('numerics.method = "magic"', "numerics.method", '"magic"', '"coupled"'),
    # rules that tie several keys together
    "mu_2 below mu_1": ("rheology.mu_2 = 0.4", "rheology.mu_2", "0.4", "rheology.mu_1 = 0.48"),
    "bulk denser than grains": (
        "rheology.density_bulk = 2600",
        "rheology.density_bulk",
        "2600",
        "rheology.density_grain = 2500",
    ),
    "coarse grid": ("grid.cell_size = 0.036", "grid.cell_size", "0.036", "<= 0.035"),
    "coarse grid in z": ("grid.cell_size_z = 0.04", "grid.cell_size_z", "0.04", "<= 0.035"),
    "cell longer than the column": (
        "geometry.length_0 = 0.01\ngrid.cell_size = 0.02",
        "grid.cell_size",
        "0.02",
        "geometry.length_0 = 0.01",
    ),
    "more cells than memory": ("grid.cell_size = 1e-6", "grid.cell_size", "1e-06", "cells"),
    "more outputs than disk": (
        "time.output_interval = 1e-9",
        "time.output_interval",
        "1e-09",
        "100000 outputs",
    ),
    "more steps than memory": ("time.step_max = 1e-7", "time.end", "2.5", "1e+06 steps of 1e-07 s"),
    "more output times than disk": (
        f"time.output_times = {[1e-6 * n for n in range(100_001)]}",
        "time.output_times",
        "100001 times",
        "at most 100000 outputs",
    ),
    "more fields than memory": (
        "time.field_interval = 1e-4\ngrid.cell_size = 5e-4",
        "time.field_interval",
        "GB",
        "16 GB",
    ),
    "domain longer than memory": (
        "boundary.domain_length = 1e5",
        "boundary.domain_length",
        "cells in the domain",
        "at most 4e+06 cells",
    ),
    "layer thicker than memory": (
        "effects.erodible_bed.thickness = 1000\ngeometry.slope_angle_deg = 10",
        "effects.erodible_bed.thickness",
        "cells in the domain",
        "at most 4e+06 cells",
    ),
    "domain that may not hold itself": (
        "boundary.domain_max = 1.0\nboundary.domain_length = 2.0",
        "boundary.domain_max",
        "1",
        ">= 2",
    ),
    # beyond what the arithmetic takes
    "gate of light": ("gate.speed = 1e308", "gate.speed", "1e+308", "<= 1e+06, or inf"),
    "late gate of light": (
        "effects.gate.speed = 1e7",
        "effects.gate.speed",
        "10000000.0",
        "or inf",
    ),
    "glue": ("boundary.mu_bed = 1e308", "boundary.mu_bed", "1e+308", "<= 1e+06, or inf"),
    "courant of nothing": ("time.cfl = 5e-324", "time.cfl", "5e-324", ">= 0.001"),
    "channel of nothing": (
        "geometry.channel_width = 5e-324",
        "geometry.channel_width",
        "e-324",
        ">=",
    ),
    "regularised without mu_1": (
        'rheology.law = "mu_I_regularised"\nrheology.mu_1 = 0',
        "rheology.mu_1",
        "well-posed down to I = 0",
        "> 0",
    ),
    "regularised with one mu": (
        'rheology.law = "mu_I_regularised"\nrheology.mu_2 = 0.48',
        "rheology.mu_1",
        "ill-posed for every I",
        "mu_2 well above mu_1",
    ),
    "regularised with a high mu": (
        'rheology.law = "mu_I_regularised"\nrheology.mu_1 = 2\nrheology.mu_2 = 3',
        "rheology.mu_1",
        "ill-posed for every I",
        "below about 1",
    ),
    "regularised with a low mu": (
        'rheology.law = "mu_I_regularised"\nrheology.mu_1 = 0.05',
        "rheology.alpha_regularised",
        "1.9",
        "<= 1.5",
    ),
    "regularised with a high alpha": (
        'rheology.law = "mu_I_regularised"\nrheology.alpha_regularised = 1000',
        "rheology.alpha_regularised",
        "1000",
        "<= 165",
    ),
    "domain inside the column": (
        "boundary.domain_length = 0.1",
        "boundary.domain_length",
        "0.1",
        "> 0.2",
    ),
    "level surface below the bed": (
        'geometry.surface = "horizontal"\ngeometry.length_0 = 0.8',
        "geometry.height_0",
        "0.14",
        "horizontal surface",
    ),
    # polygons
    "polygon of two points": (
        "geometry.polygon = [[0, 0], [0.1, 0.1]]",
        "geometry.polygon",
        "2 vertices",
        "3 to 500",
    ),
    "polygon that crosses itself": (
        "geometry.polygon = [[0, 0], [0.2, 0.1], [0.2, 0], [0, 0.1]]",
        "geometry.polygon",
        "edges 0 and 2",
        "simple polygon",
    ),
    "polygon without area": (
        "geometry.polygon = [[0, 0], [0.1, 0.1], [0.2, 0.2]]",
        "geometry.polygon",
        "touch",
        "simple polygon",
    ),
    "polygon with a vertex twice": (
        "geometry.polygon = [[0, 0], [0.2, 0], [0.2, 0], [0, 0.1]]",
        "geometry.polygon",
        "touch",
        "simple polygon",
    ),
    "polygon with a spike": (
        "geometry.polygon = [[0, 0], [0.2, 0], [0.1, 0], [0.1, 0.1]]",
        "geometry.polygon",
        "edges 0 and 1",
        "simple polygon",
    ),
    "polygon below the bed": (
        "geometry.polygon = [[0, 0], [0.2, -0.1], [0.1, 0.1]]",
        "geometry.polygon",
        "-0.1",
        "from 0",
    ),
    "vertex with three coordinates": (
        "geometry.polygon = [[0, 0, 0], [0.2, 0], [0, 0.1]]",
        "geometry.polygon",
        "at [0]",
        "points [x, z]",
    ),
    "polygon cut by the gate": (
        "geometry.polygon = [[0, 0], [0.3, 0], [0, 0.1]]",
        "geometry.polygon",
        "x up to 0.3",
        "gate.speed = inf",
    ),
    "polygon with a level surface": (
        'geometry.polygon = [[0, 0], [0.2, 0], [0, 0.1]]\ngeometry.surface = "horizontal"',
        "geometry.surface",
        '"horizontal"',
        '"parallel"',
    ),
    # unknown names
    "misspelt key": ("geometry.hieght_0 = 1", "geometry.hieght_0", "unknown", "geometry.height_0"),
    "misspelt section": ("geomtry.height_0 = 1", "geomtry", "unknown", "geometry"),
    "misspelt effect": (
        "[effects.lateral_frction]",
        "effects.lateral_frction",
        "unknown",
        "effects.lateral_friction",
    ),
    "key of no section": ("height_0 = 1", "height_0", "unknown", "geometry.height_0"),
    "key of another section": (
        "geometry.cell_size = 1",
        "geometry.cell_size",
        "unknown",
        "grid.cell_size",
    ),
    "misspelt key of an effect": (
        "effects.lateral_friction.mu_wal = 1",
        "effects.lateral_friction.mu_wal",
        "unknown",
        "effects.lateral_friction.mu_wall",
    ),
    "capital letter": ("rheology.i_0 = 0.3", "rheology.i_0", "unknown", "rheology.I_0"),
    "line break in a key": ('geometry."a\\nb" = 1', "geometry.a b", "unknown", "geometry."),
    # broken files
    "value missing": ("geometry.height_0 =", "file", "end of document", "TOML"),
    "bracket missing": ("[geometry\nheight_0 = 1", "file", "line 1", "TOML"),
    "key twice": ("[grid]\ncell_size = 1\ncell_size = 2", "file", "overwrite a value", "TOML"),
    "nested without end": ("a = " + "[" * 100_000, "file", "broken TOML", "TOML"),
    "decimals without end": ("time.end = " + "9" * 5000, "file", "broken TOML", "TOML"),
    "not TOML at all": ("{'geometry': {'height_0': 1}}", "file", "line 1", "TOML"),
    "zero bytes": ("\0\0\0\0", "file", "line 1", "TOML"),
}

# --set VALUE: (key named in the message, words of what is found, words of what is allowed)
BAD_OVERRIDES = {
    "geometry.height_0": ("--set geometry.height_0", "no '='", "section.key=VALUE"),
    "": ("--set", "no '='", "section.key=VALUE"),
    "=3": ("--set =3", "no key", "section.key=VALUE"),
    "geometry.hieght_0=1": ("geometry.hieght_0", "no key", "geometry.height_0"),
    "height_0=1": ("height_0", "no key", "geometry.height_0"),
    "geometry.height_0.x=1": ("geometry.height_0.x", "no key", "geometry.height_0"),
    "geometry=1": ("geometry", "1", "a table"),
    "effects.lateral_friction={}": ("effects.lateral_friction", "a table", "mu_wall"),
    "effects.lateral_frction.mu_wall=1": (
        "effects.lateral_frction.mu_wall",
        "no key",
        "effects.lateral_friction.mu_wall",
    ),
    "geometry.height_0=": ("geometry.height_0", '""', "a number"),
    "geometry.height_0=tall": ("geometry.height_0", '"tall"', "a number"),
    "geometry.height_0=1\ngrid.cell_size=2": ("geometry.height_0", "the string", "a number"),
    "geometry.height_0=true": ("geometry.height_0", "true", "a number"),
    "geometry.height_0={x = 1}": ("geometry.height_0", "a table", "a number"),
    "rheology.law=bingam": ("rheology.law", '"bingam"', '"bingham"'),
    "rheology.mu_2=0.1": ("rheology.mu_2", "0.1", "rheology.mu_1"),
}


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def refused(capsys, *arguments):
    """Exit status 2, nothing on stdout, one line on stderr; returns its four parts."""
    before = sorted(Path.cwd().rglob("*"))
    assert main(list(map(str, arguments))) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "Traceback" not in err
    assert sorted(Path.cwd().rglob("*")) == before, "a refused case wrote something"
    match = LINE.fullmatch(err)
    assert match, err
    return match.groupdict()


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_case_is_refused(name, capsys):
    text, key, found, allowed = MALFORMED[name]
    Path("bad.toml").write_text(text, encoding="utf-8")
    parts = refused(capsys, "run", "bad.toml")
    assert parts["file"] == "bad.toml"
    assert parts["key"] == key
    assert found in parts["found"].replace("the list", "a list")
    assert allowed in parts["allowed"]


@pytest.mark.parametrize("override", BAD_OVERRIDES)
def test_bad_override_is_refused(override, capsys):
    key, found, allowed = BAD_OVERRIDES[override]
    Path("good.toml").write_text("")
    parts = refused(capsys, "run", "good.toml", "--set", override)
    assert parts["file"].startswith("good.toml")
    assert parts["key"].strip() == key
    assert found in parts["found"]
    assert allowed in parts["allowed"]


def test_override_inside_a_section_that_is_a_number(capsys):
    Path("bad.toml").write_text("geometry = 3")
    parts = refused(capsys, "run", "bad.toml", "--set", "geometry.height_0=0.1")
    assert (parts["key"], parts["found"]) == ("geometry", "3")


def test_missing_file(capsys):
    assert "no such file" in refused(capsys, "run", "absent.toml")["found"]


def test_folder_as_case(capsys):
    Path("folder.toml").mkdir()
    assert "directory" in refused(capsys, "run", "folder.toml")["found"]


def test_file_as_folder_of_the_case(capsys):
    Path("file").write_text("")
    assert "not a directory" in refused(capsys, "run", "file/case.toml")["found"]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root reads all files")
def test_unreadable_file(capsys):
    Path("secret.toml").write_text("")
    Path("secret.toml").chmod(0)
    assert "permission denied" in refused(capsys, "run", "secret.toml")["found"]


def test_loop_of_links(capsys):
    Path("loop.toml").symlink_to("loop.toml")
    assert "symbolic links" in refused(capsys, "run", "loop.toml")["found"]


@pytest.mark.parametrize(
    "data", [b"\xff\xfe[\x00g\x00", b'title = "caf\xe9"', b"\x89HDF\r\n\x1a\n"]
)
def test_bytes_that_are_not_utf8(data, capsys):
    Path("bytes.toml").write_bytes(data)
    assert "UTF-8" in refused(capsys, "run", "bytes.toml")["allowed"]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["run"],
        ["walk"],
        ["run", "a.toml", "b.toml"],
        ["run", "a.toml", "--fast"],
        ["run", "a.toml", "--set"],
        ["plot"],
    ],
    ids=" ".join,
)
def test_bad_usage(arguments, capsys):
    parts = refused(capsys, *arguments)
    assert parts["file"] == "command line"
    assert "--help" in parts["allowed"]


def test_plot_of_nothing(capsys):
    Path("empty").mkdir()
    assert refused(capsys, "plot", "absent.h5")["file"] == "absent.h5"
    assert refused(capsys, "plot", "empty")["file"] == os.path.join("empty", "result.h5")


def test_one_line_from_a_process_too():
    command = [sys.executable, "-m", "fvcollapse", "run", "absent.toml"]
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | {"PYTHONPATH": path}
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert LINE.fullmatch(done.stderr)
