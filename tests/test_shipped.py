"""The case and the experiments come with the package, in a wheel too: paths of the READMEs work outside a checkout."""

import os
import shutil
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
from fvcollapse.version import __version__

RUNS = ROOT / "runs"
MINORS = (11, 12, 13)  # of Python
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
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
def wheel(tmp_path_factory):
    """The wheel of this checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    (path,) = WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    return path


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A folder with the contents of the wheel, as pip unpacks it."""
    folder = tmp_path_factory.mktemp("site")
    with ZipFile(wheel) as file:
        file.extractall(folder)
    return folder


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
    text = (ROOT / "fvcollapse" / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {__version__}\n" in text
    assert f"\nlicense: {PROJECT['license']}\n" in text


def interpreter(minor):
    """A Python 3.<minor> of this machine that starts; None if there is none."""
    name = f"python3.{minor}"
    others = sorted(Path.home().glob(f".pyenv/versions/3.{minor}.*/bin/{name}"))
    for path in filter(None, (shutil.which(name), *map(str, others))):
        call = [path, "-c", f"import sys; sys.exit(sys.version_info[:2] != (3, {minor}))"]
        if subprocess.run(call, capture_output=True, check=False).returncode == 0:
            return path
    return None


def test_the_versions_that_are_stated_are_those_that_are_tested():
    stated = [line.rpartition(".")[2] for line in PROJECT["classifiers"] if ":: 3." in line]
    assert [int(minor) for minor in stated] == list(MINORS)
    assert PROJECT["requires-python"] == f">=3.{MINORS[0]}"


READ = """
import ast, sys, warnings
from importlib.util import find_spec
from pathlib import Path
warnings.simplefilter("error")
names = set()
for path in Path(sys.argv[1]).rglob("*.py"):
    for node in ast.walk(ast.parse(path.read_text("utf-8"), str(path))):
        names |= {alias.name for alias in node.names} if isinstance(node, ast.Import) else set()
        names |= {node.module} if isinstance(node, ast.ImportFrom) and not node.level else set()
names = {name.partition(".")[0] for name in names} & set(sys.argv[2].split())
lost = [name for name in sorted(names) if find_spec(name) is None]
sys.exit(f"no module {lost}" if lost or len(names) < 20 else 0)
"""


@pytest.mark.slow
@pytest.mark.parametrize("minor", [minor for minor in MINORS if minor != sys.version_info.minor])
def test_every_python_that_is_stated_reads_the_code(minor):
    """Its grammar, without a warning, and its standard library: what a newer one has lost is seen here at once."""
    python = interpreter(minor)
    if python is None:
        pytest.skip(f"no Python 3.{minor} here")
    library = " ".join(sys.stdlib_module_names - {"fcntl", "resource"})
    call = [python, "-c", READ, str(ROOT / "fvcollapse"), library]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("minor", MINORS)
def test_a_wheel_is_installed_and_runs(minor, wheel, tmp_path):
    """In a fresh environment of every Python that is stated, as far as this machine has it."""
    python = interpreter(minor)
    if python is None:
        pytest.skip(f"no Python 3.{minor} here")
    programs = tmp_path / ".venv" / "bin"
    case = ["runs/collapse_22deg_w10cm.toml", "--set", "grid.cell_size=0.03", "--set"]
    for call in (
        [python, "-m", "venv", ".venv"],
        [programs / "pip", "install", "--quiet", wheel],
        [programs / "fvcollapse", "examples"],
        [programs / "fvcollapse", "run", *case, "time.end=0.1", "--out", "out"],
        [programs / "fvcollapse", "plot", "out"],
    ):
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{call}\n{done.stdout}\n{done.stderr}"
    assert (tmp_path / "out" / "result.h5").is_file()
