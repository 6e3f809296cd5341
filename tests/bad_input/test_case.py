"""A malformed case: exit status 2, and one line that names file, key, found and allowed."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from malformed_cases import MALFORMED

from fvcollapse.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
LINE = re.compile(r"(?P<file>.+?): (?P<key>[^:]+): found (?P<found>.+); allowed: (?P<allowed>.+)\n")


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
    "effects.thin_layer.length=0": ("effects.thin_layer.length", "0", "a number > 0"),
    'effects.thin_layer.closure="thick"': ("effects.thin_layer.closure", '"thick"', '"nonlocal"'),
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
    assert refused(capsys, "run", "folder.toml")["found"] == "a folder"


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
        ["walk"],
        ["run", "a.toml", "b.toml"],
        ["run", "a.toml", "--fast"],
        ["run", "a.toml", "--set"],
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
