"""Which velocities are trusted, and how they are continued beyond the surface."""

import numpy as np
import pytest

from fvcollapse.step.extrapolation import extrapolate, mark_known
from fvcollapse.step.geometry import allocate_geometry


def known_w(mass, constrained):
    """Mark of the z-face between a full cell and a nearly empty one with this face mass."""
    geometry = allocate_geometry(4, 4)
    geometry.filled[:, 0] = 1.0
    geometry.index_u[:], geometry.index_w[:] = 0, 0
    geometry.mass_x[:], geometry.mass_z[:] = 1.0, mass
    cells = np.zeros((4, 4), np.bool_)
    cells[2, 1] = constrained
    marks = np.empty((5, 4), np.int64), np.empty((4, 5), np.int64)
    mark_known(*marks, geometry, cells, 0.0, 0.01, False)
    return marks[1][2, 1]


@pytest.mark.parametrize(
    ("mass", "constrained", "trusted"),
    [(0.01, True, 1), (0.01, False, 0), (0.5, False, 1), (1e-5, True, 0)],
)
def test_nearly_empty_face_is_trusted_only_where_the_mass_is_incompressible(
    mass, constrained, trusted
):
    """A cell that is free to open says nothing of w: trusted there, it fed on itself to 50 m/s at a nose."""
    assert known_w(mass, constrained) == trusted


def test_linear_field_is_continued_linearly_then_by_means():
    field, known = np.tile(np.arange(8.0), (5, 1)), np.zeros((5, 8), np.int64)
    known[:, :4] = 1
    extrapolate(field, known, 2)
    np.testing.assert_allclose(field[:, 4], 4.0)
    np.testing.assert_allclose(field[:, 5], 4.0)
    np.testing.assert_array_equal(field[:, 6:], 0.0)
    assert known.max() == 3
