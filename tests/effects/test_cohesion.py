"""Cohesion: a layer on a slope has a plug as thick as the cohesion carries, and rests if it is thinner.

Adhesion: the same with kappa_0 = mu_1 p_c, tension down to -p_c, a looser packing. The problems of
`fvcollapse/verification/problems/adhesion.py` hold the exact solutions.
"""

import math

import numpy as np
import pytest
from effect_runs import centre_of_mass, collapse, same_to_the_last_bit

from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError
from fvcollapse.measure.series_readings import ENERGY_SPENT, LOSSES
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until, run_until_steady

DEPTH, SLOPE, MU, VISCOSITY = 0.02, 24.0, 0.38, 1.0


def layer_with_cohesion(kappa_0, cells=32, **changes):
    return layer_case(
        DEPTH / cells,
        DEPTH,
        geometry__slope_angle_deg=SLOPE,
        boundary__mu_bed=math.inf,
        rheology__law="drucker_prager",
        rheology__mu_1=MU,
        rheology__viscosity=VISCOSITY,
        effects__cohesion={"kappa_0": kappa_0},
        **changes,
    )


def excess(case):
    """What the slope pulls beyond the friction, per depth: rho g cos a (tan a - mu_1), Pa/m."""
    return case.rheology.density_bulk * exact.gravity_normal(case) * (exact.slope_ratio(case) - MU)


def test_velocity_of_a_cohesive_layer_with_its_plug():
    """Eta u_z = q (H - z) - kappa_0 below the plug of thickness kappa_0/q, which moves as one."""
    case = layer_with_cohesion(0.4 * DEPTH * excess(layer_with_cohesion(0.0)))
    q, sheared = excess(case), 0.6 * DEPTH

    def velocity(z):
        z = np.minimum(z, sheared)
        return q / VISCOSITY * (sheared * z - 0.5 * z**2)

    z, u = run_until_steady(layer(case, velocity, dt=10.0)).profile()
    assert u == pytest.approx(velocity(z), abs=3e-3 * velocity(DEPTH))  # 1.6e-3: 32 cells


@pytest.mark.parametrize(("part", "moves"), [(0.7, True), (1.1, False)])
def test_a_layer_thinner_than_the_cohesion_carries_rests(part, moves):
    """It flows down the slope if its depth exceeds kappa_0 / (rho g cos a (tan a - mu_1))."""
    case = layer_with_cohesion(part * DEPTH * excess(layer_with_cohesion(0.0)), cells=16)
    flow = run_until(layer(case, lambda z: 0.0 * z, dt=0.05), 5.0)
    steady = 0.5 * excess(case) / VISCOSITY * (DEPTH * max(1.0 - part, 0.0)) ** 2
    speed = flow.surface_velocity()
    creep = 50.0 * DEPTH * case.numerics.shear_rate_min  # r/sqrt(1 - r^2) is far below 50 here
    assert speed < creep if not moves else speed == pytest.approx(steady, rel=0.1)


def test_cohesion_holds_the_grains_back():
    """And holds the column up altogether above rho g h_0 / 4, the height that a Tresca solid stands."""
    reached = [
        centre_of_mass(collapse(0.3, effects__cohesion={"kappa_0": kappa}))
        for kappa in (0.0, 30.0, 100.0, 1000.0)
    ]
    assert all(far > near + 1e-4 for far, near in zip(reached, reached[1:], strict=False))
    assert reached[-1] == pytest.approx(
        0.1, abs=1e-3
    )  # half its length; the corner is rounded by a cell


def test_refused_without_a_yield_stress():
    with pytest.raises(CaseError) as caught:
        Case().replace(**{"rheology.law": "newtonian", "effects.cohesion": {"kappa_0": 10.0}})
    assert caught.value.key == "effects.cohesion"


# -- adhesion ------------------------------------------------------------------------------------

ADHESION, LOSS = 200.0, 0.04


def bulk_fraction(case):
    return case.rheology.density_bulk / case.rheology.density_grain


def test_kappa_0_alone_is_a_key_of_the_law():
    case = Case().replace(**{"effects.cohesion": {"kappa_0": 30.0}, "rheology.cohesion": 5.0})
    assert case.resolved.effects.cohesion is None
    assert case.resolved.rheology.cohesion == 35.0
    assert case.resolved.effects.dilatancy is None


def test_adhesion_stays_and_the_loss_goes_to_dilatancy():
    case = Case().replace(
        **{"effects.cohesion": {"adhesion": ADHESION, "solid_fraction_loss": LOSS}}
    )
    section = case.resolved.effects.dilatancy
    assert case.resolved.effects.cohesion.adhesion == ADHESION
    assert case.resolved.rheology.cohesion == 0.0
    assert section.solid_fraction_critical == pytest.approx(bulk_fraction(case) - LOSS)
    assert section.dilatancy_factor > 0.0
    assert case.resolved.resolved == case.resolved


def test_the_loss_is_taken_from_the_critical_fraction_of_dilatancy():
    dilatancy = {"dilatancy_factor": 2.0, "solid_fraction_critical": 0.59}
    case = Case().replace(
        **{"effects.dilatancy": dilatancy, "effects.cohesion": {"solid_fraction_loss": LOSS}}
    )
    assert case.resolved.effects.cohesion is None
    assert case.resolved.effects.dilatancy.solid_fraction_critical == pytest.approx(0.59 - LOSS)
    assert case.resolved.effects.dilatancy.dilatancy_factor == 2.0


