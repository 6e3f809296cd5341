"""Bad arguments and files are refused before the compiler is loaded, and leave nothing behind."""

import json
import os
import subprocess
import sys

import pytest

EXPERIMENT = "runs/experiments/example_16deg_w10cm"
CASE = "runs/collapse_22deg_w10cm.toml"
COMMANDS = {  # words of the command, and a part of the message
    "run": (["run", CASE, "--set", "grid.nope=1"], "grid.nope"),
    "run from": (["run", CASE, "--from", "nothere"], "nothere"),
    "sweep": (["sweep", CASE, "--vary", "grid.nope=1,2", "--out", "OUT"], "grid.nope"),
    "converge": (["converge", CASE, "--cell-size", "0.02", "--out", "OUT"], "three values"),
    "compare": (["compare", "a", "b", "--out", "OUT"], "a: file"),
    "compare with no result": (
        ["compare", "README.md", EXPERIMENT, "--out", "OUT"],
        "README.md: file",
    ),
    "plot": (["plot", "nothere", "--out", "OUT"], "nothere"),
    "diagnose": (["diagnose", "nothere", "--out", "OUT"], "nothere/experiment.toml"),
    "diagnose held out": (["diagnose", EXPERIMENT, "--hold-out", "b", "--out", "OUT"], "b/exp"),
    "diagnose case": (["diagnose", EXPERIMENT, "--case", "no.toml", "--out", "OUT"], "no.toml"),
    "diagnose effects": (["diagnose", EXPERIMENT, "--effects", "nope", "--out", "OUT"], "'nope'"),
    "diagnose each": (["diagnose", EXPERIMENT, "b", "--each", "--out", "OUT"], "b/exp"),
    "dry run": (["diagnose", EXPERIMENT, "--dry-run", "--out", CASE], "a file, where a folder"),
    "dry sweep": (
        ["sweep", CASE, "--vary", "time.end=1", "--dry-run", "--out", CASE],
        "a file, where",
    ),
    "verify": (["verify", "nope", "--json", "OUT"], "a verification problem"),
    "bench": (["bench", "nope"], "22deg_w10cm_6mm"),
    "blind score": (["blind", "score", ".", "no.json", "--labels", "c.json"], "c.json: file"),
    "blind make": (["blind", "make", "--cases", "0", "--out", "OUT"], "1 to 100000"),
    "workers": (["blind", "make", "--cases", "1", "--workers", "0", "--out", "OUT"], ">= 1"),
    "import-curves": (
        ["import-curves", "--front", "a.csv", "--profile", "0.1=b.csv", "--out", "OUT"],
        "a.csv, b.csv: file",
    ),
    "no arguments": (["run"], "CASE.toml"),
}
PROGRAM = """
import contextlib, io, json, sys
from fvcollapse.commands.command_line import outcome
answers = {}
for name, words in json.load(sys.stdin).items():
    with contextlib.redirect_stderr(io.StringIO()) as told, contextlib.redirect_stdout(io.StringIO()):
        status = outcome(words)
    answers[name] = status, told.getvalue(), sorted({"numba", "matplotlib"} & set(sys.modules))
json.dump(answers, sys.stdout)
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """{name: (exit status, what stands on stderr, heavy modules that are loaded by then)}, and the folder."""
    folder = tmp_path_factory.mktemp("refused")
    words = {
        name: [str(folder / "out") if word == "OUT" else word for word in words]
        for name, (words, _) in COMMANDS.items()
    }
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        input=json.dumps(words),
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), folder


@pytest.mark.parametrize("name", COMMANDS)
def test_bad_input_is_refused_before_the_compiler_is_loaded(answers, name):
    status, told, loaded = answers[0][name]
    assert status == 2
    assert told.count("\n") == 1
    assert COMMANDS[name][1] in told
    assert loaded == []


def test_refused_commands_leave_no_folder(answers):
    assert list(answers[1].iterdir()) == []
