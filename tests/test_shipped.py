"""The case and the experiments come with the package, in a wheel too: paths of the READMEs work outside a checkout."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

import pytest
from hatchling.builders.wheel import WheelBuilder
from readme_blocks import ROOT

from fvcollapse.__main__ import main
from fvcollapse.files.shipped import shipped_files

RUNS = ROOT / "runs"
DATA = {
    path.relative_to(RUNS): path.read_bytes()
    for path in [RUNS / "collapse_22deg_w10cm.toml", *(RUNS / "experiments").rglob("*")]
    if path.suffix in (".toml", ".csv", ".md")
}


def contents(folder):
    """{path below a folder: bytes} of all files in it."""
    return {
        path.relative_to(folder): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != "lock"
    }


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder with the contents of the wheel, as pip unpacks it."""
    folder = tmp_path_factory.mktemp("wheel")
    (wheel,) = WheelBuilder(str(ROOT)).build(directory=str(folder / "dist"), versions=["standard"])
    with ZipFile(wheel) as file:
        file.extractall(folder / "site")
    return folder / "site"


def fvcollapse(site, folder, *words):
    """What a command of an installed copy prints, called in a folder; its exit status must be 0."""
    environment = os.environ | {"PYTHONPATH": str(site), "FVCOLLAPSE_CACHE": str(folder / "cache")}
    call = [sys.executable, "-P", "-m", "fvcollapse", *words]
    done = subprocess.run(call, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_examples_of_a_checkout_are_its_own():
    assert {name: path.read_bytes() for name, path in shipped_files().items()} == DATA
    assert sum(name.name == "experiment.toml" for name in DATA) > 30


def test_they_are_written_once_and_never_over_something_else(tmp_path, capsys):
    assert main(["examples", str(tmp_path)]) == 0
    assert contents(tmp_path / "runs") == DATA
    assert f"{len(DATA)} files written" in capsys.readouterr().out
    assert main(["examples", str(tmp_path)]) == 0
    assert " 0 files written" in capsys.readouterr().out
    changed = tmp_path / "runs" / "collapse_22deg_w10cm.toml"
    changed.write_text("# mine\n", encoding="utf-8")
    gone = tmp_path / "runs" / "experiments" / "README.md"
    gone.unlink()
    assert main(["examples", str(tmp_path)]) == 2
    assert f"{changed}: file: found one that is already there" in capsys.readouterr().err
    assert changed.read_text(encoding="utf-8") == "# mine\n"
    assert not gone.exists()
    assert main(["examples", str(tmp_path), "--force"]) == 0
    assert contents(tmp_path / "runs") == DATA


def test_a_wheel_holds_them_and_no_program_of_the_studies(installed):
    assert contents(installed / "fvcollapse" / "examples") == DATA
    assert not list((installed / "fvcollapse" / "examples").rglob("*.py"))


def test_commands_of_the_readme_find_their_files_outside_a_checkout(installed, tmp_path):
    fvcollapse(installed, tmp_path, "examples")
    assert contents(tmp_path / "runs") == DATA
    case = "runs/collapse_22deg_w10cm.toml"
    assert "1 run" in fvcollapse(installed, tmp_path, "run", case, "--dry-run")
    folders = [f"runs/experiments/example_{name}" for name in ("16deg_w10cm", "22deg_w20cm")]
    held_out = ["--hold-out", folders[1], "--out", "out", "--dry-run"]
    assert "runs" in fvcollapse(installed, tmp_path, "diagnose", folders[0], *held_out)


def test_everything_that_is_not_python_is_in_the_wheel(installed):
    """Templates, texts, the verdict layer."""
    kept = {
        path.relative_to(ROOT)
        for path in (ROOT / "fvcollapse").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert kept <= {Path(path) for path in contents(installed)}


# -- who to cite, what Python ------------------------------------------------------------------------


def test_the_citation_is_of_this_version():
    from fvcollapse.version import __version__

    text = (ROOT / "fvcollapse" / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {__version__}\n" in text
    license_of_project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert f"\nlicense: {license_of_project['license']}\n" in text
