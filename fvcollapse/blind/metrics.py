"""Scores of probabilistic answers: first names, sets, alarms, confusion, calibration."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from fvcollapse.blind.calibration import calibration, risk_coverage, sharpness
from fvcollapse.blind.outcomes import (
    Outcome,
    best_credit,
    bootstrapped,
    class_of,
    credit,
    grouped,
    share,
)
from fvcollapse.blind.plain_values import Average
from fvcollapse.diagnosis.names import NAMED, NONE, UNKNOWN


def all_scores(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Every score of some outcomes."""
    return {
        "cases": len(outcomes),
        "all": ranking(outcomes),
        "by_class": by_class(outcomes),
        "by_cause": by_cause(outcomes),
        "alarms": alarms(outcomes),
        "answers": right_answers(outcomes),
        "sharpness": sharpness(outcomes),
        "calibration": calibration(outcomes),
        "risk_coverage": risk_coverage(outcomes),
        "confusion": confusion(outcomes),
    }


def ranking(outcomes: Sequence[Outcome]) -> dict[str, Average]:
    """First and first two names, the sets and their size."""
    sizes = [max(len(outcome.names), 1) for outcome in outcomes]
    return {
        "top_1": share(best_credit(outcome, outcome.ranked()[:1]) for outcome in outcomes),
        "top_2": share(best_credit(outcome, outcome.ranked()[:2]) for outcome in outcomes),
        "set_holds_truth": share(
            best_credit(outcome, outcome.names or (UNKNOWN,)) for outcome in outcomes
        ),
        "mean_set_size": bootstrapped(lambda i: np.mean(np.array(sizes)[i]), len(sizes)),
    }


def by_class(outcomes: Sequence[Outcome]) -> dict[str, dict[str, Average]]:
    """`ranking` of known single effects, pairs, none and unknown, and the first name of every cause."""
    groups = {
        "single": [outcome for outcome in outcomes if class_of(outcome.truth) == "single"],
        "pair": [outcome for outcome in outcomes if class_of(outcome.truth) == "pair"],
        NONE: [outcome for outcome in outcomes if outcome.truth == NONE],
        UNKNOWN: [outcome for outcome in outcomes if outcome.truth == UNKNOWN],
    }
    return {name: ranking(group) for name, group in groups.items() if group}


def by_cause(outcomes: Sequence[Outcome]) -> dict[str, dict[str, Average]]:
    """First name, and set, of every cause."""
    return {
        truth: {
            "top_1": share(best_credit(outcome, outcome.ranked()[:1]) for outcome in group),
            "set_holds_truth": share(
                best_credit(outcome, outcome.names or (UNKNOWN,)) for outcome in group
            ),
        }
        for truth, group in grouped(outcomes, lambda outcome: outcome.truth)
    }


def right_answers(outcomes: Sequence[Outcome]) -> dict[str, Average]:
    """Share of the answers of each kind (effects named, none, unknown) that are right; half for one of two effects.

    The shares depend on how often the suite hides what.
    """
    kinds = {"named": NAMED, NONE: (NONE,), UNKNOWN: (UNKNOWN,)}
    groups = {
        kind: [outcome for outcome in outcomes if outcome.verdict in of_kind]
        for kind, of_kind in kinds.items()
    }
    return {
        kind: share(credit(outcome.truth, answer_of(outcome)) for outcome in group)
        for kind, group in groups.items()
        if group
    }


def answer_of(outcome: Outcome) -> str:
    """The name that an answer gives: the most probable one that it leaves open, none or unknown."""
    if outcome.verdict not in NAMED:
        return outcome.verdict
    return (*outcome.names, *outcome.ranked())[0]


def confusion(outcomes: Sequence[Outcome]) -> dict[str, dict[str, int]]:
    """{truth: {first name: count}}."""
    return {
        truth: dict(Counter(outcome.ranked()[0] for outcome in group).most_common())
        for truth, group in grouped(outcomes, lambda outcome: outcome.truth)
    }


def alarms(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """False alarms where there is nothing, and what became of causes outside the catalogue."""
    nothing = [outcome for outcome in outcomes if outcome.truth == NONE]
    unknown = [outcome for outcome in outcomes if outcome.truth == UNKNOWN]
    return {
        "false_alarm_on_none": share(outcome.verdict != NONE for outcome in nothing),
        "effect_named_on_none": share(outcome.verdict in NAMED for outcome in nothing),
        "unknown": fate(unknown),
        "single": verdicts(
            [outcome for outcome in outcomes if class_of(outcome.truth) == "single"]
        ),
        "pair": verdicts([outcome for outcome in outcomes if class_of(outcome.truth) == "pair"]),
        "unknown_by_kind": {
            kind: fate(group)
            for kind, group in grouped(unknown, lambda outcome: outcome.kind or "?")
        },
    }


def fate(outcomes: Sequence[Outcome]) -> dict[str, Average]:
    """Shares found, wrongly named and missed of causes outside the catalogue."""
    return {
        "found": share(outcome.verdict == UNKNOWN for outcome in outcomes),
        "wrongly_named": share(outcome.verdict in NAMED for outcome in outcomes),
        "missed": share(outcome.verdict == NONE for outcome in outcomes),
    }


def verdicts(outcomes: Sequence[Outcome]) -> dict[str, Average]:
    """What the verdict says of known causes: the cause alone, another name, none or unknown."""
    named = [answer_of(outcome) if outcome.verdict in NAMED else None for outcome in outcomes]
    right = [name == outcome.truth for name, outcome in zip(named, outcomes, strict=True)]
    return {
        "named": share(right),
        "wrongly_named": share(
            name is not None and not good for name, good in zip(named, right, strict=True)
        ),
        "taken_for_none": share(outcome.verdict == NONE for outcome in outcomes),
        "taken_for_unknown": share(outcome.verdict == UNKNOWN for outcome in outcomes),
    }
