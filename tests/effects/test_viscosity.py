"""Viscosity: eta_I scaled gives the Bagnold flow of the scaled law; a constant one is the law of equation 8."""

import math

import numpy as np
import pytest
from effect_runs import centre_of_mass, collapse

from fvcollapse.case.case import Case
from fvcollapse.errors import CaseError
from fvcollapse.verification import exact
from fvcollapse.verification.flows import layer, layer_case, run_until_steady

DEPTH = 0.02


@pytest.mark.parametrize("factor", [0.8, 2.0])
def test_bagnold_flow_of_the_scaled_viscosity(factor):
    """mu_1 + factor (mu_2 - mu_1) I/(I_0 + I) = tan(slope) gives I, and u as in Bagnold's flow."""
    case = layer_case(
        DEPTH / 32,
        DEPTH,
        geometry__slope_angle_deg=24.0,
        boundary__mu_bed=math.inf,
        rheology__mu_1=0.38,
        rheology__mu_2=0.64,
        effects__viscosity={"factor": factor},
    )
    excess = math.tan(math.radians(24.0)) - 0.38
    inertial = 0.279 * excess / (factor * (0.64 - 0.38) - excess)
    scale = inertial / 7e-4 * math.sqrt(1550.0 / 2500.0 * exact.gravity_normal(case))

    def velocity(z):
        return 2.0 / 3.0 * scale * (DEPTH**1.5 - np.maximum(DEPTH - z, 0.0) ** 1.5)

    z, u = run_until_steady(layer(case, velocity, dt=10.0)).profile()
    assert u == pytest.approx(
        velocity(z), abs=1e-3 * velocity(DEPTH)
    )  # 2e-4: second order, 32 cells


def test_constant_viscosity_is_the_law_of_equation_8():
    case = Case().replace(**{"effects.viscosity": {"eta_constant": 0.4}})
    paper = {"rheology.law": "drucker_prager", "rheology.viscosity": 0.4}
    assert case.resolved == Case().replace(**paper)


@pytest.mark.parametrize("law", ["drucker_prager", "bingham", "newtonian"])
def test_constant_viscosity_laws_are_scaled(law):
    case = Case().replace(**{"rheology.law": law, "effects.viscosity": {"factor": 3.0}})
    changed = Case().replace(**{"rheology.law": law}).rheology.viscosity * 3.0
    assert case.resolved.rheology.viscosity == changed


@pytest.mark.parametrize("name", ["factor", "eta_constant"])
def test_a_higher_viscosity_holds_the_grains_back(name):
    reached = [
        centre_of_mass(collapse(0.3, effects__viscosity={name: value})) for value in (0.3, 1.0, 4.0)
    ]
    assert reached[0] > reached[1] + 1e-4
    assert reached[1] > reached[2] + 1e-4


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"rheology.law": "mu_I_regularised", "effects.viscosity": {}}, "effects.viscosity"),
        (
            {"effects.viscosity": {"factor": 2.0, "eta_constant": 0.4}},
            "effects.viscosity.factor",
        ),
    ],
)
def test_refused(changes, key):
    with pytest.raises(CaseError) as caught:
        Case().replace(**changes)
    assert caught.value.key == key
