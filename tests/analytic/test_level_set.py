"""The free surface in a given velocity: area error and symmetric difference."""

import numpy as np
import pytest

from fvcollapse.step import level_set, redistancing
from fvcollapse.verification import exact
from fvcollapse.verification.flows import surface_errors, transport
from fvcollapse.verification.problems.surface import UPPER_DISC, disc_at, uniform


def nodes(cells):
    return np.meshgrid(*[np.arange(cells + 1) / cells] * 2, indexing="ij")


def test_translated_disc():
    phi = transport(disc_at(0.3, 0.3), uniform, 1.0, 64)
    area, difference = surface_errors(phi, disc_at(0.7, 0.6)(*nodes(64)))
    assert abs(area) < 2e-3
    assert difference < 5e-3


def test_single_vortex_and_back():
    phi = transport(UPPER_DISC, exact.single_vortex(2.0), 2.0, 64)
    area, difference = surface_errors(phi, UPPER_DISC(*nodes(64)))
    assert abs(area) < 0.03
    assert difference < 0.05


def test_restoring_the_distance_does_not_move_the_surface():
    """A disc given by a function that is no distance: phi = (r^2 - R^2) (1 + x)."""
    x, z = nodes(64)
    phi = ((x - 0.5) ** 2 + (z - 0.5) ** 2 - 0.2**2) * (1 + x)
    before = phi.copy()
    redistancing.reinitialise(phi, 24, 1 / 64, 1 / 64)
    area, difference = surface_errors(phi, before)
    assert abs(area) < 2e-3  # of the linear interpolation between the nodes, before and after
    assert difference < 2e-3
    near = np.abs(phi) < 3 / 64
    distance = exact.disc(x, z, 0.5, 0.5, 0.2)
    assert np.abs(phi - distance)[near].max() < 0.03 / 64


@pytest.mark.parametrize("shift", [-0.02, 0.02])
def test_restoring_reaches_what_lay_deep_inside(shift):
    """A level surface has come down five cells; what is deep inside holds the clamp, shifted by the volume's."""
    h = 1 / 40
    z = np.tile(np.arange(41) * h, (12, 1))
    clamp = (level_set.BAND + 2.0) * h
    phi = np.where(z > 18.5 * h, np.minimum(z - 20 * h, clamp), -clamp) + shift * h
    redistancing.reinitialise(phi, redistancing.SWEEPS, h, h)
    near = np.abs(z - 20 * h) < 3 * h
    np.testing.assert_allclose(phi[near], (z - 20 * h + shift * h)[near], atol=1e-3 * h)


def test_slotted_disc_is_a_distance():
    x, z = nodes(400)
    phi = exact.slotted_disc(x, z)
    gx, gz = np.gradient(phi, 1 / 400)
    close = np.abs(np.hypot(gx, gz) - 1) < 0.05
    assert close.mean() > 0.97
    area = np.pi * 0.15**2 - 0.05 * 0.25
    assert surface_errors(phi, phi)[0] == 0.0
    assert (phi < 0).mean() == pytest.approx(area, rel=0.02)


@pytest.mark.slow
def test_zalesak_disc():
    phi = transport(exact.slotted_disc, exact.rotation, 1.0, 100)
    area, difference = surface_errors(phi, exact.slotted_disc(*nodes(100)))
    assert abs(area) < 0.02
    assert difference < 0.08


@pytest.mark.slow
def test_single_vortex_of_eight_seconds():
    """Filaments thinner than a cell are lost; a prototype had area -8 %, difference 0.7."""
    phi = transport(UPPER_DISC, exact.single_vortex(8.0), 8.0, 128)
    area, difference = surface_errors(phi, UPPER_DISC(*nodes(128)))
    assert abs(area) < 0.35
    assert difference < 0.75
