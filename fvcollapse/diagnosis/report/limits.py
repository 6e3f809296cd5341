"""The limits of a diagnosis, and the tests of its cause, in words."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.controls import SLOPE_APART
from fvcollapse.diagnosis.mass_balance import CHANGES, LEAST_FRAMES, VIEW_EFFECT
from fvcollapse.diagnosis.names import RECALIBRATED, RUNNER_UP, UNKNOWN, WINNER
from fvcollapse.diagnosis.new_effects import new_hypotheses
from fvcollapse.diagnosis.report.candidates import LIKE_MISCALIBRATION
from fvcollapse.diagnosis.report.words import hypotheses_listed, hypothesis_name, listed
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.quantities import CURVES, observable_words

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.confirmation import ConfirmationTests
    from fvcollapse.diagnosis.controls import Discrepancy
    from fvcollapse.diagnosis.evidence import Evidence
    from fvcollapse.diagnosis.ladder import Ladder
    from fvcollapse.diagnosis.mass_balance import MassBalance
    from fvcollapse.diagnosis.verdict_model import VerdictModel
    from fvcollapse.measure.experiment import Experiment

GRAINS_OFF = 3.0  # standard deviations from which a mass balance is reported
FAR = 2.0  # standard deviations of a calibrated parameter that are worth a word


def grain_words(balance: "MassBalance | None") -> list[str]:
    """The mass-balance check, one sentence for each part that fails it; none where all grains are in view."""
    if balance is None:
        return []
    meanings = (
        (
            "the measured profiles hold {size} {side} than the column from the first frame on: a scale, the bed "
            "or the column is not as stated, or heights were read vertically.",
            CHANGES[UNKNOWN],
        ),
        (
            "the profiles beyond the gate hold {size} {side} than have left the column, as if they were seen "
            "where the grains are {pace} than on average across the channel{lost}.",
            CHANGES[VIEW_EFFECT],
        ),
    )
    words, deviations = [], np.sqrt(np.diag(balance.covariance))
    for mean, sd, (meaning, (_, spread)) in zip(balance.mean, deviations, meanings, strict=True):
        if abs(mean) > GRAINS_OFF * sd and balance.log_odds(spread) > 0.0:
            side, pace, lost = (
                ("more", "faster", "") if mean > 0.0 else ("less", "slower", ", or some were lost")
            )
            size = f"{100.0 * abs(mean):.1f} ± {100.0 * sd:.1f} %"
            finding = meaning.format(size=size, side=side, pace=pace, lost=lost)
            words.append(f"By their own mass balance, {finding}")
    return words


def limits(analysis: "Analysis", ladder: "Ladder") -> list[str]:
    """Limits of this diagnosis, one sentence each."""
    words = []
    if analysis.library.left_out:
        left_out = analysis.library.left_out.items()
        reasons = "; ".join(f"{hypothesis_name(name)}: {why}" for name, why in left_out)
        words.append(f"Not compared: {reasons}.")
    weak = analysis.separability.insufficient
    if weak:
        words.append(
            "Less than 3 standard uncertainties of these effects are visible beside the others, so that these data "
            f"cannot name them with confidence: {hypotheses_listed(weak)}."
        )
    like = [
        name
        for name, share in analysis.null_wins.items()
        if name in CATALOGUE and share >= LIKE_MISCALIBRATION
    ]
    if like:
        words.append(f"A wrong calibration of the parameters looks like {hypotheses_listed(like)}.")
    if ladder.held_out is None:
        words.append("No experiment was held out, so no cause can be confirmed.")
    if analysis.evidence.balance is None:
        words.append(
            f"There is no mass-balance check: no experiment has {LEAST_FRAMES} profiles of different reach "
            "that show all grains."
        )
    words += unseen_origins(analysis.experiments)
    words += far_words(ladder)
    if analysis.discrepancy is not None:
        words.append(control_words(analysis.discrepancy, analysis.controls))
        if ladder.held_out is not None:
            words.append(
                "Held-out experiments are judged without the model error learned from the controls."
            )
    words += default_words((*analysis.experiments, *analysis.controls))
    return words + [f"A run of the ladder failed: {failure}." for failure in ladder.failures]


def far_words(ladder: "Ladder") -> list[str]:
    """One sentence for each model whose re-calibration moved a parameter by more than two standard deviations."""
    names = {
        RECALIBRATED: "The re-calibration without any effect",
        WINNER: "That with the first effect",
        RUNNER_UP: "That with the second effect",
    }
    words = []
    for model, name in names.items():
        if model not in ladder.fits:
            continue
        pairs = zip(ladder.quantities, ladder.fits[model].z, strict=True)
        moved = ", ".join(f"{quantity.key} by {z:+.1f}" for quantity, z in pairs if abs(z) > FAR)
        if moved:
            words.append(
                f"{name} moves {moved} standard deviations of what was believed (3 are allowed)."
            )
    return words


def model_words(model: "VerdictModel | None", evidence: "Evidence") -> str:
    """The basis of the probabilities."""
    if model is None:
        return (
            "Probabilities are tempered evidences and not calibrated: the verdict layer was not fitted "
            "to these effects, to so few measured values, or on cells as coarse as these."
        )
    words = (
        "Probabilities hold for collapses like those the verdict layer was fitted to, and for the effects "
        "of the catalogue."
    )
    if not model.is_of_this_solver:
        words += f" The layer was fitted with solver {model.solver}, not the present one."
    new = [name for name in new_hypotheses(evidence, model.classes) if "+" not in name]
    if new:
        which = "each of them" if len(new) > 1 else "this effect"
        words += (
            f" The verdict layer was not fitted to {hypotheses_listed(new)}: the probability of {which} is a tempered "
            "evidence and not calibrated. The other effects are compared with each other as without it."
        )
    return words


def control_words(learned: "Discrepancy", controls: "Iterable[Experiment]") -> str:
    """The model error learned from the controls."""
    factors = ", ".join(
        f"{observable_words(name)} {factor:.2g}" for name, factor in learned.factors.items()
    )
    names = ", ".join(one.name for one in controls)
    shared = hypotheses_listed(learned.effects)
    physics = (
        f" They show {shared} in all experiments alike, or something like it." if shared else ""
    )
    return (
        f"The model error learned from the controls ({names}) has been subtracted; discrepancy in units of the "
        f"calibration uncertainty: {factors}; correlation {learned.correlation:.2f} between runs whose "
        f"slopes differ by {SLOPE_APART:g}°.{physics}"
    )


def default_words(experiments: "Iterable[Experiment]") -> list[str]:
    """One sentence for each experiment with standard deviations that are defaults."""
    words = []
    for experiment in experiments:
        if names := default_uncertainties(experiment):
            words.append(
                f"{experiment.name} does not state the standard deviation of {listed(map(observable_words, names))}: "
                "the defaults hold, which the command keys --experiment prints."
            )
    return words


def default_uncertainties(experiment: "Experiment") -> list[str]:
    """Measured observables whose standard deviation is a default."""
    stated, names = experiment.settings.uncertainty, []
    for name, curve in experiment.curves.items():
        key = CURVES[name].uncertainty
        default = experiment.standard_deviation(key)
        if getattr(stated, key) is None and np.all(curve.sigma == default):
            names.append(name)
    return names


def unseen_origins(experiments: "Iterable[Experiment]") -> list[str]:
    """A warning of run-outs whose origin of X nothing shows; one sentence, or none."""
    alone = [
        one.name
        for one in experiments
        if not {"front", "profiles"} & set(one.curves)
        and any(scalar.name == "runout" for scalar in one.scalars)
    ]
    if not alone:
        return []
    return [
        f"The run-out of {', '.join(alone)} stands alone: without a front or a profile at the start nothing shows "
        "whether X was counted from the back wall, as it must be, or from the gate."
    ]


def confirmation_reasons(tests: "ConfirmationTests") -> list[str]:
    """The `ConfirmationTests` of a cause in words."""
    rival = "the runner-up" if tests.rival == RUNNER_UP else "the re-calibrated model"
    reasons = []
    for held_out, words in ((True, "held out"), (False, "left out in turn")):
        won = [fold.is_won for fold in tests.folds if fold.held_out == held_out]
        if won:
            reasons.append(f"it beats {rival} in {sum(won)} of {len(won)} experiments {words}")
    if not tests.has_held_out:
        reasons.append("no experiment was held out")
    place = "inside" if tests.parameters_inside else "at the end of"
    reasons.append(f"the strength and constants that fit best are {place} their plausible range")
    check = "looks like noise" if tests.passes_check else "is more than noise"
    reasons.append(f"what remains of the gap {check} (p = {tests.p_value:.2g})")
    if not tests.shrinks:
        reasons.append("the gap of an experiment held out does not shrink")
    return reasons