def test_weak_adhesion_changes_little():
    """The less the weaker, and nothing but round-off at last: the membrane is the only change of the solve."""
    without = collapse(0.12)
    changes = [
        centre_of_mass(collapse(0.12, effects__cohesion={"adhesion": p_c}))
        - centre_of_mass(without)
        for p_c in (1e-9, 1.0, 10.0, 100.0)
    ]
    assert abs(changes[0]) < 1e-9
    assert 0.0 > changes[1] > changes[2] > changes[3]


@pytest.fixture(scope="module")
def adhesive():
    return collapse(0.3, effects__cohesion={"adhesion": ADHESION})


def test_pressure_bears_tension_down_to_the_adhesion():
    """The corner of a falling column pulls: -17 Pa where p >= 0 without adhesion."""
    run = collapse(0.1, effects__cohesion={"adhesion": ADHESION})
    pressure = run.cell_quantities()["pressure"][run.geometry.filled > 0.5]
    assert -ADHESION <= pressure.min() < -0.05 * ADHESION
    run = collapse(0.1)
    assert run.cell_quantities()["pressure"].min() >= 0.0


def test_volume_and_energy_are_kept(adhesive):
    """Without a loss of solid fraction the volume stays; what the bonds take is booked."""
    start = collapse(0.0, effects__cohesion={"adhesion": ADHESION})
    volume = adhesive.geometry.filled.sum() / start.geometry.filled.sum()
    assert volume == pytest.approx(1.0, abs=1e-2)  # cells that the gate cuts count in full
    lost = sum(start.energies().values()) - sum(adhesive.energies().values())
    booked = sum(getattr(adhesive.state, name) for name in (*ENERGY_SPENT, *LOSSES))
    assert 0.0 < lost == pytest.approx(booked, abs=1e-4 * sum(start.energies().values()))


def test_adhesive_grains_swell_when_they_are_sheared():
    effect = {"adhesion": ADHESION, "solid_fraction_loss": LOSS}
    run = collapse(0.4, effects__cohesion=effect)
    sheared = run.state.solid_fraction[run.geometry.filled > 0.5]
    bulk = bulk_fraction(run.case)
    swollen = run.geometry.filled.sum() * math.prod(run.spacing) / run.state.volume_0 - 1.0
    assert bulk - LOSS - 1e-3 <= sheared.min()  # carried as a field
    assert sheared.min() < bulk - 0.5 * LOSS
    assert 0.1 * LOSS / bulk < swollen < LOSS / (bulk - LOSS)


@pytest.mark.parametrize("part", [0.8, 1.2])
def test_a_layer_below_a_cell_has_the_adhesion_of_all_its_bed(part):
    """A drucker_prager layer of 0.3 cells, of `part` of the critical thickness, rests, or shears its half cell."""
    case, cell = layer_with_cohesion(0.0, cells=4), DEPTH / 4
    pull = excess(case) * 0.3 * cell
    case = case.replace(
        **{"effects.cohesion": {"adhesion": pull / part / MU}, "numerics.film_thickness": 0.0}
    )
    flow = run_until(layer(case, lambda z: 0.0 * z, dt=0.01, depth=0.3 * cell), 1.0)
    expected = max(pull - pull / part, 0.0) / VISCOSITY * 0.5 * cell
    creep = (
        2.0 * cell * case.numerics.shear_rate_min
    )  # r/sqrt(1 - r^2) = 3.6 over half a cell: r = 0.964
    assert flow.surface_velocity() == pytest.approx(expected, rel=0.02, abs=creep)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"numerics.unilateral": False}, "numerics.unilateral"),
        ({"numerics.method": "projection"}, "numerics.method"),
        ({"rheology.law": "bingham"}, "rheology.law"),
        (
            {"effects.lateral_friction": {"scheme": "split"}, "geometry.channel_width": 0.1},
            "effects.lateral_friction.scheme",
        ),
    ],
)
def test_adhesion_is_refused(changes, key):
    with pytest.raises(CaseError) as caught:
        Case().replace(**{"effects.cohesion": {"adhesion": 10.0}} | changes)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("dilatancy", "loss", "allowed"),
    [
        (None, 0.2, None),  # 0.62 to 0.42
        ({"dilatancy_factor": 4.0, "solid_fraction_critical": 0.4}, 0.2, "<= 0.1, so that nu_eq"),
        ({"dilatancy_factor": 4.0, "solid_fraction_critical": 0.3}, 0.05, "<= 0, so that nu_eq"),
    ],
)
def test_grains_are_not_loosened_beyond_what_holds_together(dilatancy, loss, allowed):
    changes = {"effects.cohesion": {"solid_fraction_loss": loss}}
    changes |= {} if dilatancy is None else {"effects.dilatancy": dilatancy}
    if allowed is None:
        Case().replace(**changes)
        return
    with pytest.raises(CaseError) as caught:
        Case().replace(**changes)
    assert caught.value.key == "effects.cohesion.solid_fraction_loss"
    assert allowed in str(caught.value)


def test_zero_strength_is_no_effect():
    effect = {"adhesion": 0.0, "solid_fraction_loss": 0.0}
    assert same_to_the_last_bit(collapse(0.1), collapse(0.1, effects__cohesion=effect))
