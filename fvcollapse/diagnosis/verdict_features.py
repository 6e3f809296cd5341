"""What the verdict layer sees of an evidence: features of every hypothesis, of the case, and known odds.

Two things are no features but odds of their own, known before any fit: what the profiles' own `mass_balance`
says, and whether anything asks for an explanation.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import logsumexp

from fvcollapse.diagnosis.evidence import CHECK_PASSED
from fvcollapse.diagnosis.names import NONE, SEVERAL, UNKNOWN

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Evidence, Hypothesis
    from fvcollapse.diagnosis.left import Left

TEMPERATURE = 10.0  # without a model
NEAR = 20.0  # logarithm of an evidence ratio up to which it counts in proportion
LEAST_SHARE = 1.0e-3
QUIET = 5.0  # logarithm of the odds against something unknown where nothing asks for an explanation
HONEST = 1.0  # size of what is left over an honest error of the model, up to which the model agrees
LEAST_RATIO, MOST_RATIO = (
    0.05,
    20.0,
)  # of the size of what is left over an honest error of the model
FEATURES = ("behind", "behind_near", "sigma", "outside", "closes", "worsens")  # of a hypothesis
# (p-values are not among them: they tell how real the noise of the suite is, and on cases left out the answers
# were no better with them)
CASE_FEATURES = (
    "best_outside",
    "best_sigma",
    "none_outside",
    "none_sigma",
    "unknown_sigma",
    "pair_gain",
    "above_none",
    "above_unknown",
    "runs",
    "regions",
    "practical",
)


def features(evidence: "Evidence", classes: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Features of a hypothesis of every class (K, `FEATURES`) and of the case (`CASE_FEATURES`).

    NaN where a class was not compared; of two effects together the best pair counts.

    Parameters
    ----------
    evidence : Evidence
    classes : sequence of str
    """
    hypotheses = evidence.hypotheses
    single = {name: hypothesis for name, hypothesis in hypotheses.items() if "+" not in name}
    pairs = [hypothesis for name, hypothesis in hypotheses.items() if "+" in name]
    effects = {
        name: hypothesis for name, hypothesis in single.items() if name not in (NONE, UNKNOWN)
    }
    top = max(hypothesis.log_evidence for hypothesis in single.values())
    best = max((effects or single).values(), key=lambda hypothesis: hypothesis.log_evidence)
    judged = dict(single)
    if pairs:
        judged[SEVERAL] = max(pairs, key=lambda hypothesis: hypothesis.log_evidence)
    rows = np.full((len(classes), len(FEATURES)), np.nan)
    for row, name in zip(rows, classes, strict=True):
        if name in judged:
            behind = top - judged[name].log_evidence
            near = float(np.clip(behind, -NEAR, NEAR))
            each = judged[name]
            row[:] = (signed_log(behind), near, *shape_of(each), *sign_of(each))
    none, unknown = hypotheses[NONE], hypotheses[UNKNOWN]
    best_sigma, best_outside = shape_of(best)
    none_sigma, none_outside = shape_of(none)
    gain = judged[SEVERAL].log_evidence - top if pairs else 0.0
    values = {
        "best_outside": best_outside,
        "best_sigma": best_sigma,
        "none_outside": none_outside,
        "none_sigma": none_sigma,
        "unknown_sigma": float(np.log(unknown.sigma)),
        "pair_gain": signed_log(gain),
        "above_none": signed_log(best.log_evidence - none.log_evidence),
        "above_unknown": signed_log(best.log_evidence - unknown.log_evidence),
        "runs": float(len(best.p_by_run)),
    } | left_over(evidence.left)
    return rows, np.array([values[name] for name in CASE_FEATURES])


def shape_of(hypothesis: "Hypothesis") -> tuple[float, float]:
    """Logarithms of the discrepancy and of the mean square outside the responses."""
    outside = max(hypothesis.residual_outside, LEAST_SHARE)
    return float(np.log(hypothesis.sigma)), float(np.log(outside))


def sign_of(hypothesis: "Hypothesis") -> tuple[float, float]:
    """Share of the significant gap that any strength closes (NaN where that is not asked), observables made worse."""
    closes = np.nan if hypothesis.closes is None else max(hypothesis.closes, 0.0)
    return closes, float(len(hypothesis.worsens))


def left_over(left: "Left | None") -> dict[str, float]:
    """{feature of the case: value} of `Left`."""
    if left is None:
        return {"regions": 0.0, "practical": 0.0}
    ratio = min(max(left.practical, LEAST_RATIO), MOST_RATIO)
    return {"regions": float(np.log1p(left.regions)), "practical": float(np.log(ratio))}


def signed_log(value: float) -> float:
    """ln(1 + |value|) with the sign of the value."""
    return float(np.sign(value) * np.log1p(abs(value)))


def class_of(cause: str) -> str:
    """Class of a cause: two effects together are one class."""
    return SEVERAL if "+" in cause else cause


def known_logits(evidence: "Evidence", classes: Sequence[str]) -> np.ndarray:
    """Logarithms (K,) of odds of the classes that need no fit.

    Those that they give to the mass balance of the profiles, of two effects the mean odds. Where no region of the gap
    is significant, nor all points taken together, nothing asks for something unknown.
    """
    odds = np.array([balance_logit(evidence, name) for name in classes])
    if SEVERAL in classes and (pairs := [name for name in evidence.hypotheses if "+" in name]):
        logits = [balance_logit(evidence, name) for name in pairs]
        odds[classes.index(SEVERAL)] = logsumexp(logits) - np.log(len(pairs))
    if UNKNOWN in classes and not asks(evidence):
        odds[classes.index(UNKNOWN)] -= QUIET
    return odds


def temperature(evidence: "Evidence") -> float:
    """What evidences are tempered by without a model.

    Their errors hang together, so that the values of a film count as fewer. All of them count as one value at
    least, so that the temperature is no higher than their number.
    """
    return TEMPERATURE if evidence.values is None else min(TEMPERATURE, float(evidence.values))


def asks(evidence: "Evidence") -> bool:
    """Whether anything asks for an explanation: a significant region of the gap, or all points taken together."""
    left = evidence.left
    return left is None or left.regions > 0 or evidence.hypotheses[NONE].p_value < CHECK_PASSED


def agrees(evidence: "Evidence") -> bool:
    """Whether nothing asks for an explanation, and no more is left than an honest error of the model."""
    left = evidence.left
    return left is not None and left.practical <= HONEST and not asks(evidence)


def balance_logit(evidence: "Evidence", name: str) -> float:
    """`MassBalance.logit` of a hypothesis, 0 without a balance."""
    return 0.0 if evidence.balance is None else evidence.balance.logit(name)
