"""What holds with the effects on, one by one and together: rest stays rest, volume and energy are booked."""

import math

import numpy as np
import pytest
from effect_runs import collapse

from fvcollapse.case.case import Case
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import PHYSICAL
from fvcollapse.measure.series_readings import ENERGY_SPENT, LOSSES
from fvcollapse.simulation import Simulation

FLOWING = [name for name, effect in CATALOGUE.items() if effect.kind == PHYSICAL]
TOGETHER = [  # those of one volume, or with a key that leaves it alone
    name for name in FLOWING if "dilation_rate" not in CATALOGUE[name].fields
]
ONE_VOLUME = {"cohesion": {"solid_fraction_loss": 0.0}}


@pytest.mark.parametrize("name", FLOWING)
def test_a_column_behind_a_closed_gate_rests(name):
    """It creeps by the regularisation only: h_0 times its shear rate, 5e-4 /s, is 7e-5 m/s."""
    for variant in CATALOGUE[name].variants:
        keys = CATALOGUE[name].keys(0.9, variant)
        if name == "gate":
            del keys["speed"]
        changes = {f"effects__{name}": keys, "gate__speed": 0.0}
        assert collapse(0.05, **changes).max_speed() < 1e-4


def drawn(seed):
    """A case at a random slope with at least three effects in random variants and strengths."""
    rng = np.random.default_rng(seed)
    names = rng.choice(TOGETHER, rng.integers(3, len(TOGETHER) + 1), replace=False)
    changes, steepest = {}, 22.0
    for name in names:
        effect = CATALOGUE[name]
        variant = effect.variants[rng.integers(len(effect.variants))]
        keys = effect.keys(rng.uniform(0.1, 0.9), variant)
        changes[f"effects.{name}"] = keys | ONE_VOLUME.get(name, {})
    if {"erodible_bed", "bed_friction"} <= set(names):  # the layer must rest on its bed
        steepest = 0.9 * math.degrees(math.atan(changes["effects.bed_friction"]["mu_bed"]))
    changes["geometry.slope_angle_deg"] = rng.uniform(0.0, steepest)
    return Case().replace(**{"grid.cell_size": 0.02}, **changes)


@pytest.mark.parametrize("seed", range(8))
def test_volume_and_energy_are_booked_with_several_effects(seed):
    """Once the slowest gate has left: a cell that it cuts counts only what stands on one side of it."""
    simulation = Simulation(drawn(seed))
    start, (dx, dz) = sum(simulation.energies().values()), simulation.spacing
    while simulation.state.time < 0.6:
        simulation.advance(0.6)
    state = simulation.state
    assert simulation.geometry.filled.sum() * dx * dz == pytest.approx(state.volume_0, rel=1e-3)
    lost = start - sum(simulation.energies().values())
    booked = sum(getattr(state, name) for name in (*ENERGY_SPENT, *LOSSES))
    assert lost == pytest.approx(booked, abs=1e-4 * start)
    assert lost > 0.0
