"""Behind a gate that has just begun to rise the sweeps stall; shorter steps would not help them."""

import itertools

from fvcollapse.case import Case
from fvcollapse.simulation import Simulation


def test_steps_are_not_cut_while_the_slot_is_narrow():
    """On 3 mm cells they fell to 2 microseconds: half of the whole run went into its first 3 ms."""
    case = Case().replace(
        **{
            "geometry.slope_angle_deg": 22.0,
            "grid.cell_size": 0.003,
            "effects.lateral_friction": {},
        }
    )
    simulation = Simulation(case)
    records = [simulation.advance(1.0) for _ in range(14)]
    steps = [record.dt for record in records]
    assert any(record.capped for record in records)  # they do stall
    assert all(late >= early for early, late in itertools.pairwise(steps))
    assert simulation.max_speed() < 0.02
