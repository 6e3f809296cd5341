"""Momentum advection alone: uniform motion, conservation, and the order of a smooth flow."""

import numpy as np
import pytest

from fvcollapse.step import level_set
from fvcollapse.step.momentum import advect_momentum, control_masses, rows_in_reach
from fvcollapse.verification import exact


def blob(cells, x_centre=0.45, z_centre=0.5, radius=0.25):
    nodes = np.arange(cells + 1) / cells
    x, z = np.meshgrid(nodes, nodes, indexing="ij")
    return exact.disc(x, z, x_centre, z_centre, radius)


def advected(u, w, phi_old, phi_new, dt):
    h = 1.0 / w.shape[0]
    u_star, w_star = np.empty_like(u), np.empty_like(w)
    slip, aperture = np.zeros(u.shape[0]), np.ones_like(u)
    packing = np.ones((len(w), len(w)))
    advect_momentum(
        u_star, w_star, u, w, u, w, slip, aperture, phi_old, phi_new, packing, dt, h, h, 1.0, False
    )
    return u_star, w_star


def test_uniform_velocity_stays_uniform():
    cells, dt = 20, 0.02
    u, w = np.full((cells + 1, cells), 0.7), np.full((cells, cells + 1), -0.4)
    moved = blob(cells, 0.45 + 0.7 * dt, 0.5 - 0.4 * dt)
    u_star, w_star = advected(u, w, blob(cells), moved, dt)
    assert u_star == pytest.approx(0.7, abs=1e-13)
    assert w_star == pytest.approx(-0.4, abs=1e-13)


def solenoidal(cells):
    """u = sin(pi x) cos(pi z), w = -cos(pi x) sin(pi z) on the faces of the unit square."""
    nodes, centres = np.arange(cells + 1) / cells, (np.arange(cells) + 0.5) / cells
    return (
        np.sin(np.pi * nodes)[:, None] * np.cos(np.pi * centres),
        -np.cos(np.pi * centres)[:, None] * np.sin(np.pi * nodes),
    )


def test_momentum_is_conserved_inside_a_full_box():
    cells = 16
    phi = np.full((cells + 1, cells + 1), -1.0)
    u, w = solenoidal(cells)
    u_star, w_star = advected(u, w, phi, phi, 0.3 / cells)
    mass_u, mass_w = np.empty_like(u), np.empty_like(w)
    control_masses(mass_u, mass_w, phi, np.ones_like(phi), rows_in_reach(phi, phi))
    inner = (slice(1, -1), slice(None))
    gained = (mass_u * (u_star - u))[inner].sum()
    through_walls = (mass_u * u_star)[0].sum() + (mass_u * u_star)[-1].sum()
    assert gained + through_walls == pytest.approx(0.0, abs=1e-12)


def advection_error(cells):
    """Largest error of du/dt = -u . grad u, away from the walls."""
    phi = np.full((cells + 1, cells + 1), -1.0)
    u, w = solenoidal(cells)
    dt = 1e-5
    u_star, _ = advected(u, w, phi, phi, dt)
    nodes, centres = np.arange(cells + 1) / cells, (np.arange(cells) + 0.5) / cells
    x, _ = np.meshgrid(nodes, centres, indexing="ij")
    rate = -np.pi * np.sin(np.pi * x) * np.cos(np.pi * x)  # of this flow, at every height
    inner = slice(cells // 4, 3 * cells // 4)
    return np.abs((u_star - u) / dt - rate)[inner, inner].max()


def test_smooth_flow_is_second_order():
    errors = [advection_error(cells) for cells in (16, 32, 64)]
    order = np.polyfit(np.log([16, 32, 64]), np.log(errors), 1)[0]
    assert -order > 1.8


def test_a_linear_flow_leaves_through_the_end_as_it_flows_inside():
    """Rate of u = x, w = -z in a full box: -u u_x = -x and -w w_z = -z, at the open end too."""
    cells, dt = 20, 1e-4
    phi = np.full((cells + 1, cells + 1), -1.0)
    nodes, centres = np.arange(cells + 1) / cells, (np.arange(cells) + 0.5) / cells
    u = np.tile(1.0 + nodes[:, None], (1, cells))
    w = np.tile(-nodes, (cells, 1)) + centres[:, None]
    u_star, w_star = advected(u, w, phi, phi, dt)
    # the last face owns half a control volume: first order, a quarter of a cell of u = 2
    assert ((u_star - u) / dt)[1:] == pytest.approx(-u[1:], rel=0.25 / cells + 0.002)
    across = 1.0 + centres[:, None]  # u w_x with w_x = 1, and w w_z = -w
    inner = slice(3, None), slice(2, -2)  # not beside back wall, bed and top, which mirror the flow
    assert ((w_star - w) / dt)[inner] == pytest.approx((w - across)[inner], rel=0.01)


def moving_disc_gain(cells):
    """Relative gain of x-momentum while a disc in plane strain moves with the flow for ten steps."""
    phi, (u, w) = blob(cells), solenoidal(cells)
    dt = 0.25 / cells
    u_node, w_node = np.empty_like(phi), np.empty_like(phi)
    level_set.node_velocity(u_node, w_node, u, w)
    momentum, gained = 0.0, 0.0
    for _ in range(10 * cells // 20):
        old = phi.copy()
        level_set.advect(phi, u_node, w_node, dt, 1.0 / cells, 1.0 / cells)
        u_star, _ = advected(u, w, old, phi, dt)
        before, after, unused = np.empty_like(u), np.empty_like(u), np.empty_like(w)
        control_masses(before, unused, old, np.ones_like(old), rows_in_reach(old, old))
        control_masses(after, unused, phi, np.ones_like(phi), rows_in_reach(phi, phi))
        gained += (after * u_star - before * u).sum()
        momentum = max(momentum, np.abs(before * u).sum())
    return abs(gained) / momentum


def test_momentum_of_a_moving_body_is_conserved_with_second_order():
    errors = [moving_disc_gain(cells) for cells in (20, 40, 80)]
    order = np.polyfit(np.log([20, 40, 80]), np.log(errors), 1)[0]
    assert errors[-1] < 1e-4, errors
    assert -order > 1.5, errors
