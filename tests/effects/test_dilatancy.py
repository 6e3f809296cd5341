"""Dilatancy in a collapse: off it is nothing, on it conserves mass, and the volume follows its source."""

import math

import numpy as np
import pytest
from effect_runs import volume_change

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation
from fvcollapse.step.state import FIELDS

K, NU_C = 4.0, 0.60
COARSE = {"grid.cell_size": 0.02, "effects.lateral_friction": {}}


def start(**effect):
    return Simulation(
        Case().replace(**COARSE, **{"effects.dilatancy": {"dilatancy_factor": K} | effect})
    )


def advance_to(simulation, time):
    while simulation.state.time < time - 1e-12:
        simulation.advance(time)
    return simulation


def mass(simulation):
    """Volume that the grains would fill at the density of the start, over that of the start."""
    cells = (simulation.geometry.filled * simulation.geometry.packing).sum() / simulation.packing_0
    return cells * math.prod(simulation.spacing) / simulation.state.volume_0


def largest_difference(first, second):
    """Of two runs in any field, relative to the largest value of that field."""
    pairs = [(getattr(first.state, name), getattr(second.state, name)) for name in FIELDS]
    return max(np.abs(a - b).max() / max(np.abs(a).max(), 1e-300) for a, b in pairs)


# -- the limit of no dilatancy -------------------------------------------------------------------


@pytest.fixture(scope="module")
def incompressible():
    return advance_to(Simulation(Case().replace(**COARSE)), 0.08)


def test_an_incompressible_mass_carries_no_solid_fraction(incompressible):
    assert incompressible.state.effect_fields() == []


def test_zero_strength_is_the_incompressible_mass_to_the_last_bit(incompressible):
    assert largest_difference(incompressible, advance_to(start(dilatancy_factor=0.0), 0.08)) == 0.0


def test_weak_dilatancy_changes_little():
    """The weaker the less, once the sweeps converge closer than the change."""
    tight = {"numerics.tolerance": 1e-5, "numerics.max_sweeps": 200}

    def at_end(**changes):
        return advance_to(Simulation(Case().replace(**COARSE, **tight, **changes)), 0.08)

    without = at_end()
    changes = [
        largest_difference(without, at_end(**{"effects.dilatancy": {"dilatancy_factor": k}}))
        for k in (1e-5, 1e-4, 1e-3)
    ]
    assert 0.0 < changes[0] < changes[1] < changes[2] < 1e-3


# -- collapses -----------------------------------------------------------------------------------


def test_a_collapse_conserves_mass_and_its_volume_follows_the_source():
    simulation = start()
    cell = math.prod(simulation.spacing)
    expected = 0.0
    while simulation.state.time < 0.4 - 1e-12:
        source, filled = simulation.state.dilation_rate, simulation.geometry.filled.copy()
        record = simulation.advance(0.4)
        expected += record.dt * (source * filled).sum() * cell / simulation.state.volume_0
        if simulation.state.time > 0.07:  # then the gate, which the filling sees, is gone
            assert mass(simulation) == pytest.approx(1.0, abs=1e-3)
    assert volume_change(simulation) > 0.01
    assert volume_change(simulation) == pytest.approx(expected, abs=2e-3)


def test_dense_grains_expand_loose_ones_contract():
    changes = [
        volume_change(advance_to(start(solid_fraction_0=nu), 0.3)) for nu in (0.56, 0.60, 0.64)
    ]
    assert changes[0] < -0.005
    assert changes[2] > 0.02
    assert changes == sorted(changes)


def test_from_the_critical_state_the_volume_comes_back():
    simulation = Simulation(
        Case().replace(
            **COARSE,
            **{
                "geometry.slope_angle_deg": 16.0,
                "effects.dilatancy": {"dilatancy_factor": K, "solid_fraction_0": NU_C},
            },
        )
    )
    swollen = 0.0
    while simulation.state.time < 1.4:
        simulation.advance(1.4)
        swollen = max(swollen, volume_change(simulation) if simulation.state.time > 0.02 else 0.0)
    assert simulation.max_speed() < 0.01
    assert swollen > 0.002
    assert abs(volume_change(simulation)) < min(0.01, swollen)


def test_at_rest_nothing_dilates():
    case = Case().replace(
        **COARSE,
        **{
            "geometry.slope_angle_deg": 0.0,
            "gate.speed": 0.0,
            "effects.dilatancy": {"dilatancy_factor": K},
        },
    )
    simulation = advance_to(Simulation(case), 0.1)
    assert simulation.max_speed() < 1e-8
    assert simulation.state.solid_fraction[simulation.geometry.filled > 0] == pytest.approx(0.62)
