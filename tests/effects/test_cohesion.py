"""Cohesion: a layer on a slope has a plug as thick as the cohesion carries, and rests if it is thinner."""

import math

import numpy as np
import pytest
from effect_runs import centre_of_mass, collapse

from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError
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
