"""Behind a gate that has just begun to rise the sweeps stall; shorter steps would not help them."""

import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.advance import STAGES, change_of
from fvcollapse.step.constants import constants_of
from fvcollapse.step.coupled import Outcome


@pytest.mark.parametrize("limit", [0.1, 1.0])  # s; divides the time into slightly different steps
def test_steps_are_not_cut_while_the_slot_is_narrow(limit):
    """On 3 mm cells they fell to 2 microseconds: half of the whole run went into its first 3 ms."""
    case = Case().replace(
        **{
            "geometry.slope_angle_deg": 22.0,
            "grid.cell_size": 0.003,
            "effects.lateral_friction": {},
        }
    )
    tries = []
    counted = STAGES._replace(solve=lambda *a: tries.append(a) or STAGES.solve(*a))
    simulation = Simulation(case, stages=counted)
    records = []
    while simulation.state.time < 3.4e-3:
        records.append(simulation.advance(limit))
    assert len(tries) == len(records)
    assert any(record.capped for record in records)  # they do stall
    assert min(record.dt for record in records) > 1e-4
    assert simulation.max_speed() < 0.02


def test_a_change_is_judged_by_the_speed_of_the_solution():
    """Of slow grains a tenth of 0.12 m/s may change, of fast ones a tenth of their own speed."""
    case = Case()

    def judged(change, speed):
        relative = change / max(speed, 0.0117)
        outcome = Outcome(30, relative, speed, 0.0, 0.0, 0, False)
        return change_of.py_func(outcome, constants_of(case))

    assert judged(0.01, 0.02) == pytest.approx(0.01 / 0.117, rel=2e-3)
    assert judged(0.5, 2.0) == pytest.approx(0.25)
    assert not judged(float("nan"), 1.0) <= 0.1
