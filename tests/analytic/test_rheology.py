"""Norm convention: in simple shear du/dz = shear_rate every law returns its tau exactly."""

import csv
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fvcollapse.case.case import Case
from fvcollapse.step.rheology import ETA_FLOOR, effective_viscosity, material, mu_regularised

RATES = st.floats(1.0, 1e3)
PRESSURES = st.floats(1.0, 1e5)
# Lower well-posed limit and A_- of mu(I), computed independently of this code from the formulas of
# Barker et al. (2015) and Barker & Gray (2017): mu_1, mu_2, I_0, I_low, A_-.
WELL_POSED = list(
    csv.DictReader(Path(__file__).with_name("well_posed_ranges.csv").read_text().splitlines())
)


def law(name, **changes):
    keys = {"rheology.law": name, "numerics.shear_rate_min": 1e-9}
    keys.update({f"rheology.{key}": value for key, value in changes.items()})
    return material(Case().replace(**keys))


def stress(rate, pressure, medium):
    return rate * effective_viscosity(rate, pressure, medium)


@given(RATES, PRESSURES)
def test_mu_I_gives_mu_of_I_times_p(rate, pressure):
    inertial = rate * 7e-4 / math.sqrt(pressure / 2500.0)
    mu = 0.48 + (0.73 - 0.48) / (0.279 / inertial + 1.0)
    expected = max(
        mu * pressure, ETA_FLOOR * rate
    )  # the floor acts where there is next to no pressure
    assert stress(rate, pressure, law("mu_I")) == pytest.approx(expected, rel=1e-12)


@given(RATES, PRESSURES)
def test_drucker_prager_adds_cohesion_and_viscous_stress(rate, pressure):
    medium = law("drucker_prager", viscosity=0.4, cohesion=12.0)
    assert stress(rate, pressure, medium) == pytest.approx(
        0.48 * pressure + 12.0 + 0.4 * rate, rel=1e-12
    )


@given(RATES, PRESSURES)
def test_bingham_and_newtonian_ignore_pressure(rate, pressure):
    bingham = law("bingham", viscosity=0.4, cohesion=12.0)
    assert stress(rate, pressure, bingham) == pytest.approx(12.0 + 0.4 * rate, rel=1e-12)
    assert stress(rate, pressure, law("newtonian", viscosity=0.4)) == pytest.approx(
        0.4 * rate, rel=1e-12
    )


@given(RATES, PRESSURES)
def test_regularised_mu_I_gives_its_two_branches(rate, pressure):
    medium = law("mu_I_regularised")
    inertial = rate * 7e-4 / math.sqrt(pressure / 2500.0)
    if inertial < medium.I_1:
        mu = math.sqrt(1.9 / math.log(medium.A_minus / inertial))
    else:
        mu = (0.48 * 0.279 + 0.73 * inertial + 0.05 * inertial**2) / (0.279 + inertial)
    expected = max(mu * pressure, ETA_FLOOR * rate)
    assert stress(rate, pressure, medium) == pytest.approx(expected, rel=1e-9)


def test_mu_I_limits():
    medium = law("mu_I")
    assert stress(1e-4, 1e3, medium) == pytest.approx(0.48 * 1e3, rel=1e-6)
    assert stress(1e5, 1e3, medium) == pytest.approx(0.73 * 1e3, rel=1e-3)


@given(st.floats(1e-6, 1e3), st.floats(0, 1e5))
def test_yield_stress_is_regularised_once(rate, pressure):
    medium = material(
        Case().replace(**{"rheology.law": "drucker_prager", "rheology.viscosity": 0.0})
    )
    expected = 0.48 * pressure * rate / math.hypot(rate, 5e-4)
    assert stress(rate, pressure, medium) == pytest.approx(
        max(expected, ETA_FLOOR * rate), rel=1e-12
    )


@pytest.mark.parametrize("name", ["mu_I", "drucker_prager", "mu_I_regularised"])
def test_suction_has_no_strength(name):
    medium = law(name, viscosity=0.0)
    assert (
        effective_viscosity(1.0, -100.0, medium)
        == effective_viscosity(1.0, 0.0, medium)
        == ETA_FLOOR
    )


@pytest.mark.parametrize("row", WELL_POSED, ids=lambda row: row["parameter_set"])
def test_barker_gray_constants(row):
    mu_1, mu_2, I_0 = (float(row[name]) for name in ("mu_s", "mu_2", "I0"))
    medium = law("mu_I_regularised", mu_1=mu_1, mu_2=mu_2, I_0=I_0)
    assert pytest.approx(float(row["I_low_wellposed"]), rel=1e-4) == medium.I_1
    assert medium.A_minus == pytest.approx(float(row["A_minus_alpha1.9_muinf0.05"]), rel=2e-3)


def test_regularised_branches_meet():
    medium = law("mu_I_regularised")
    below, above = (mu_regularised(medium.I_1 * (1.0 + sign * 1e-9), medium) for sign in (-1, 1))
    assert below == pytest.approx(above, rel=1e-7)
