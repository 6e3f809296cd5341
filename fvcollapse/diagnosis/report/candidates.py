"""The candidate effects of a diagnosis as parts of the report."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.case.case import describe_keys
from fvcollapse.diagnosis.confirmation import is_inside
from fvcollapse.diagnosis.report import schema as form
from fvcollapse.diagnosis.separability import EQUIVALENT
from fvcollapse.effects.catalogue import CATALOGUE

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.evidence import Hypothesis
    from fvcollapse.diagnosis.levels import Closure
    from fvcollapse.diagnosis.verdict import Verdict

ENDS = 0.002  # reported quantiles stay inside: some priors have no end
LIKE_MISCALIBRATION = 0.2  # share of the null test that an effect wins


def candidates(analysis: "Analysis", verdict: "Verdict") -> dict[str, form.Candidate]:
    """Every effect with its probability and the parameters that fit best."""
    parts, units = {}, units_of_keys()
    for name in analysis.responses:
        hypothesis = analysis.evidence.hypotheses[name]
        closure = analysis.library.closures[name][hypothesis.variant[0]]
        parts[name] = form.Candidate(
            probability=float(verdict.probability[name]),
            log_evidence=hypothesis.log_evidence,
            parameters=parameters(closure, (hypothesis.u, hypothesis.low, hypothesis.high), units),
            plausible=plausible(hypothesis),
        )
    return parts


def plausible(hypothesis: "Hypothesis") -> bool:
    """Whether the best parameters lie inside the central 98 % of their priors."""
    return is_inside(hypothesis.u)


def parameters(
    closure: "Closure", quantiles: Sequence[np.ndarray], units: Mapping[str, str]
) -> dict[str, form.Parameter]:
    """{name: `Parameter`} of a closure at quantiles: best, and the ends of the interval if given."""
    values = [closure.values(np.clip(u, ENDS, 1.0 - ENDS)) for u in quantiles]
    best, *ends = values
    parts = {}
    for name, value in best.items():
        low, high = (end[name] for end in ends) if ends else (None, None)
        parts[name] = form.Parameter(
            value=value,
            low=low,
            high=high,
            units=units[f"effects.{closure.effect}.{name}"],
            prior=form.PriorRange(**closure.priors[name]._asdict()),
        )
    return parts


def units_of_keys() -> dict[str, str]:
    """{key of the case: unit}."""
    return {info.name: info.unit for info in describe_keys()}


def hypotheses(analysis: "Analysis", verdict: "Verdict") -> dict[str, form.HypothesisSummary]:
    """All hypotheses of the evidence."""
    wins = analysis.null_wins
    parts = {}
    for name, hypothesis in analysis.evidence.hypotheses.items():
        keys = [
            key
            for part in name.split("+")
            if part in CATALOGUE
            for key in CATALOGUE[part].absorbed_in
        ]
        parts[name] = form.HypothesisSummary(
            log_evidence=hypothesis.log_evidence,
            log_evidence_wide=hypothesis.log_evidence_wide,
            conformal_p=verdict.conformal.get(name),
            predictive_p=hypothesis.p_value,
            like_miscalibration=name in CATALOGUE and wins.get(name, 0.0) >= LIKE_MISCALIBRATION,
            absorbed_in=list(dict.fromkeys(keys)),
        )
    return parts


def separability(analysis: "Analysis", verdict: "Verdict") -> form.Separability | None:
    """How alike the effects look; None with fewer than two."""
    likeness = analysis.separability
    if len(likeness.names) < 2:
        return None
    grouped = {name for group in likeness.classes for name in group}
    classes = [list(group) for group in likeness.classes]
    classes += [[name] for name in likeness.names if name not in grouped]
    return form.Separability(
        names=list(likeness.names),
        cosine=likeness.cosine.tolist(),
        distance_squared=likeness.distance.tolist(),
        unique_snr=likeness.unique_snr.tolist(),
        threshold=EQUIVALENT,
        classes=classes,
    )
