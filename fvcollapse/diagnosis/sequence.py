"""What each experiment adds: the answer after the first, after the first two, and so on.

Experiments count in the order in which they are given. No run is made: the answer after the first n is that of the
points of these experiments alone, with the controls and the calibrated parameters as in the whole diagnosis.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.diagnosis.analysis import evidence_on
from fvcollapse.diagnosis.gap_map import gap_map
from fvcollapse.diagnosis.mass_balance import mass_balance
from fvcollapse.diagnosis.practical import with_left

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.verdict import Verdict
    from fvcollapse.diagnosis.verdict_model import VerdictModel


def after(analysis: "Analysis", count: int) -> "Analysis":
    """The `Analysis` of the first `count` experiments of an analysis."""
    question = replace(analysis.question, experiments=analysis.experiments[:count])
    points = question.points
    own = slice(0, len(points))
    parts: dict[str, Any] = {
        "covariance": analysis.covariance[own, own],
        "kernel": analysis.kernel[own, own],
        "shift": analysis.shift[own],
        "expected": analysis.expected[own],
    }
    balance = mass_balance(question.experiments, analysis.library.cases)
    changed = evidence_on(analysis.library, parts, points, balance)
    compared, rng = (
        analysis.library.fine[own] - parts["shift"],
        np.random.default_rng([question.seed, 1]),
    )
    changed["gap_map"] = gap_map(points, compared, parts["covariance"], rng)
    for name in ("measurement", "numerical", "calibration"):
        parts[name] = getattr(analysis, name)[own, own]
    return with_left(replace(analysis, question=question, **parts, **changed))


def sequence(
    analysis: "Analysis",
    judge: "Callable[[Analysis], tuple[Analysis, Verdict, VerdictModel | None]]",
) -> "list[tuple[tuple[str, ...], Verdict]]":
    """[(names of the experiments, Verdict)] after the first, the first two, …, all but the last.

    Parameters
    ----------
    analysis : Analysis
    judge : callable
        (analysis) -> (Analysis, Verdict, model); see `diagnose.judge`.
    """
    answers = []
    for count in range(1, len(analysis.experiments)):
        part, verdict, _ = judge(after(analysis, count))
        answers.append((tuple(one.name for one in part.experiments), verdict))
    return answers
