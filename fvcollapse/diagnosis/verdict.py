"""From evidences to a verdict whose probabilities mean what they say.

Raw evidences are over-confident. The `verdict_model`, fitted to synthetic cases whose cause is known (made with other
grids, closures and parameters than a diagnosis uses), turns them into probabilities. Its errors on cases left out
say how strange a case may look (conformal p-values): the verdict leaves open all hypotheses that are as probable as
nine in ten true causes were, whatever their class (class by class the sets held 5.3 names instead of 3.1, since
what is too weak to be seen is then open in every case). "none" is judged among the cases without an effect and given
up at 5 % only, so that one of them in twenty raises a false alarm.

An effect that was added to the catalogue after the fit is judged by its tempered evidence, all others by
the model (`new_effects`).

Diagnoses with controls have a model of their own, fitted to laboratories whose physics the believed model lacks.
Without a model evidences are tempered (`temperature`), which is no calibration: probabilities are capped, and there are
no conformal p-values. "none" is given up where it fails its predictive check at 5 %.

An error of the model can look like an effect: another code for the same equations leaves such gaps. "None" is therefore
the answer where the model agrees: no region of the gap is significant, chance explains all points together, and no
observable is off by more than the error of the model that the controls leave open (without controls, by more than two
codes differ). "None" is then as probable as all causes together.

References
----------
Vovk, Gammerman & Shafer (2005), Algorithmic Learning in a Random World (conformal prediction).
"""

from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.diagnosis.evidence import CHECK_PASSED
from fvcollapse.diagnosis.names import EFFECT, NONE, SEVERAL, UNKNOWN, effects_of
from fvcollapse.diagnosis.new_effects import new_hypotheses, smallest_set, with_new, without
from fvcollapse.diagnosis.sign import ruled_out
from fvcollapse.diagnosis.verdict_features import (
    QUIET,
    agrees,
    asks,
    balance_logit,
    class_of,
    temperature,
)
from fvcollapse.diagnosis.verdict_model import class_prior, softmax

if TYPE_CHECKING:
    from fvcollapse.diagnosis.evidence import Evidence
    from fvcollapse.diagnosis.separability import Separability
    from fvcollapse.diagnosis.verdict_model import VerdictModel

RETAINED = 0.10  # conformal p-value from which a hypothesis is left open
NONE_RETAINED = 0.05  # and from which "none" is not given up
CAP = 0.9  # largest probability without a model
CLEAR = 10.0  # odds against none from which an effect is named although the check is passed
EVEN = 0.5  # least probability of none where the model agrees
PAIR_TEMPERATURE = 5.0  # shares the probability of two effects among the pairs that were opened


class Verdict(NamedTuple):
    """The answer.

    Attributes
    ----------
    kind : str
        "effect", "several" (two effects together), "none" or "unknown".
    effects : tuple of str
        Empty for "none" and "unknown".
    indistinguishable : tuple of tuples of str
        Groups of effects that these data leave open together.
    probability : dict
        Hypothesis -> probability; sums to 1, the most probable first.
    set : tuple of str
        Hypotheses that are left open, the most probable first; empty: nothing of the catalogue fits.
    conformal : dict
        Hypothesis -> conformal p-value; empty without a model, and without those that it does not know.
    """

    kind: str
    effects: tuple[str, ...]
    indistinguishable: tuple[tuple[str, ...], ...]
    probability: dict[str, float]
    set: tuple[str, ...]
    conformal: dict[str, float]


def verdict(
    evidence: "Evidence",
    model: "VerdictModel | None" = None,
    separability: "Separability | None" = None,
    known: "Evidence | None" = None,
) -> Verdict:
    """The `Verdict` of an evidence.

    Parameters
    ----------
    evidence : Evidence
    model : VerdictModel, optional
        Judges the effects that it knows; the others, and all without a model, are judged by tempered
        evidences (see `new_effects`).
    separability : Separability, optional
        Its classes are groups that cannot be told apart.
    known : Evidence, optional
        Of the effects that the model knows, compared without the new ones; its pairs are also in
        `evidence`. Default: what `evidence` holds of them.

    Effects that are `ruled_out` are in neither set nor answer, and the others share their probability.
    Where the model `agrees` the answer is "none".
    """
    answer = probable(evidence, model, separability, known)
    answer = excluding(answer, ruled_out(evidence), separability)
    return agreeing(answer, separability) if agrees(evidence) else answer


