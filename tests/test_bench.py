"""The benchmark measures the run it claims to measure, and changes nothing in it."""

import numpy as np
import pytest

from fvcollapse import bench
from fvcollapse.case import Case
from fvcollapse.errors import InputError
from fvcollapse.simulation import Simulation

CASE = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.02, "effects.lateral_friction": {}})


def run(kind):
    simulation = kind(CASE)
    while simulation.state.time < CASE.time.end:
        simulation.advance(CASE.time.end)
    return simulation


def test_a_timed_run_is_the_run():
    """Bit for bit, with the parts of the sweep timed in its midst."""
    timed, plain = run(bench.TimedSimulation), run(Simulation)
    assert timed.steps == plain.state.step
    assert len(timed.sweep_parts) >= bench.SAMPLES - 1
    for name in ("level_set", "u", "w", "pressure_filled"):
        assert np.array_equal(getattr(timed.state, name), getattr(plain.state, name))


def test_figures_add_up():
    """Shares sum to one; no part of a sweep beats the bound of its memory traffic a hundred times over."""
    row = bench.figures(run(bench.TimedSimulation))
    assert sum(row["share"].values()) == pytest.approx(1.0)
    assert all(value > 0.0 for value in row["sweep_s"].values())
    assert 0.0 < row["bound_sweep_s"] < sum(row["sweep_s"].values())
    assert row["bound_s"] == pytest.approx(row["bound_sweep_s"] * row["sweeps"], rel=0.5)
    assert row["sweeps"] >= row["steps"] > 0
    assert row["memory_mb"] > 10.0


def test_bandwidth_is_that_of_some_machine():
    assert 1e8 < bench.bandwidth(1e6) < 1e13


def test_unknown_case_is_refused():
    with pytest.raises(InputError, match="22deg_w10cm_6mm"):
        bench.run_bench(["22deg"])
