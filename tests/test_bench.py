"""The benchmark measures the run it claims to measure, and changes nothing in it."""

import json

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import PHYSICAL
from fvcollapse.errors import InputError
from fvcollapse.simulation import Simulation
from fvcollapse.studies import bench
from fvcollapse.studies.bench import case_list, measured, report

CASE = Case().replace(
    **{
        "grid.cell_size": 0.02,
        "time.end": 0.02,
        "time.step_max": 5e-4,
        "effects.lateral_friction": {},
    }
)


def run(kind):
    simulation = kind(CASE)
    while simulation.state.time < CASE.time.end:
        simulation.advance(CASE.time.end)
    return simulation


def test_a_timed_run_is_the_run():
    """Bit for bit, with the parts of the sweep timed in its midst."""
    timed, plain = run(measured.TimedSimulation), run(Simulation)
    assert timed.steps == plain.state.step
    assert len(timed.sweep_parts) >= measured.SAMPLES - 1
    for name in ("level_set", "u", "w", "pressure_filled"):
        assert np.array_equal(getattr(timed.state, name), getattr(plain.state, name))


def test_figures_add_up():
    """Shares sum to one; no part of a sweep beats the bound of its memory traffic a hundred times over."""
    row = measured.figures(run(measured.TimedSimulation), 1.0)
    assert sum(row["share"].values()) == pytest.approx(1.0)
    assert all(value > 0.0 for value in row["sweep_s"].values())
    assert 0.0 < row["bound_sweep_s"] < sum(row["sweep_s"].values())
    assert row["bound_s"] == pytest.approx(row["bound_sweep_s"] * row["sweeps"], rel=0.5)
    assert row["sweeps"] >= row["steps"] > 0
    assert row["memory_mb"] > 10.0


def test_bandwidth_is_that_of_some_machine():
    assert 1e8 < measured.bandwidth(1e6) < 1e13


def test_unknown_case_is_refused():
    with pytest.raises(InputError, match="22deg_w10cm_6mm"):
        bench.run_bench(["22deg"])
    with pytest.raises(InputError, match="erodible_bed"):
        bench.run_bench(["22deg_w10cm_6mm"], effects=True)
    with pytest.raises(InputError, match="--end"):
        bench.run_bench(end=0.0)


def test_effects_are_compared_with_the_case_without(monkeypatch, tmp_path):
    """Loops of 2 s, and 3 s with a gate that rubs: 1.5."""

    def run_member(case):
        gate = case.effects.gate
        row = measured.figures(made, 2.0 if gate is None else 3.0) | {"command_s": 4.0}
        return row | {"end": case.time.end}

    made = run(measured.TimedSimulation)
    monkeypatch.setattr(bench, "run_member", run_member)
    report = bench.run_bench(["gate"], tmp_path / "bench.json", quiet=True, effects=True)
    found = {row["name"]: row["cost_factor"] for row in report["cases"]}
    assert found == {case_list.NO_EFFECT: 1.0, "gate": 1.5}
    assert all(row["end"] == 2.0 for row in report["cases"])
    assert json.loads((tmp_path / "bench.json").read_text())["cases"] == report["cases"]
    assert bench.table(report).splitlines()[0].endswith("cost factor")


def test_every_effect_that_changes_the_flow_has_a_cost():
    found = case_list.effect_cases()
    flowing = [name for name, effect in CATALOGUE.items() if effect.kind == PHYSICAL]
    assert list(found)[: len(flowing) + 1] == [case_list.NO_EFFECT, *flowing]
    for name in flowing:
        assert getattr(found[name].effects, name) is not None


def test_thin_layers_are_compared_on_the_bed_that_they_lie_on(monkeypatch):
    """Loops of 2 s on a bed that slips, 4 s on a rough one, a half more with a layer: 1.5 on both."""

    def run_member(case):
        wall = 2.0 if np.isfinite(case.boundary.mu_bed) else 4.0
        layer = case.effects.thin_layer
        return measured.figures(made, wall if layer is None else 1.5 * wall)

    made = run(measured.TimedSimulation)
    monkeypatch.setattr(bench, "run_member", run_member)
    names = ["thin_layer", "thin_layer_nonlocal", "thin_layer_rough", "thin_layer_nonlocal_rough"]
    rows = bench.run_bench(names, quiet=True, effects=True)["cases"]
    factors = {row["name"]: row["cost_factor"] for row in rows}
    without = {"no_effect": 1.0, "no_effect_rough": 1.0}
    assert factors == without | dict.fromkeys(names, 1.5)
    closures = [case_list.effect_cases()[name].effects.thin_layer.closure for name in names]
    assert closures == ["thickness", "nonlocal"] * 2


def test_growth_is_the_exponent_of_the_cost():
    """Cost per cell and step ~ 1/h is exponent 1; a single grid has none, and 12 mm does not count."""
    rows = [
        {"name": f"a_{h}mm", "cell_size": 1e-3 * h, "us_per_cell_and_step": 12.0 / h}
        for h in (12, 6, 3)
    ]
    found = report.growth([*rows, {**rows[0], "name": "b_12mm"}])
    assert set(found) == {"a"}
    assert found["a"]["exponent"] == pytest.approx(1.0)
    assert found["a"]["ratio"] == pytest.approx(2.0)
