"""Errors are one line, survive a process pool, and decide the exit status."""

import pickle

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.commands import keys
from fvcollapse.commands.command_line import main
from fvcollapse.errors import (
    CaseError,
    FvcollapseError,
    InputError,
    NumericalError,
    OutputError,
)
from fvcollapse.output.run_log import run_log
from fvcollapse.simulation import Simulation
from fvcollapse.step.advance import STAGES

ERRORS = [
    (CaseError("a.toml", "grid.cell_size", "-1", "> 0"), 2),
    (NumericalError("no convergence\nafter 5 halvings", "at x = 0.3 m", 0.125), 1),
    (NumericalError("the domain is full"), 1),
    (OutputError("out/result.h5", OSError(28, "No space left on device"), running=True), 1),
    (OutputError("out", "not a folder"), 2),
]


@pytest.mark.parametrize(("error", "status"), ERRORS)
def test_error_is_one_line_and_sets_the_exit_status(error, status, monkeypatch, capsys):
    def fail(arguments):
        raise error

    monkeypatch.setattr(keys, "execute", fail)
    assert main(["keys"]) == status
    assert capsys.readouterr().err == f"{error}\n"
    assert "\n" not in str(error)


@pytest.mark.parametrize(("error", "status"), ERRORS)
def test_error_survives_a_process_pool(error, status):
    copy = pickle.loads(pickle.dumps(error))
    assert isinstance(copy, FvcollapseError)
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert copy.exit_status == status


def test_numerical_error_says_what_where_and_when():
    message = str(NumericalError("negative volume", "at x = 0.3 m", 0.125))
    assert message == "negative volume, at x = 0.3 m, at t = 0.125 s"


def test_interruption_is_130(monkeypatch, capsys):
    def interrupt(arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(keys, "execute", interrupt)
    assert main(["keys"]) == 130
    assert capsys.readouterr().err == "interrupted\n"


def test_a_folder_takes_one_run_at_a_time(tmp_path):
    with run_log(tmp_path), pytest.raises(InputError, match="another run"), run_log(tmp_path):
        pass
    with run_log(tmp_path):  # free again
        pass


def test_arithmetic_errors_of_kernels_are_named():
    def divide(*_):
        raise ZeroDivisionError("division by zero")

    case = Case().replace(**{"grid.cell_size": 0.03})
    simulation = Simulation(case, stages=STAGES._replace(move_surface=divide))
    before = simulation.state
    with pytest.raises(NumericalError, match=r"division by zero.*t = 0"):
        simulation.advance(1.0)
    assert np.array_equal(simulation.state.level_set, before.level_set)
