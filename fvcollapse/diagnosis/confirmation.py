"""How strongly a cause may be stated: the tests that the runs of the ladder pass or fail."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.stats import chi2

from fvcollapse.diagnosis.closing import closing, gaps_of
from fvcollapse.diagnosis.evidence import CHECK_PASSED, LARGEST
from fvcollapse.diagnosis.ladder import fold_fractions, fold_remainders
from fvcollapse.diagnosis.names import EFFECT, NAMED, RECALIBRATED, RUNNER_UP, WINNER

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.evidence import Hypothesis
    from fvcollapse.diagnosis.ladder import Ladder
    from fvcollapse.diagnosis.verdict import Verdict

PLAUSIBLE = 0.01  # quantile of its prior beyond which a parameter is at its bound
AT_BOUND = 1.0e-3  # quantile nearer than which to the end of the range a fit has been stopped by it


CONFIRMED, CONSISTENT, NOT_CONFIRMED = "confirmed", "consistent with", "not confirmed"


class FoldTest(NamedTuple):
    """What winner and rival reach in one experiment that took no part; None: the rival was not run.

    Attributes
    ----------
    experiment : str
    held_out : bool
    winner, rival : float
        Fraction closed.
    winner_left, rival_left : float
        Root mean square of the gap that is left, noise included, in standard deviations.
    """

    experiment: str
    held_out: bool
    winner: float
    rival: float | None
    winner_left: float
    rival_left: float | None

    @property
    def is_won(self) -> bool:
        """Whether the winner leaves less than its rival, also where both close all that is beyond the noise."""
        return self.rival_left is None or self.winner_left < self.rival_left


class ConfirmationTests(NamedTuple):
    """The tests of a cause.

    Attributes
    ----------
    rival : str
        Model that the winner must beat: the runner-up, else the re-calibrated one.
    folds : tuple of FoldTest
    has_held_out : bool
        Whether an experiment was held out.
    parameters_inside : bool
        Whether the parameters lie inside the central 98 % of their priors.
    p_value : float
        Predictive check of the gap that remains.
    gain : float
        Fraction of the fitted gap that the winner closes.
    is_alone : bool
        Whether one hypothesis is named, and the data can tell it from all others.
    """

    rival: str
    folds: tuple[FoldTest, ...]
    has_held_out: bool
    parameters_inside: bool
    p_value: float
    gain: float
    is_alone: bool

    @property
    def passes_check(self) -> bool:
        """Whether the gap that remains passes the predictive check."""
        return self.p_value >= CHECK_PASSED

    @property
    def shrinks(self) -> bool:
        """Whether the gap shrinks in every experiment that was held out."""
        return all(fold.winner > 0.0 for fold in self.folds if fold.held_out)

    @property
    def strength(self) -> str:
        """The strongest statement that the tests allow."""
        held_out = [fold.is_won for fold in self.folds if fold.held_out]
        sound = self.parameters_inside and self.passes_check and self.is_alone
        if held_out and all(held_out) and self.shrinks and sound:
            return CONFIRMED
        beats_none = bool(self.folds) and not any(fold.is_won for fold in self.folds)
        if self.gain <= 0.0 or not self.passes_check or beats_none:
            return NOT_CONFIRMED
        return CONSISTENT


def confirm(analysis: "Analysis", verdict: "Verdict", ladder: "Ladder") -> ConfirmationTests | None:
    """The `ConfirmationTests` of the cause; None where none is named or its runs failed."""
    if verdict.kind not in NAMED or WINNER not in ladder.fitted.simulated:
        return None
    rival = RUNNER_UP if RUNNER_UP in ladder.fitted.simulated else RECALIBRATED
    left = fold_remainders(ladder)
    folds = tuple(
        FoldTest(
            *fold,
            fractions[WINNER],
            fractions.get(rival),
            left[fold][WINNER],
            left[fold].get(rival),
        )
        for fold, fractions in fold_fractions(ladder).items()
        if WINNER in fractions
    )
    hypothesis = analysis.evidence.hypotheses[ladder.names[WINNER]]
    return ConfirmationTests(
        rival=rival,
        folds=folds,
        has_held_out=ladder.held_out is not None,
        parameters_inside=all(is_inside(u) for _, u in ladder.fits[WINNER].effects.values()),
        p_value=predictive_check(analysis, ladder, hypothesis),
        gain=closing(ladder.fitted, WINNER, slice(None), analysis.seed).fraction,
        is_alone=is_alone(verdict, ladder.names[WINNER]),
    )


def is_alone(verdict: "Verdict", winner: str) -> bool:
    """Whether one hypothesis is named, and none of its effects looks like another."""
    confused = {name for group in verdict.indistinguishable if len(group) > 1 for name in group}
    return (verdict.kind == EFFECT or "+" in winner) and not confused & set(verdict.effects)


def is_inside(u: "ArrayLike") -> bool:
    """Whether quantiles lie inside the central 98 %, at whose ends a fit stops."""
    return bool(np.all(np.abs(np.asarray(u) - 0.5) < 0.5 - PLAUSIBLE - AT_BOUND))


def predictive_check(analysis: "Analysis", ladder: "Ladder", hypothesis: "Hypothesis") -> float:
    """p-value of what remains in the true runs with the winner."""
    gap = gaps_of(ladder.fitted, WINNER)
    own = analysis.own
    covariance = ladder.fitted.covariance
    if not analysis.controls:
        covariance = covariance + analysis.library.set_up_covariance[own, own]
    covariance = covariance + min(hypothesis.sigma, LARGEST) ** 2 * analysis.kernel
    counted = (analysis.points.kind == "value") | (gap != 0.0)
    factor = cho_factor(covariance[np.ix_(counted, counted)], lower=True, check_finite=False)
    square = gap[counted] @ cho_solve(factor, gap[counted], check_finite=False)
    return float(chi2.sf(square, np.count_nonzero(counted)))