def probable(
    evidence: "Evidence",
    model: "VerdictModel | None",
    separability: "Separability | None",
    known: "Evidence | None",
) -> Verdict:
    """The `Verdict` before the sign of the effects is looked at; parameters as of `verdict`."""
    new = () if model is None else new_hypotheses(evidence, model.classes)
    known = without(evidence, new) if known is None else known
    if model is None or not model.judges(known):
        return tempered(evidence, separability)
    shares = model.probabilities(known)
    p_values = model.conformal(shares)  # before the cap: the scores of the suite have none
    judged = in_order(named(known, capped(shares, model.cap)))
    conformal = {name: p_values.get(class_of(name), 0.0) for name in judged}
    probability, clear = judged, False
    if new:
        every = tempered_shares(evidence)
        probability = in_order(with_new(judged, every, new, CAP))
        uncapped = in_order(with_new(judged, every, new, 1.0))
        clear = is_clear(next(iter(uncapped)), uncapped)
    likely = smallest_set(probability, 1.0 - RETAINED)
    retained = tuple(
        name
        for name in probability
        if (name in likely if name in new else is_open(name, judged, conformal))
    )
    if NONE in retained and not (clear and retained[0] in new):
        return finished(NONE, probability, retained, conformal, separability)
    return finished(
        retained[0] if retained else UNKNOWN, probability, retained, conformal, separability
    )


def excluding(
    answer: Verdict, names: Collection[str], separability: "Separability | None"
) -> Verdict:
    """The `Verdict` with no probability for some single effects; the others share it in proportion."""
    if not any(answer.probability.get(name) for name in names):
        return answer
    left = {name: share for name, share in answer.probability.items() if name not in names}
    cap = max(CAP, *answer.probability.values())
    probability = in_order(capped(in_order(left), cap)) | dict.fromkeys(names, 0.0)
    retained = tuple(name for name in answer.set if name not in names)
    best = "+".join(answer.effects) or answer.kind
    if best in names:
        best = retained[0] if retained else UNKNOWN
    return finished(best, probability, retained, answer.conformal, separability)


def agreeing(answer: Verdict, separability: "Separability | None") -> Verdict:
    """The `Verdict` "none", left open and with a probability of `EVEN` or more; the others share the remainder.

    Where no hypothesis was left open, something unknown stays open beside it.
    """
    least = max(answer.probability[NONE], EVEN)
    others = {name: share for name, share in answer.probability.items() if name != NONE}
    factor = (1.0 - least) / max(sum(others.values()), 1.0e-300)
    shares = {NONE: least} | {name: factor * share for name, share in others.items()}
    # not `in_order`, whose division may leave less than `EVEN`
    probability = {name: shares[name] for name in sorted(shares, key=lambda other: -shares[other])}
    left_open = {NONE, *(answer.set or (UNKNOWN,))}
    retained = tuple(name for name in probability if name in left_open)
    return finished(NONE, probability, retained, answer.conformal, separability)


def is_clear(name: str, probability: Mapping[str, float]) -> bool:
    """Whether a hypothesis is so much more probable than none that no predictive check counts."""
    return probability[name] > CLEAR * probability[NONE]


def tempered(evidence: "Evidence", separability: "Separability | None") -> Verdict:
    """The verdict without a model.

    A gap that passes the predictive check needs no effect, unless one is ten times as probable as none (see also
    `agreeing`). Where it fails the check no set holds "none", and the others of the set stay.
    """
    probability = in_order(capped(tempered_shares(evidence), CAP))
    passes = evidence.hypotheses[NONE].p_value >= NONE_RETAINED
    retained = smallest_set(probability, 1.0 - RETAINED)
    if not passes and len(retained) > 1:
        retained = tuple(name for name in retained if name != NONE)
    clear = is_clear(retained[0], probability)
    best = NONE if passes and NONE in retained and not clear else retained[0]
    return finished(best, probability, retained, {}, separability)


