"""Verdicts on a few measured values, such as run-out and final height: no layer was fitted to them."""

import numpy as np
import pytest

from fvcollapse.diagnosis.emulator import Response
from fvcollapse.diagnosis.evidence import Evidence, Hypothesis, ModelComparison
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.verdict import NONE_RETAINED, verdict
from fvcollapse.diagnosis.verdict_features import TEMPERATURE, temperature

LOGS = {"cohesion": 7.0, "gate": 1.0, "viscosity": 2.5, NONE: 0.0, UNKNOWN: 3.5}


def evidence_of(values, p_none=0.5):
    """An evidence of some number of values in which `cohesion` is ahead."""
    nothing = np.empty(0)
    found = {
        name: Hypothesis(
            *(name, log_evidence, log_evidence, 0.0, 0.2, (0,), nothing, nothing, nothing),
            *(p_none if name == NONE else 0.5, {0: 0.5}, {}, 1.0, nothing),
        )
        for name, log_evidence in LOGS.items()
    }
    return Evidence(found, values=values)


@pytest.mark.parametrize(
    ("values", "expected"), [(1, 1.0), (4, 4.0), (400, TEMPERATURE), (None, TEMPERATURE)]
)
def test_evidences_are_tempered_by_no_more_than_the_number_of_values(values, expected):
    assert temperature(evidence_of(values)) == expected


def test_odds_of_two_effects_are_those_of_tempered_evidences():
    for values, by in ((1, 1.0), (4, 4.0), (None, TEMPERATURE)):
        probability = verdict(evidence_of(values)).probability
        odds = np.log(probability["cohesion"] / probability["gate"])
        if probability["cohesion"] < 0.9:  # not cut off
            assert odds == pytest.approx((LOGS["cohesion"] - LOGS["gate"]) / by)
    assert verdict(evidence_of(400)).probability == verdict(evidence_of(None)).probability


def test_none_is_given_up_where_it_fails_its_check():
    kept = verdict(evidence_of(None, p_none=NONE_RETAINED))
    given_up = verdict(evidence_of(None, p_none=0.9 * NONE_RETAINED))
    assert (kept.kind, given_up.kind) == (NONE, "effect")
    assert NONE in kept.set
    assert NONE not in given_up.set
    assert set(given_up.set) == set(kept.set) - {NONE}
    assert given_up.probability == kept.probability


def test_the_interval_of_one_value_is_that_of_one_measurement():
    """A value that grows with the parameter, measured to a tenth of its range: 90 % are 0.33 of the prior wide."""
    levels = np.array([[0.0], [0.5], [1.0]])
    response = Response.fit(levels, 10.0 * levels)
    one = ModelComparison(np.eye(1), 1e-6 * np.eye(1), {"arms": response})
    found = one.evidence(np.array([-5.0]), pairs=False).hypotheses["arms"]
    assert float(found.low[0]) == pytest.approx(0.5 - 0.1645, abs=0.03)
    assert float(found.high[0]) == pytest.approx(0.5 + 0.1645, abs=0.03)
