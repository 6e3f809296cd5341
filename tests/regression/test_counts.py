"""What a run costs, in counts: steps, sweeps, halvings and calls from Python. Never in seconds.

Remake the stored counts with `python tests/regression/test_counts.py` from the folder of the checkout, after a change
that is meant to move them, and say in the commit what moved and why.
"""

import json
from pathlib import Path

import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation

STORED = Path(__file__).with_suffix(".json")
BASE = {
    "geometry.slope_angle_deg": 22.0,
    "geometry.channel_width": 0.1,
    "grid.cell_size": 0.012,
    "effects.lateral_friction": {},
}
CASES = {
    "released at once": {"gate.speed": float("inf")},
    "gate": {},
    "6 mm": {"grid.cell_size": 0.006, "gate.speed": float("inf")},
    "ensemble": {"time.step_max": 4e-3},
    "dilatancy": {"time.step_max": 4e-3, "effects.dilatancy": {"dilatancy_factor": 3.0}},
    "thin layers": {"time.step_max": 4e-3, "effects.thin_layer": {}},
    "thin layers, nonlocal": {"time.step_max": 4e-3, "effects.thin_layer": {"closure": "nonlocal"}},
}
END = 0.4
LANDING = 0.02  # s between two calls, as of the output


def case_of(name):
    """One of `CASES`."""
    return Case().replace(**(BASE | CASES[name]))


def counts_of(case):
    """Counts of a run to `END`."""
    simulation, calls, records = Simulation(case), 0, []
    while simulation.state.time < END - 1e-9:
        limit = LANDING * (round(simulation.state.time / LANDING) + 1)
        records += simulation.march(limit, 256).records
        calls += 1
    return {
        "steps": len(records),
        "sweeps": sum(record.sweeps for record in records),
        "capped": sum(record.capped for record in records),
        "calls": calls,
    }


def measure():
    """{case: its counts}."""
    return {name: counts_of(case_of(name)) for name in CASES}


@pytest.mark.parametrize("name", CASES)
def test_a_run_costs_no_more_than_it_did(name):
    """Steps and calls are exact, also on other processors; sweeps depend on round-off, by a few in a hundred."""
    stored, now = json.loads(STORED.read_text())[name], counts_of(case_of(name))
    assert now["steps"] == pytest.approx(stored["steps"], rel=0.02)
    assert now["calls"] == stored["calls"]
    assert now["sweeps"] == pytest.approx(stored["sweeps"], rel=0.05)
    assert now["capped"] <= stored["capped"] + 2


if __name__ == "__main__":
    STORED.write_text(json.dumps(measure(), indent=1) + "\n")
    print(STORED.read_text())
