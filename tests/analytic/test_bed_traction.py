"""A layer that slides on its bed feels mu_b p, however few cells it is thick.

The traction is measured as the gain of mean velocity: du/dt = g cos a (tan a - mu_b).
"""

import math

import pytest

from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until

CELL = 0.005
DURATION = 0.05
THICKNESSES = pytest.mark.parametrize("cells", [4.0, 2.0, 1.0, 3.7, 1.4, 0.6])


def acceleration(case, velocity, cells, slip):
    flow = layer(case, velocity, dt=1e-3, depth=cells * CELL, slip=slip)
    before = flow.mean_velocity()
    return (run_until(flow, DURATION).mean_velocity() - before) / DURATION


@THICKNESSES
@pytest.mark.parametrize("mu_bed", [0.30, 0.44])
def test_plug(cells, mu_bed):
    case = layer_case(
        CELL, 4 * CELL, boundary__mu_bed=mu_bed, rheology__mu_1=0.9, rheology__mu_2=0.9
    )
    found = acceleration(case, lambda z: 1.0 + 0.0 * z, cells, 1.0)
    assert found == pytest.approx(exact.block_acceleration(case), rel=0.01)


@THICKNESSES
@pytest.mark.parametrize("mu_1", [0.30, 0.48])
def test_sheared_layer_with_the_same_friction_as_the_bed(cells, mu_1):
    case = layer_case(CELL, 4 * CELL, boundary__mu_bed=mu_1, rheology__mu_1=mu_1)
    found = acceleration(case, lambda z: 1.0 + 20.0 * z, cells, 1.0)
    assert found == pytest.approx(exact.block_acceleration(case), rel=0.01)


@THICKNESSES
def test_traction_is_the_same_upslope(cells):
    """A block thrown uphill is braked by weight and bed together."""
    case = layer_case(CELL, 4 * CELL, boundary__mu_bed=0.3, rheology__mu_1=0.9, rheology__mu_2=0.9)
    found = acceleration(case, lambda z: -1.0 + 0.0 * z, cells, -1.0)
    drive = exact.gravity_normal(case) * (exact.slope_ratio(case) + 0.3)
    assert found == pytest.approx(drive, rel=0.01)


def test_rough_bed_never_slips():
    case = layer_case(CELL, 4 * CELL, boundary__mu_bed=math.inf, rheology__mu_1=0.3)
    flow = run_until(layer(case, lambda z: 20.0 * z, dt=1e-3), 0.01)
    assert (flow.state.bed_slip == 0.0).all()


def test_smooth_bed_has_no_traction():
    case = layer_case(CELL, 4 * CELL, boundary__mu_bed=0.0)
    found = acceleration(case, lambda z: 1.0 + 0.0 * z, 4.0, 1.0)
    assert found == pytest.approx(exact.block_acceleration(case), rel=1e-6)
