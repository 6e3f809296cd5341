"""What holds for every collapse: symmetry, scaling, no suction, no energy from nothing."""

import math

import numpy as np
import pytest

from fvcollapse.case.case import Case
from fvcollapse.simulation import Simulation

COARSE = {"grid.cell_size": 0.02, "geometry.channel_width": math.inf}


def simulation_of(**changes):
    return Simulation(Case().replace(**{**COARSE, **changes}))


def advance_to(simulation, time):
    while simulation.state.time < time - 1e-12:
        simulation.advance(time)
    return simulation


# -- symmetry and scaling ----------------------------------------------------------------------


def test_free_column_collapses_symmetrically():
    """A column away from all walls, horizontal bed, gate gone: left and right mirror each other."""
    dx, middle = 0.01, 0.40
    left, right = middle - 0.06, middle + 0.06
    simulation = simulation_of(
        **{
            "grid.cell_size": dx,
            "geometry.slope_angle_deg": 0.0,
            "geometry.length_0": right + 0.1,
            "geometry.polygon": [[left, 0.0], [right, 0.0], [right, 0.08], [left, 0.08]],
            "gate.speed": math.inf,
            "numerics.tolerance": 1e-6,
            "numerics.max_sweeps": 100,
        }
    )
    advance_to(simulation, 0.15)
    filled = simulation.geometry.filled
    centre = round(middle / simulation.spacing[0])
    width = min(centre, filled.shape[0] - centre)
    to_left, to_right = filled[centre - width : centre][::-1], filled[centre : centre + width]
    assert filled[centre + 6 :].sum() > 5.0  # it has collapsed
    assert np.abs(to_left - to_right).sum() < 1e-3 * filled.sum()


SCALE = 10.0


def scaled(factor):
    """Case whose lengths are `factor` times as long, times as its square root."""
    root = math.sqrt(factor)
    return Case().replace(
        **{
            "geometry.height_0": 0.08 * factor,
            "geometry.length_0": 0.10 * factor,
            "geometry.channel_width": 0.10 * factor,
            "effects.lateral_friction": {},
            "grid.cell_size": 0.01 * factor,
            "gate.speed": 2.3 * root,
            "rheology.grain_diameter": 7e-4 * factor,
            "numerics.shear_rate_min": 5e-4 / root,
            "numerics.tolerance": 1e-8,
            "numerics.max_sweeps": 200,
        }
    )


def test_unit_scaling():
    """All lengths times 10 and all times times sqrt(10): the same collapse."""
    small, large = Simulation(scaled(1.0)), Simulation(scaled(SCALE))
    while small.state.time < 0.045:
        small.advance(1.0)
        large.advance(math.sqrt(SCALE))
    assert large.state.time == pytest.approx(math.sqrt(SCALE) * small.state.time, rel=1e-12)
    speed = small.max_speed()
    assert speed > 0.1
    # The floor of the viscosity, 1e-3 Pa s, is the one quantity that does not scale. It makes 7e-5 of the speed, and
    # less than 5e-6 when it is a hundredth.
    grains = small.geometry.mass_x > 0.05  # beyond them the velocity is only continued
    change = np.abs(large.state.u / math.sqrt(SCALE) - small.state.u)
    assert change[grains].max() < 1.5e-4 * speed
    assert np.abs(large.geometry.filled - small.geometry.filled).max() < 1e-5


# -- physics -----------------------------------------------------------------------------------


@pytest.mark.parametrize("slope", [0.0, 22.0])
def test_no_suction_and_no_lost_volume(slope):
    simulation = simulation_of(
        **{"geometry.slope_angle_deg": slope, "effects.lateral_friction": {}}
    )
    dx, dz = simulation.spacing
    while simulation.state.time < 0.4:
        simulation.advance(0.4)
        assert simulation.state.pressure_filled.min() >= 0.0
        volume = simulation.geometry.filled.sum() * dx * dz
        if simulation.state.time > 0.1:  # until then the corner of the column is a cell of its own
            assert volume == pytest.approx(simulation.state.volume_0, rel=1e-3)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"rheology.law": "drucker_prager", "rheology.viscosity": 0.4},
        {"boundary.mu_bed": 0.0, "boundary.mu_back_wall": 0.0},
        {
            "boundary.mu_bed": math.inf,
            "effects.lateral_friction": {},
            "geometry.channel_width": 0.1,
        },
    ],
    ids=["mu_I", "drucker_prager", "smooth", "rough"],
)
def test_energy_never_grows(changes):
    """Horizontal bed, gate gone: kinetic plus potential energy only falls, and by friction alone.

    The surface moves with the velocity at the start of the step, so that velocity goes with the new
    potential energy. What the volume correction and the cut cells add to the volume counts as
    lifted to the top of the column.
    """
    simulation = simulation_of(
        **{"geometry.slope_angle_deg": 0.0, "gate.speed": math.inf, **changes}
    )
    dx, dz = simulation.spacing
    weight = 1550.0 * 9.81 * 0.14
    start = energy = simulation.energies()["potential"]
    volume = simulation.geometry.filled.sum() * dx * dz
    while simulation.state.time < 0.3:
        kinetic = simulation.energies()["kinetic"]
        record = simulation.advance(0.3)
        now = kinetic + simulation.energies()["potential"]
        volume_now = simulation.geometry.filled.sum() * dx * dz
        lifted = weight * (abs(record.volume_correction) + abs(volume_now - volume))
        assert now <= energy + lifted + 1e-6 * start
        energy, volume = now, volume_now
    assert energy < 0.95 * start


def test_friction_of_wider_channels_fades():
    """The mass at 0.3 s lies the further, the wider the channel; w = 100 m is as good as none."""
    means = []
    for width in (0.05, 0.1, 0.2, 100.0, math.inf):
        changes = {"geometry.channel_width": width, "effects.lateral_friction": {}}
        simulation = advance_to(simulation_of(**changes), 0.3)
        moment = (simulation.geometry.filled.sum(1) * simulation.grid.x_centres).sum()
        means.append(moment / simulation.geometry.filled.sum())
    assert means[:3] == sorted(means[:3])
    assert means[-2] == pytest.approx(means[-1], rel=1e-3)
    assert means[2] < means[-1]
    assert means[0] < means[-1] - 1e-3


# -- switches ----------------------------------------------------------------------------------


def fields(simulation):
    state = simulation.state
    return [state.u, state.w, state.pressure_filled, state.level_set, state.bed_slip]


@pytest.mark.parametrize("closure", ["sink", "friction_increase"])
def test_infinite_width_is_the_same_as_no_section(closure):
    without = advance_to(simulation_of(), 0.05)
    with_section = advance_to(
        simulation_of(**{"effects.lateral_friction": {"closure": closure}}), 0.05
    )
    for a, b in zip(fields(without), fields(with_section), strict=True):
        assert np.array_equal(a, b)


def test_a_run_is_repeatable_to_the_last_bit():
    first, second = (advance_to(simulation_of(), 0.05) for _ in range(2))
    for a, b in zip(fields(first), fields(second), strict=True):
        assert np.array_equal(a, b)


def test_closed_gate_and_level_bed_nothing_happens():
    simulation = simulation_of(**{"geometry.slope_angle_deg": 0.0, "gate.speed": 0.0})
    before = simulation.geometry.filled.copy()
    advance_to(simulation, 0.1)
    assert np.abs(simulation.geometry.filled - before).max() < 1e-5
