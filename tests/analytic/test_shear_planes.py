"""Shear stress in the rows that the surface cuts: a layer flows alike wherever its surface lies between two rows."""

import numpy as np
import pytest

from fvcollapse.step.compiled import from_python
from fvcollapse.step.geometry import allocate_geometry
from fvcollapse.step.initial import HALO
from fvcollapse.step.placement import fill_geometry
from fvcollapse.step.shear_planes import pressure_on_plane
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until_steady
from fvcollapse.verification.problems.steady import GLASS, SLOPE

CELL = 0.006  # m
ROWS = 5  # that are full
PARTS = (0.06, 0.2, 0.35, 0.5, 0.8)  # of the row above them
CHUTE = {
    **SLOPE,
    **GLASS,
    "geometry__slope_angle_deg": 26.0,
    "geometry__channel_width": 0.10,
    "effects__lateral_friction": {},
}
ON_PLANE = from_python(pressure_on_plane)


@pytest.mark.parametrize("part", PARTS)
def test_the_discharge_of_a_layer_does_not_depend_on_where_its_surface_cuts_a_row(part):
    depth = (ROWS + part) * CELL
    case = layer_case(CELL, depth, **CHUTE)
    velocity = exact.chute_regularised(case)
    flow = run_until_steady(layer(case, lambda z: velocity(np.minimum(z, depth)), dt=10.0))
    z = np.linspace(0.0, depth, 4001)
    expected = np.trapezoid(velocity(z), z)
    discharge = flow.geometry.mass_x[HALO] @ flow.state.u[HALO] * CELL
    assert discharge == pytest.approx(expected, rel=2.5e-3)  # the mean of four cells: 1.5 % too low


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("part", PARTS)
def test_the_plane_below_a_cut_row_carries_the_weight_above_it(part, upright):
    cells = 6
    nodes = np.arange(cells + 1.0)
    level_set = np.repeat((nodes - 3.0 - part)[None, :], cells + 1, axis=0)
    level_set = np.ascontiguousarray(level_set.T) if upright else level_set
    geometry = allocate_geometry(cells, cells)
    fill_geometry(geometry, level_set, np.ones((cells, cells)), -1, False)
    low = np.clip(3.0 + part - nodes[:-1], 0.0, None)  # depth of the lower side of each row
    high = np.clip(3.0 + part - nodes[1:], 0.0, None)
    column = 0.5 * (low**2 - high**2)  # the integral of the pressure over each cell
    pressure = np.repeat(column[None, :], cells, axis=0)
    pressure = np.ascontiguousarray(pressure.T) if upright else pressure
    at = (3, 2) if upright else (2, 3)
    assert geometry.plane[at] == pytest.approx(1.0)
    assert ON_PLANE(pressure, geometry, *at) == pytest.approx(part, rel=1e-12)
    deep = (2, 2)
    assert geometry.plane[deep] == 1.0
    assert ON_PLANE(pressure, geometry, *deep) == pytest.approx(1.0 + part, rel=1e-12)
