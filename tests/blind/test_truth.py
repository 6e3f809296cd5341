"""Truths are runs of the solver; a force of no strength leaves them as they are."""

import numpy as np

from fvcollapse.blind.truth import run_truth
from fvcollapse.case.case import Case

CASE = Case().replace(
    **{
        "geometry.slope_angle_deg": 10.0,
        "grid.cell_size": 0.02,
        "gate.speed": float("inf"),
        "time.end": 0.25,
        "time.output_interval": 0.05,
    }
)


def front(rate):
    forces = [] if rate is None else [{"kind": "linear_drag", "rate": rate}]
    return run_truth(CASE, forces).runout


def test_a_force_of_no_strength_changes_no_bit():
    assert np.array_equal(front(None), front(0.0))


def test_drag_holds_the_grains_back():
    free, held = front(0.0)[-1], front(4.0)[-1]
    start = CASE.geometry.length_0
    assert 0.5 < (held - start) / (free - start) < 0.95
