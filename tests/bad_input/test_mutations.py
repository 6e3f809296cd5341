"""Thousands of wrong inputs from a fixed seed: accepted or refused in one line, in time, nothing impossible."""

import os
import shutil
import signal
import traceback
from contextlib import contextmanager

import numpy as np
import pytest
from mutated import seeds
from mutated.suites import SUITES

from fvcollapse.__main__ import main
from fvcollapse.errors import FvcollapseError, NumericalError
from fvcollapse.output import run as output

SEED = 16
COMMANDED = (
    "case",
    "override",
    "experiment",
    "digitised",
    "result",
    "checkpoint",
    "sealed",
    "begun",
)
LIMIT = 10.0  # s for one input


class TooLongError(BaseException):
    """An input that does not end."""


@contextmanager
def time_limit(seconds):
    """Raise `TooLongError` in what takes longer."""

    def stop(number, frame):
        raise TooLongError

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def faults(name, number, seed, folder):
    """(outcome, sentences) of one mutated input: accepted, refused, traceback, hang or impossible."""
    rng = np.random.default_rng([SEED, list(SUITES).index(name), number])
    suite = SUITES[name]
    given = suite.write(seed, rng, folder)
    try:
        with time_limit(LIMIT):
            found = suite.read(given)
    except FvcollapseError as error:
        return ("refused", []) if well_said(error) else ("unclear", [repr(error)])
    except TooLongError:
        return "hang", [f"longer than {LIMIT} s"]
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return "traceback", [f"{type(error).__name__}: {error!s:.80} ({place.name})"]
    return ("impossible", found) if found else ("accepted", [])


def well_said(error):
    """Whether an error is one line of text, and says that the input is bad."""
    words = str(error)
    printable = words.isprintable() and words.encode("utf-8", "replace").decode() == words
    return printable and error.exit_status == 2


def survey(name, count, seed, folder):
    """{outcome: [(number, sentences)]} of the first `count` inputs of a suite."""
    outcomes = {}
    for number in range(count):
        outcome, sentences = faults(name, number, seed, folder)
        outcomes.setdefault(outcome, []).append((number, sentences))
    return outcomes


@pytest.fixture(scope="module")
def seed(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)  # of thousands of small files
        yield seeds.make(tmp_path_factory.mktemp("seeds"))


def check(name, count, seed, folder):
    """No outcome but accepted and refused; both occur."""
    outcomes = survey(name, count, seed, folder)
    bad = {kind: outcomes[kind] for kind in outcomes.keys() - {"accepted", "refused"}}
    assert not bad
    assert "refused" in outcomes


@pytest.mark.parametrize("name", SUITES)
def test_mutated_inputs(name, seed, tmp_path):
    check(name, SUITES[name].short, seed, tmp_path)


def command_of(name, given, folder):
    """The command line that reads an input."""
    out = ["--out", str(folder / "out")]
    return {
        "case": lambda: ["run", str(given), "--quiet", *out],
        "override": lambda: ["run", str(folder / "empty.toml"), "--set", given, "--quiet", *out],
        "experiment": lambda: ["diagnose", str(given), *out],
        "digitised": lambda: ["import-curves", "--front", str(given), *out],
        "result": lambda: ["plot", str(given), *out],
        "checkpoint": lambda: [
            "run",
            str(folder / "case.toml"),
            "--resume",
            "--out",
            str(given[1]),
        ],
        "sealed": lambda: (
            ["blind", "score", str(given / "suite"), str(given / "answers.json")]
            + ["--labels", str(given / "suite.labels.json")]
        ),
        "begun": lambda: ["blind", "make", "--cases", "4", "--out", str(given / "begun")],
    }[name]()


@pytest.mark.parametrize("name", ["case", "override", "experiment", "digitised", "result"])
def test_sample_through_the_command_line(name, seed, tmp_path, monkeypatch, capsys):
    check_commands(name, 6, seed, tmp_path, monkeypatch, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDED)
def test_larger_sample_through_the_command_line(name, seed, tmp_path, monkeypatch, capsys):
    check_commands(name, 60, seed, tmp_path, monkeypatch, capsys)


def check_commands(name, count, seed, folder, monkeypatch, capsys):
    """Exit status 0, 1 or 2, and at most one line on stderr; what would compute fails by name."""

    def no_computation(*arguments, **options):
        raise NumericalError("not computed")

    monkeypatch.setattr(output, "Simulation", no_computation)
    monkeypatch.setattr("fvcollapse.diagnosis.diagnose.analyse", no_computation)
    monkeypatch.setattr("fvcollapse.blind.make.compute", no_computation)
    monkeypatch.setattr("fvcollapse.draw.pictures.animation", lambda result, look: b"")
    (folder / "empty.toml").write_text("")
    (folder / "case.toml").write_text(seed.case.to_toml())
    statuses = set()
    for number in range(count):
        rng = np.random.default_rng([SEED + 1, list(SUITES).index(name), number])
        shutil.rmtree(folder / "out", ignore_errors=True)
        arguments = command_of(name, SUITES[name].write(seed, rng, folder), folder)
        capsys.readouterr()
        with time_limit(3 * LIMIT):
            status = main(arguments)
        error = capsys.readouterr().err
        statuses.add(status)
        assert status in (0, 1, 2), (number, error)
        assert error.count("\n") <= (2 if name == "checkpoint" else 1), (number, error)
        assert error or status == 0
    assert 2 in statuses or name == "checkpoint"


@pytest.mark.slow
@pytest.mark.parametrize("name", SUITES)
def test_thousands_of_mutated_inputs(name, seed, tmp_path):
    check(name, SUITES[name].long, seed, tmp_path)
