"""Two processes compile the kernels of a step together, of the types that a step gives them."""

import subprocess
import sys

import pytest
from numba import typeof

from fvcollapse import run
from fvcollapse.case.case import Case
from fvcollapse.output import compilation, second_half
from fvcollapse.step.advance import COMPILED, balance_of
from fvcollapse.step.flow import packing_of
from fvcollapse.step.guards import broken_law

EFFECTS = [{}, {"effects.thin_layer.length": 1.0}]
COARSE = {"grid.cell_size": 0.02, "time.end": 0.02}


@pytest.fixture(params=EFFECTS, ids=["plain", "with an effect on the grains"])
def case(request):
    return Case().replace(**COARSE, **request.param)


def test_the_second_half_has_the_types_that_a_step_gives_it(case):
    """A kernel compiled for other types would stand in the index beside that of the step."""
    run(case)
    flow, watch = second_half.simulation_types(case)
    assert second_half.is_kept(flow)
    second_half.compile_second_half(flow, watch)
    stages = COMPILED._asdict()
    both = {"place", "solve"}  # the first half
    inner = (broken_law, balance_of, packing_of)
    for kernel in (*(stages[name] for name in stages.keys() - both), *inner):
        kept = kernel._cache._cache_file._load_index()
        of_flow = [types for types, _, kind in kept if flow in types and not kind]
        assert len(of_flow) == 1, kernel.py_func.__name__


def test_the_process_beside_compiles_what_is_asked(case):
    """Here it finds all of it on the disk."""
    run(case)
    command = [sys.executable, "-m", "fvcollapse.output.second_half", case.to_toml()]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.wait(300) == 0, process.stderr.read()


def test_the_process_beside_ends_with_the_one_that_started_it(case):
    command = [sys.executable, "-m", "fvcollapse.output.second_half", case.to_toml()]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, check=False)
    assert done.returncode == 1


def test_types_depend_on_the_effects_alone(case):
    other = case.replace(**{"grid.cell_size": 0.01, "geometry.slope_angle_deg": 3.0})
    assert second_half.simulation_types(case) == second_half.simulation_types(other)


def test_a_flow_without_its_march_is_not_kept():
    assert not second_half.is_kept(typeof(1.0))


@pytest.mark.parametrize(
    ("half", "kept", "done"),
    [
        (None, False, ["another process"]),
        (None, True, []),
        ("first", False, []),
        ("second", False, ["this process"]),
        ("second", True, []),
    ],
)
def test_each_process_compiles_its_half(half, kept, done, case, monkeypatch):
    actions = []
    monkeypatch.setattr(second_half, "is_kept", lambda flow: kept)
    monkeypatch.setattr(
        second_half, "compile_second_half", lambda *types: actions.append("this process")
    )
    monkeypatch.setattr(
        compilation, "start_second_half", lambda case: actions.append("another process")
    )
    monkeypatch.setattr(compilation, "cores", lambda: 2)
    monkeypatch.delenv(compilation.HALF, raising=False)
    if half is not None:
        monkeypatch.setenv(compilation.HALF, half)
    compilation.share_compilation(case)
    assert actions == done


@pytest.mark.parametrize("program", ["/no/such/python", "", None])
def test_a_process_that_cannot_start_does_no_harm(program, case, monkeypatch):
    kept = []
    monkeypatch.setattr(compilation.atexit, "register", kept.append)
    monkeypatch.setattr(compilation.sys, "executable", program)
    compilation.start_second_half(case)
    assert not kept


def test_what_goes_wrong_beside_a_run_is_no_failure_of_it(case, monkeypatch):
    def fail(case):
        raise MemoryError

    monkeypatch.setattr(compilation, "share_compilation", fail)
    monkeypatch.setattr(compilation, "PREPARED", set())
    assert run(case).complete
