"""Rows of the grid that the grains have left are given up: less memory to pass, the same collapse."""

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.measure.pile import thickness
from fvcollapse.simulation import Simulation
from fvcollapse.step.advance import STAGES
from fvcollapse.step.domain import make_room

END = 1.0  # s; the pile is then a third as high as the column


def collapse(stages=STAGES):
    case = Case().replace(
        **{
            "geometry.slope_angle_deg": 22.0,
            "grid.cell_size": 0.012,
            "effects.lateral_friction": {},
        }
    )
    found = Simulation(case, stages=stages)
    fastest = 0.0
    while found.state.time < END:
        found.advance(END)
        fastest = max(fastest, found.max_speed())
    return found, fastest


@pytest.fixture(scope="module")
def whole():
    """The collapse on a grid that keeps all its rows."""
    return collapse(STAGES._replace(room_needed=keep_all))


def keep_all(flow):
    return STAGES.room_needed(flow)._replace(keep=0)


def test_the_collapse_is_the_same_on_fewer_rows(whole):
    (cropped, fastest), (reference, fastest_of_all) = collapse(), whole
    assert cropped.grid.nz < reference.grid.nz
    assert fastest == pytest.approx(fastest_of_all, rel=1e-7)
    heights = [thickness(each.state.level_set, each.spacing[1]) for each in (cropped, reference)]
    np.testing.assert_allclose(*heights, rtol=0.0, atol=1e-7 * reference.case.geometry.height_0)


def test_grains_that_rise_again_get_new_rows():
    grown, _ = collapse()
    rows = grown.grid.nz
    phi = grown.state.level_set
    phi[:, 8:] = phi[:, :-8].copy()  # the pile, eight rows higher
    phi[:, :8] = phi[:, 8:9]
    grown.place()
    make_room(grown, STAGES.room_needed(grown.flow()))
    assert grown.grid.nz > rows
    assert np.all(grown.state.level_set[:, -1] > 0.0)
