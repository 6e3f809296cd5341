"""No path of the diagnosis can read labels: it does not know the code that can, nor opens their files."""

import ast
import builtins
import io
import os
import sys
from pathlib import Path

import pytest
from blind_suite import make_wedges
from parsed_code import PACKAGE, files_in, tree_of

from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.measure.experiment import load_experiment

MODULES = [path for path in files_in("fvcollapse") if path.parent.name != "blind"]
# what the commands know of the blind package: how to make and score, nothing of a suite
COMMANDS = {
    PACKAGE / "commands" / "blind_make.py": {"make", "seal"},
    PACKAGE / "commands" / "blind_score.py": {"score", "score_table"},
}


def named_modules(path):
    """All module names in the imports of a file, and all its strings (for import_module)."""
    names = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names.add(node.value)
    return names


def test_only_the_command_line_knows_the_blind_package():
    assert len(MODULES) > 300
    known = {}
    for path in MODULES:
        for name in (name for name in named_modules(path) if "fvcollapse.blind" in name):
            module = name.removeprefix("fvcollapse.blind.").partition(".")[0]
            known.setdefault(path, set()).add(module)
    assert known == COMMANDS


def test_the_diagnosis_can_be_loaded_without_the_blind_package():
    """All its modules together, in a process of their own."""
    import subprocess

    modules = [
        f"fvcollapse.diagnosis.{path.stem}" for path in MODULES if path.parent.name == "diagnosis"
    ]
    modules = [name for name in modules if not name.endswith("__init__")]
    program = f"import importlib, sys; [importlib.import_module(m) for m in {modules}]; "
    program += "sys.exit(any(name.startswith('fvcollapse.blind') for name in sys.modules))"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


@pytest.fixture
def opened(monkeypatch):
    """Paths of every file opened while the test runs."""
    paths, real = [], {"open": builtins.open, "os": os.open}

    def watch(kind):
        def opening(path, *arguments, **options):
            paths.append(os.fsdecode(path) if isinstance(path, str | bytes | Path) else str(path))
            return real[kind](path, *arguments, **options)

        return opening

    monkeypatch.setattr(builtins, "open", watch("open"))
    monkeypatch.setattr(io, "open", watch("open"))
    monkeypatch.setattr(os, "open", watch("os"))
    return paths


def test_reading_a_case_opens_its_own_files_only(tmp_path, monkeypatch, opened):
    make_wedges(monkeypatch, tmp_path / "suite")
    label = (tmp_path / "suite.labels.json").read_bytes()
    case = tmp_path / "suite" / "case_003"
    folders = sorted(path.parent for path in case.rglob("experiment.toml"))
    for folder in (case, *folders):  # a careless owner leaves the labels lying about
        (folder / "labels.json").write_bytes(label)
        (folder / "suite.labels.json").write_bytes(label)
    opened.clear()
    choose_points([load_experiment(folder) for folder in folders])
    inside = {Path(path) for path in opened if str(tmp_path) in path}
    expected = {"experiment.toml", "front.csv", "profiles.csv", "volume.csv", "interface.csv"}
    assert {path.name for path in inside} == expected
    assert {path.parent for path in inside} == set(folders)


def test_a_truth_in_an_experiment_changes_nothing(tmp_path, monkeypatch):
    make_wedges(monkeypatch, tmp_path / "suite")
    folder = next((tmp_path / "suite" / "case_003").glob("*/experiment.toml")).parent
    before = load_experiment(folder)
    settings = folder / "experiment.toml"
    settings.write_text(settings.read_text() + '\n[truth]\ncause = "gate"\nslope_angle_deg = 3\n')
    after = load_experiment(folder)
    assert after.settings == before.settings
    assert after.case() == before.case()
