"""Effects that a verdict layer was not trained on, beside those that it judges.

Let n be the hypotheses with a new effect and k the others. The probability of a hypothesis is

    p(n | D) = tempered evidence x prior of n, over the sum of all hypotheses;
    p(k | D) = (1 - sum of p(n | D)) p(k | D, no new effect),

with p(k | D, no new effect) from the layer. It sees the evidence that is compared without the new effects, since
the response of a new effect changes features of all others (the residual outside the span of all
responses, the pairs that are opened). Among the effects that it knows the layer therefore answers as if there were
no new one: their ratios, conformal p-values and the part of the set that they make up do not change. Only
how probable a new effect is rests on tempered evidences, all of one scale, new and known. It is no calibrated
probability: all new effects together get at most `cap`. A new effect is left open if it belongs to the
smallest set of hypotheses that holds a probability of `level`; it has no conformal p-value. Two effects
together count as new if one of them is.
"""

from collections.abc import Container, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from fvcollapse.diagnosis.names import effects_of

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Evidence


def new_hypotheses(evidence: "Evidence", classes: Iterable[str]) -> tuple[str, ...]:
    """Names of the hypotheses with an effect that is no class of a layer.

    Parameters
    ----------
    evidence : Evidence
    classes : sequence of str
        Of the layer.
    """
    known = set(classes)
    return tuple(
        name for name in evidence.hypotheses if not set(effects_of(name) or (name,)) <= known
    )


def without(evidence: "Evidence", names: Container[str]) -> "Evidence":
    """The `Evidence` without some hypotheses."""
    hypotheses = {name: each for name, each in evidence.hypotheses.items() if name not in names}
    return replace(evidence, hypotheses=hypotheses)


def merged(evidence: "Evidence", known: "Evidence") -> "Evidence":
    """The `Evidence` with the pairs that only another one opened, in the order of evidence x prior odds."""
    every = known.hypotheses | evidence.hypotheses
    ranked = sorted(every.values(), key=lambda each: -(each.log_evidence + each.log_prior))
    return replace(evidence, hypotheses={each.name: each for each in ranked})


def with_new(
    probability: dict[str, float], tempered: Mapping[str, float], new: Iterable[str], cap: float
) -> dict[str, float]:
    """{hypothesis: probability} of all.

    Parameters
    ----------
    probability : dict
        Of the hypotheses that the layer judges; sums to 1.
    tempered : dict
        Tempered probabilities of all hypotheses; those that do not count are missing.
    new : sequence of str
        The new hypotheses.
    cap : float
        Largest probability of all new hypotheses together.
    """
    added = {name: tempered[name] for name in new if name in tempered}
    total = sum(added.values())
    if total == 0.0:
        return probability | added
    factor = min(total, cap) / total
    rest = 1.0 - min(total, cap)
    return {name: rest * share for name, share in probability.items()} | {
        name: factor * share for name, share in added.items()
    }


def smallest_set(probability: Mapping[str, float], level: float) -> tuple[str, ...]:
    """The most probable hypotheses that together hold a probability of `level`; the first is the most probable."""
    names, total = [], 0.0
    for name in sorted(probability, key=lambda name: -probability[name]):
        if total < level:
            names.append(name)
            total += probability[name]
    return tuple(names)
