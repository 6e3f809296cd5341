"""What follows of mu(I) where an experiment states mu_1 alone, and that nothing follows where it states all."""

import pytest
from plausible_experiment import experiment

from fvcollapse.case.case import Case
from fvcollapse.diagnosis.baseline import baseline_cases
from fvcollapse.diagnosis.nuisances import nuisances
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.report.assumed import assumptions
from fvcollapse.measure.uncertainty import DEFAULTS
from fvcollapse.measure.unstated import RISE_SD

STATED = {"material__mu_1": 0.36, "material__mu_2": 0.7, "material__I_0": 0.3}


def test_mu_2_keeps_its_distance_to_a_stated_mu_1():
    """Aluminium bars of mu_1 = 0.36 have no mu_2 of glass beads."""
    bars = experiment(material__mu_1=0.36)
    law = bars.case().rheology
    assert (law.mu_1, law.mu_2, law.I_0) == (0.36, pytest.approx(0.61, abs=1e-12), 0.279)
    assert bars.assumed()["material.mu_2"].value == law.mu_2
    assert bars.standard_deviation("mu_2") == RISE_SD > DEFAULTS["mu_2"].value
    assert bars.standard_deviation("I_0") == DEFAULTS["I_0"].value


def test_mu_2_of_rough_grains_is_above_their_mu_1():
    assert experiment(material__mu_1=0.75).case().rheology.mu_2 == pytest.approx(1.0)


def test_the_case_that_is_believed_keeps_a_mu_2_of_its_own():
    bars = experiment(material__mu_1=0.36)
    believed = Case().replace(**{"rheology.mu_2": 0.55, "rheology.I_0": 0.5})
    law = bars.case(believed).rheology
    assert (law.mu_1, law.mu_2, law.I_0) == (0.36, 0.55, 0.5)
    assert bars.assumed(believed)["material.mu_2"].reason == "of the case file"
    assert bars.case(Case().replace(**{"rheology.I_0": 0.5})).rheology.mu_2 == pytest.approx(0.61)


def test_nothing_is_assumed_of_what_is_stated():
    """Neither where all is stated nor where nothing is: then the material is the believed one."""
    assert experiment(**STATED).assumed() == {}
    law = experiment(**STATED).case().rheology
    assert (law.mu_1, law.mu_2, law.I_0) == (0.36, 0.7, 0.3)
    for name in ("mu_1", "mu_2", "I_0"):
        assert experiment(**STATED).standard_deviation(name) == DEFAULTS[name].value
    silent = experiment(material__mu_1=None)
    assert silent.assumed() == {}
    assert silent.case().rheology == Case().rheology
    assert silent.standard_deviation("mu_2") == DEFAULTS["mu_2"].value


def test_a_stated_standard_deviation_holds():
    bars = experiment(material__mu_1=0.36, uncertainty__mu_2=0.04)
    assert bars.standard_deviation("mu_2") == 0.04


def test_a_diagnosis_calibrates_what_was_assumed_and_its_report_says_so():
    bars = experiment(material__mu_1=0.36)
    question = Question((bars,))
    found = {one.key: one for one in nuisances((bars,), baseline_cases((bars,)))}
    assert (found["rheology.mu_2"].mean, found["rheology.mu_2"].sd) == (
        pytest.approx(0.61),
        RISE_SD,
    )
    listed = {one.key: one for one in assumptions(question)}
    assert listed["rheology.mu_2"].value == "0.61"
    assert listed["rheology.mu_2"].source == "the stated mu_1 + 0.25, as of glass beads"
    assert listed["rheology.I_0"].source == "as of glass beads"
    assert listed["boundary.mu_back_wall"].source == "default of the program"
    assert "rheology.mu_1" not in listed