def tempered_shares(evidence: "Evidence") -> dict[str, float]:
    """{hypothesis: probability} of tempered evidences and the prior of the classes.

    The prior is that of a model. Two effects together count if the best single one fails its check:
    nothing has taught here how much a second effect adds by chance.
    """
    hypotheses = evidence.hypotheses
    single = [name for name in hypotheses if name not in (NONE, UNKNOWN) and "+" not in name]
    best = max(single, key=lambda name: hypotheses[name].log_evidence, default=NONE)
    fails = hypotheses[best].p_value < CHECK_PASSED
    names = tuple(name for name in hypotheses if fails or "+" not in name)
    classes = tuple(dict.fromkeys(class_of(name) for name in names))
    prior = class_prior(classes)
    pairs = sum("+" in name for name in names)
    logs = [hypotheses[name].log_evidence / temperature(evidence) for name in names]
    logs += np.log([prior[class_of(name)] / (pairs if "+" in name else 1) for name in names])
    logs += [balance_logit(evidence, name) for name in names]
    logs -= [QUIET * (name == UNKNOWN and not asks(evidence)) for name in names]  # type: ignore[operator]
    return dict(zip(names, softmax(np.array(logs)).tolist(), strict=True))


def is_open(name: str, probability: Iterable[str], conformal: Mapping[str, float]) -> bool:
    """Whether a hypothesis is left open; of several pairs only the most probable can be."""
    if name == NONE:
        return conformal[name] >= NONE_RETAINED
    first = next((other for other in probability if "+" in other), None)
    return conformal[name] >= RETAINED and ("+" not in name or name == first)


def named(evidence: "Evidence", shares: Mapping[str, float]) -> dict[str, float]:
    """{hypothesis: probability}: that of two effects is shared among the pairs that were opened."""
    probability = {name: share for name, share in shares.items() if name != SEVERAL}
    pairs = {name: hypothesis for name, hypothesis in evidence.hypotheses.items() if "+" in name}
    if SEVERAL in shares:
        logs = (
            np.array([hypothesis.log_evidence for hypothesis in pairs.values()]) / PAIR_TEMPERATURE
        )
        logs += [balance_logit(evidence, name) for name in pairs]
        parts = shares[SEVERAL] * softmax(logs)
        probability |= dict(zip(pairs, parts.tolist(), strict=True))
    return probability


def capped(shares: dict[str, float], cap: float) -> dict[str, float]:
    """Probabilities none of which is above the cap; the others share what is cut off."""
    name = max(shares, key=shares.get)  # type: ignore[arg-type]
    if shares[name] <= cap or len(shares) == 1:
        return shares
    remainder = sum(
        share for other, share in shares.items() if other != name
    )  # may be far below round-off of 1
    others = len(shares) - 1
    return {
        other: cap
        if other == name
        else (1.0 - cap) * (share / remainder if remainder > 0.0 else 1.0 / others)
        for other, share in shares.items()
    }


def in_order(shares: Mapping[str, float]) -> dict[str, float]:
    """The most probable first, summing to one."""
    total = sum(shares.values())
    return {name: shares[name] / total for name in sorted(shares, key=lambda other: -shares[other])}


def finished(
    best: str,
    probability: dict[str, float],
    retained: tuple[str, ...],
    conformal: dict[str, float],
    separability: "Separability | None",
) -> Verdict:
    """The `Verdict` for a hypothesis."""
    effects = effects_of(best)
    kind = best if not effects else (SEVERAL if len(effects) > 1 else EFFECT)
    open_effects = tuple(n for n in retained if n not in (NONE, UNKNOWN) and "+" not in n)
    groups: list[tuple[str, ...]] | tuple[tuple[str, ...], ...] = (
        list(separability.classes) if separability is not None else []
    )
    if len(open_effects) > 1 and not any(set(open_effects) <= set(group) for group in groups):
        groups = [group for group in groups if not set(group) <= set(open_effects)]
        groups.insert(0, open_effects)
    groups = tuple(tuple(group) for group in groups)
    return Verdict(kind, effects, groups, probability, retained, conformal)
