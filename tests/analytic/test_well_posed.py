"""The partially regularised mu(I): what a case accepts can be evaluated, what it refuses cannot."""

import itertools
import math

import pytest

from fvcollapse.case.case import Case
from fvcollapse.case.well_posed import criterion_mu_I, lower_well_posed_limit
from fvcollapse.errors import CaseError
from fvcollapse.step.rheology import material, mu_regularised

MU_1 = (0.0, 1e-6, 0.05, 0.06, 0.38, 0.48, 0.7, 1.0, 2.0, 10.0)
MU_2 = (0.0, 0.05, 0.3, 0.48, 0.55, 0.64, 0.73, 1.0, 3.0, 10.0)


def case_of(mu_1, mu_2, I_0, alpha):
    law = {"law": "mu_I_regularised", "mu_1": mu_1, "mu_2": mu_2, "I_0": I_0}
    law["alpha_regularised"] = alpha
    return Case().replace(**{f"rheology.{name}": value for name, value in law.items()})


@pytest.mark.parametrize("I_0", [1e-6, 0.279, 1000.0])
def test_an_accepted_law_is_finite_and_continuous(I_0):
    accepted = 0
    for mu_1, mu_2, alpha in itertools.product(MU_1, MU_2, (1e-3, 1.9, 1000.0)):
        if mu_2 < mu_1:
            continue
        try:
            law = material(case_of(mu_1, mu_2, I_0, alpha))
        except CaseError:
            continue
        accepted += 1
        below, at = (mu_regularised(law.I_1 * share, law) for share in (1.0 - 1e-9, 1.0))
        assert below == pytest.approx(at, rel=1e-3)
        for inertial in (0.0, 1e-300, 1e-12, 1.0, 1e100):
            assert math.isfinite(mu_regularised(inertial, law))
    assert accepted > 20


@pytest.mark.parametrize(("mu_1", "mu_2"), [(0.06, 0.73), (0.01, 0.3), (0.38, 0.64)])
def test_the_limit_is_where_the_criterion_changes_sign(mu_1, mu_2):
    """Also where it lies far below I_0."""
    limit = lower_well_posed_limit(mu_1, mu_2, 0.279)
    assert criterion_mu_I(limit * (1.0 - 1e-6), mu_1, mu_2, 0.279) > 0.0
    assert criterion_mu_I(limit * (1.0 + 1e-6), mu_1, mu_2, 0.279) < 0.0
