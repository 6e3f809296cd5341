"""The reference method: exact pressure at rest, div u = 0, and the same flow as the coupled method."""

import numpy as np
import pytest

from fvcollapse.case.case import GRAVITY, case_from_text
from fvcollapse.measure.pile import front_position, thickness
from fvcollapse.simulation import Simulation

COLUMN_AT_REST = """
[geometry]
slope_angle_deg = 0
length_0 = 0.10
channel_width = inf
[grid]
cell_size = 0.01
[rheology]
law = "newtonian"
viscosity = {viscosity}
[boundary]
mu_bed = inf
mu_back_wall = inf
[gate]
speed = 0
[numerics]
method = "projection"
unilateral = false
"""
COLLAPSE = """
[geometry]
channel_width = {width}
[grid]
cell_size = {cell_size}
[numerics]
method = "{method}"
unilateral = false
[effects.lateral_friction]
"""


def advance_to(simulation, time):
    records = []
    while simulation.state.time < time:
        records.append(simulation.advance(time))
    return records


def collapse(method, cell_size, time, width="0.10"):
    case = case_from_text(COLLAPSE.format(method=method, cell_size=cell_size, width=width))
    simulation = Simulation(case)
    records = advance_to(simulation, time)
    grid, state = simulation.grid, simulation.state
    h = thickness(state.level_set, grid.dz)
    x = grid.x_nodes if h.size == grid.nx + 1 else grid.x_centres
    return x, h, front_position(x, h, 0.005), simulation.energies()["kinetic"], records


def profile_difference(x_a, h_a, x_b, h_b):
    """Area between two profiles, as a fraction of the area under the first."""
    x = np.linspace(0.0, max(x_a[-1], x_b[-1]), 5000)
    a, b = (np.interp(x, *profile, right=0.0) for profile in ((x_a, h_a), (x_b, h_b)))
    return abs(a - b).sum() / a.sum()


@pytest.mark.parametrize("viscosity", [1.0, 1e2, 1e4, 1e6])
def test_rest_column_reaches_the_static_pressure(viscosity):
    """No-slip walls and no pressure at the start: bed pressure = rho g depth within 0.1 % after 20 steps."""
    simulation = Simulation(case_from_text(COLUMN_AT_REST.format(viscosity=viscosity)))
    simulation.state.pressure_filled[:] = 0.0
    for _ in range(20):
        simulation.advance(1.0)
    case, grid = simulation.case, simulation.grid
    static = case.rheology.density_bulk * GRAVITY * (case.geometry.height_0 - 0.5 * grid.dz)
    bed_pressure = simulation.cell_quantities()["pressure"][: simulation.gate_column, 0]
    assert bed_pressure == pytest.approx(static, rel=1e-3)


def test_velocity_is_solenoidal():
    """Div u at the tolerance of the factorisation, in every step of a collapse."""
    *_, records = collapse("projection", 0.0125, 0.1)
    assert max(record.divergence for record in records) < 1e-9  # 1/s; shear rates are 1 to 100 1/s


def test_agrees_with_the_coupled_method():
    """12 mm cells to 0.25 s: the two differ by the nonlinear tolerance 1e-3 only."""
    x, h, front, kinetic, _ = collapse("coupled", 0.012, 0.25)
    x_p, h_p, front_p, kinetic_p, _ = collapse("projection", 0.012, 0.25)
    assert front_p == pytest.approx(front, rel=2e-3)
    assert profile_difference(x, h, x_p, h_p) < 5e-3
    assert kinetic_p == pytest.approx(kinetic, rel=1e-2)


@pytest.mark.slow
def test_agrees_with_the_coupled_method_at_6_mm():
    """22 degrees, w = 10 cm, to 0.5 s: front and profile within 1 %."""
    x, h, front, _, _ = collapse("coupled", 0.006, 0.5)
    x_p, h_p, front_p, _, _ = collapse("projection", 0.006, 0.5)
    assert front_p == pytest.approx(front, rel=1e-2)
    assert profile_difference(x, h, x_p, h_p) < 1e-2
