"""Shear on the upright sides of the rows that the surface cuts, and the resting surface that it smooths."""

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.measure.pile import thickness
from fvcollapse.simulation import Simulation
from fvcollapse.step.geometry import allocate_geometry
from fvcollapse.step.placement import fill_geometry
from fvcollapse.step.side_shear import side_shear

FALL = 0.05  # of the surface over the rows
MEAN = 0.15  # m; length of the mean slope
THICK = 0.012  # m; the pile, without its tongue


def sloping(cells=60, rows=10, top=8.37):
    """Geometry of grains under a plane surface, and its height at each node, in rows."""
    height = top - FALL * np.arange(cells + 1.0)
    level_set = np.arange(rows + 1.0)[None, :] - height[:, None]
    geometry = allocate_geometry(cells, rows)
    fill_geometry(geometry, level_set, np.ones((cells, rows)), -1, False)
    return geometry, height


def forces(geometry, stress):
    """Vertical force on the z-faces of each column (nx,), of the nodes and of `side_shear`, in cells."""
    side = np.empty_like(geometry.mass_z)
    side_shear(side, stress, np.ones_like(stress), geometry, 1.0)
    return np.diff(stress[:, 1:], axis=0).sum(axis=1), side.sum(axis=1)


def test_the_vertical_force_on_a_column_is_that_of_the_shear_on_its_sides():
    """A stress that rises linearly with depth: its integral over each upright line, from half a row above the bed."""
    geometry, height = sloping()
    stress = np.maximum(height[:, None] - np.arange(geometry.plane.shape[1]), 0.0)
    nodes, side = forces(geometry, stress)
    exact = np.diff(0.5 * (height - 0.5) ** 2)
    inner = slice(1, -1)  # the walls at both ends have a friction of their own
    assert (
        np.abs(nodes - exact)[inner].max() > 0.45 * FALL
    )  # of what the exact force changes by in a row
    assert (nodes + side)[inner] == pytest.approx(exact[inner], abs=0.003 * FALL)


def test_a_surface_along_the_rows_has_no_such_force():
    geometry = allocate_geometry(8, 6)
    level_set = np.repeat((np.arange(7.0) - 4.3)[None, :], 9, axis=0)
    fill_geometry(geometry, level_set, np.ones((8, 6)), -1, False)
    stress = np.repeat(np.maximum(4.3 - np.arange(7.0), 0.0)[None, :], 9, axis=0)
    _, side = forces(geometry, stress)
    assert not side.any()


def roughness(h, dx):
    """Rms of the slope of a surface about its 15 cm mean, deg; without 5 cm at the back wall and the tongue."""
    slope = np.degrees(np.arctan(np.diff(h) / dx))
    half = round(0.5 * MEAN / dx)
    mean = np.convolve(slope, np.full(2 * half + 1, 1.0 / (2 * half + 1)), "valid")
    middle = np.arange(half, half + mean.size)
    thick = 0.5 * (h[1:] + h[:-1])[middle + half] > THICK
    inside = thick & ((middle + 0.5) * dx - 0.5 * MEAN >= 0.05)
    return np.sqrt(np.mean((slope[middle] - mean)[inside] ** 2))


def test_a_resting_surface_does_not_step_where_it_crosses_the_rows():
    """0.16 deg, and 0.29 deg if the shear on the sides is left out.

    Nothing in the grains has the length of a row over the slope of the surface (11 cm). What is left lies within a few
    cells of the crossings, and is less on finer cells (0.11 deg at 4 mm).
    """
    simulation = Simulation(
        Case().replace(
            **{
                "geometry.slope_angle_deg": 22.0,
                "geometry.channel_width": 0.1,
                "grid.cell_size": 0.006,
                "effects.lateral_friction": {},
            }
        )
    )
    while simulation.state.time < 1.8 - 1e-9:
        assert simulation.march(1.8, 512).problem is None
    h = thickness(simulation.state.level_set, simulation.grid.dz)
    assert roughness(h, simulation.grid.dx) <= 0.2
