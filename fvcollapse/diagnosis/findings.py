"""What was found, as a `Report`: gap map, verdict, candidates, ladder, and what limits them."""

from math import inf

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.stats import chi2

from fvcollapse.case.case import describe_keys
from fvcollapse.diagnosis import report as form
from fvcollapse.diagnosis.analysis import set_up_covariance
from fvcollapse.diagnosis.controls import SLOPE_APART
from fvcollapse.diagnosis.mass_balance import CHANGES, LEAST_FRAMES, VIEW_EFFECT
from fvcollapse.diagnosis.names import NAMED, UNKNOWN
from fvcollapse.diagnosis.new_effects import new_hypotheses
from fvcollapse.diagnosis.oddities import unseen_origins
from fvcollapse.diagnosis.reduction import closing, fold_fractions, gaps_of, with_simulated
from fvcollapse.diagnosis.report import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.diagnosis.separability import EQUIVALENT
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.measure.quantities import CURVES

GRAINS_OFF = 3.0  # standard deviations of a mass balance from which it is told
FAR = 2.0  # standard deviations of a calibrated parameter that are worth a word
PLAUSIBLE = 0.01  # quantile of its prior beyond which a parameter is at its bound
AT_BOUND = 1.0e-3  # quantile nearer than which to the end of the range a fit has been stopped by it
ENDS = 0.002  # quantiles of a value that is told stay inside: some priors have no end
LIKE_MISCALIBRATION = 0.2  # share of the null test that an effect wins
CHECK_PASSED = 0.05  # p-value of the predictive check
SIZE_UNITS = "standard uncertainties beyond the noise"


def report_of(analysis, verdict, ladder, choices, baseline, cost, model=None):
    """The `Report` of a diagnosis.

    Parameters
    ----------
    analysis : Analysis
    verdict : Verdict
    ladder : Ladder
    choices : list of Choice
        What to measure next, the best first.
    baseline : Case
    cost : report.Cost
    model : VerdictModel, optional
        What the verdict was made with.
    """
    held = ladder.held_out.points.experiments if ladder.held_out else ()
    upcoming = [next_experiment(choice) for choice in choices]
    return form.Report(
        experiments=[one.name for one in analysis.experiments],
        held_out=[one.name for one in held],
        baseline_case=baseline.to_toml(),
        where=regions_of(analysis),
        by_observable=levels_of(analysis),
        verdict=form.Verdict(
            kind=verdict.kind,
            effects=list(verdict.effects),
            indistinguishable=[list(group) for group in verdict.indistinguishable],
            probability=dict(verdict.probability),
            set=list(verdict.set),
        ),
        candidates=candidates(analysis, verdict),
        reduction=reductions(ladder, analysis.seed) if verdict.kind in NAMED else None,
        next_experiment=upcoming[0] if upcoming else None,
        cost=cost,
        details=form.Details(
            expected=expected(analysis),
            set_ups={one.name: set_up(one) for one in (*analysis.experiments, *held)},
            comparisons=comparisons(analysis, ladder),
            shares=[form.Share(**share._asdict()) for share in analysis.gap_map.shares],
            budget=budget(analysis),
            grains=grain_words(analysis.evidence.balance),
            hypotheses=hypotheses(analysis, verdict),
            separability=separability(analysis, verdict),
            ladder=rungs(analysis, ladder),
            confirmation=confirmation(analysis, verdict, ladder),
            alternatives=upcoming[1:],
            limits=[*limits(analysis, ladder), model_words(model, analysis.evidence)],
        ),
    )


# -- where ---------------------------------------------------------------------------------------


def regions_of(analysis):
    """Significant regions of the gap."""
    found, regions = analysis.gap_map, []
    for each in found.regions:
        regions.append(
            form.Region(
                experiment=each.experiment,
                observable=each.observable,
                t_range=each.t_range,
                x_range=each.x_range,
                gap=each.gap,
                units=each.units,
                significance=float(np.abs(found.z[each.points]).max()),
                gap_sd=each.uncertainty,
                p_value=each.p_value,
                words=each.text,
            )
        )
    return regions


def levels_of(analysis):
    """Size of the gap of every observable."""
    observable = analysis.points.observable
    return {
        each.observable: form.ObservableGap(
            rms_gap=each.rms,
            combined_uncertainty=each.combined,
            ratio=each.ratio,
            units=each.units,
            points=int(np.count_nonzero(observable == each.observable)),
        )
        for each in analysis.gap_map.by_observable
        if not each.experiment
    }


def expected(analysis):
    """Observable -> root mean square of the gap that the controls let expect, SI; empty without controls."""
    if not analysis.controls:
        return {}
    observable = analysis.points.observable
    return {
        str(name): rms(analysis.shift[observable == name]) for name in dict.fromkeys(observable)
    }


def set_up(experiment):
    """The set-up of an experiment."""
    geometry = experiment.settings.geometry
    width = geometry.channel_width
    return form.SetUp(
        title=experiment.settings.title,
        source=experiment.settings.source,
        slope_angle_deg=geometry.slope_angle_deg,
        height_0=geometry.height_0,
        length_0=geometry.length_0,
        channel_width=None if width is None or width == inf else width,
    )


def comparisons(analysis, ladder):
    """Every observable of every experiment with all models."""
    combined = np.sqrt(np.diag(analysis.covariance))
    region = np.full(len(analysis.points), -1)
    for number, each in enumerate(analysis.gap_map.regions):
        region[each.points] = number
    found = group_comparisons(ladder.fitted, combined, region, analysis.gap_map.z)
    if ladder.held_out is not None:
        group = ladder.held_out
        nowhere = np.full(len(group.points), -1)
        found += group_comparisons(group, np.sqrt(np.diag(group.covariance)), nowhere)
    return found


def group_comparisons(group, combined, region, baseline=None):
    """The `Comparison`s of a group.

    Parameters
    ----------
    group : Group
    combined : (n,) array
        Standard uncertainties.
    region : (n,) int array
        -1: in none.
    baseline : (n,) array, optional
        z of the baseline, as the map of the gap has it.
    """
    points, found = group.points, []
    phase = points.phase
    z = {model: gaps_of(group, model) / combined for model in group.simulated}
    if baseline is not None:
        z[BASELINE] = baseline
    for block in points.blocks:
        own = slice(block.start, block.stop)
        found.append(
            form.Comparison(
                experiment=block.experiment,
                observable=block.observable,
                units=block.units,
                time=None if np.isnan(block.time).all() else block.time,
                x=None if np.isnan(block.x).all() else block.x,
                measured=points.measured[own],
                sigma=points.sigma[own],
                combined=combined[own],
                simulated={model: values[own] for model, values in group.simulated.items()},
                z={model: values[own] for model, values in z.items()},
                kind=block.kind,
                region=[int(n) if n >= 0 else None for n in region[own]],
                phase=phase[own].tolist(),
            )
        )
    return found


def budget(analysis):
    """Observable -> source of uncertainty -> its root mean square."""
    points = analysis.points
    sources = {
        "measurement, single points": points.sigma**2,
        "measurement, whole run": np.diag(analysis.measurement) - points.sigma**2,
        "grid": np.diag(analysis.numerical),
        "calibrated parameters and set-up": np.diag(analysis.calibration),
    }
    if analysis.controls:
        sources = {
            "measurement and grid": np.diag(analysis.measurement + analysis.numerical),
        }
        rest = np.diag(analysis.covariance) - sources["measurement and grid"]
        sources["parameters, set-up and discrepancy, after the controls"] = rest
    observable = points.observable
    return {
        str(name): {
            source: float(np.sqrt(np.mean(np.maximum(values[observable == name], 0.0))))
            for source, values in sources.items()
        }
        for name in dict.fromkeys(observable)
    }


# -- which ---------------------------------------------------------------------------------------


def candidates(analysis, verdict):
    """Every effect with its probability and the parameters that fit best."""
    found, units = {}, units_of_keys()
    for name in analysis.responses:
        hypothesis = analysis.evidence.hypotheses[name]
        closure = analysis.library.closures[name][hypothesis.variant[0]]
        found[name] = form.Candidate(
            probability=float(verdict.probability[name]),
            log_evidence=hypothesis.log_evidence,
            parameters=parameters(closure, (hypothesis.u, hypothesis.low, hypothesis.high), units),
            plausible=plausible(hypothesis),
        )
    return found


def plausible(hypothesis):
    """Whether the best parameters lie inside the central 98 % of their priors."""
    return is_inside(hypothesis.u)


def is_inside(u):
    """Whether quantiles lie inside the central 98 %, at whose ends a fit stops."""
    return bool(np.all(np.abs(np.asarray(u) - 0.5) < 0.5 - PLAUSIBLE - AT_BOUND))


def parameters(closure, quantiles, units):
    """{name: `Parameter`} of a closure at quantiles: best, and the ends of the interval if given."""
    values = [closure.values(np.clip(u, ENDS, 1.0 - ENDS)) for u in quantiles]
    best, *ends = values
    found = {}
    for name, value in best.items():
        low, high = (end[name] for end in ends) if ends else (None, None)
        found[name] = form.Parameter(
            value=value,
            low=low,
            high=high,
            units=units[f"effects.{closure.effect}.{name}"],
            prior=form.PriorRange(**CATALOGUE[closure.effect].priors[name]._asdict()),
        )
    return found


def units_of_keys():
    """{key of the case: unit}."""
    return {info.name: info.unit for info in describe_keys()}


def hypotheses(analysis, verdict):
    """All hypotheses of the evidence."""
    wins = analysis.null_wins
    found = {}
    for name, each in analysis.evidence.hypotheses.items():
        keys = [
            key
            for part in name.split("+")
            if part in CATALOGUE
            for key in CATALOGUE[part].absorbed_in
        ]
        found[name] = form.Hypothesis(
            log_evidence=each.log_evidence,
            log_evidence_wide=each.log_evidence_wide,
            conformal_p=verdict.conformal.get(name),
            predictive_p=each.p_value,
            like_miscalibration=name in CATALOGUE and wins.get(name, 0.0) >= LIKE_MISCALIBRATION,
            absorbed_in=list(dict.fromkeys(keys)),
        )
    return found


def separability(analysis, verdict):
    """How alike the effects look; None with fewer than two."""
    found = analysis.separability
    if len(found.names) < 2:
        return None
    grouped = {name for group in found.classes for name in group}
    classes = [list(group) for group in found.classes]
    classes += [[name] for name in found.names if name not in grouped]
    return form.Separability(
        names=list(found.names),
        cosine=found.cosine.tolist(),
        distance_squared=found.distance.tolist(),
        unique_snr=found.unique_snr.tolist(),
        threshold=EQUIVALENT,
        classes=classes,
    )


# -- how far -------------------------------------------------------------------------------------


def reductions(ladder, seed):
    """The gap before and after the winner was added; None if its runs failed."""
    if WINNER not in ladder.fitted.simulated:
        return None
    folds = fold_fractions(ladder)
    left_out = [own[WINNER] for (_, held), own in folds.items() if WINNER in own and not held]
    held = [own[WINNER] for (_, held), own in folds.items() if WINNER in own and held]
    held_out = None
    if ladder.held_out is not None and WINNER in ladder.held_out.simulated:
        held_out = group_reduction(ladder.held_out, seed, held)
    return form.Reductions(fitted=group_reduction(ladder.fitted, seed, left_out), held_out=held_out)


def group_reduction(group, seed, values):
    """The `Reduction` of a group of experiments; the range of the whole also covers `values`."""
    observable = group.points.observable
    everything = np.ones(len(group.points), bool)
    overall = closing(group, BASELINE, WINNER, everything, seed, values=values)
    by_observable = {}
    for block in group.points.blocks:
        if block.observable not in by_observable:
            rows = observable == block.observable
            part = closing(group, BASELINE, WINNER, rows, seed, in_units=True)
            by_observable[block.observable] = closed(part, block.units)
    return form.Reduction(overall=closed(overall, SIZE_UNITS), by_observable=by_observable)


def closed(part, units):
    """A `Closing` as the report has it."""
    return form.Closed(
        before=part.before,
        after=part.after,
        fraction_closed=part.fraction,
        interval=part.interval,
        units=units,
    )


def rungs(analysis, ladder):
    """The models of the ladder."""
    found, units = [], units_of_keys()
    folds = fold_fractions(ladder)
    for model, fit in ladder.fits.items():
        if model not in ladder.fitted.simulated:
            continue
        held = None
        if ladder.held_out is not None and model in ladder.held_out.simulated:
            values = [own[model] for (_, held), own in folds.items() if model in own and held]
            held = misfit(ladder.held_out, model, analysis.seed, values)
        values = [own[model] for (_, held), own in folds.items() if model in own and not held]
        found.append(
            form.Rung(
                model=model,
                effects=sorted(fit.effects),
                fitted=misfit(
                    ladder.fitted, model, analysis.seed, values, ladder.predicted.get(model)
                ),
                held_out=held,
                parameters={
                    f"{name}.{key}": value
                    for name, (closure, u) in fit.effects.items()
                    for key, value in parameters(closure, (u,), units).items()
                },
                calibrated={} if model == BASELINE else calibrated(ladder.quantities, fit.z, units),
            )
        )
    return found


def calibrated(quantities, z, units):
    """{key: `Parameter`} of the calibrated parameters; each once, though experiments may differ."""
    found = {}
    for quantity, shift in zip(quantities, z, strict=True):
        name = quantity.key
        if name in found:
            name = f"{name} ({', '.join(quantity.experiments)})"
        found[name] = form.Parameter(
            value=quantity.value(shift),
            low=None,
            high=None,
            units=units[quantity.key],
            prior=form.PriorRange(kind="normal", first=quantity.mean, second=quantity.sd),
        )
    return found


def misfit(group, model, seed, values=(), predicted=None):
    """The `Misfit` of a model over a group."""
    z = gaps_of(group, model) / np.sqrt(np.diag(group.covariance))
    everything = np.ones(len(z), bool)
    fraction = interval = foreseen = None
    if model != BASELINE:
        found = closing(group, BASELINE, model, everything, seed, values=values)
        fraction, interval = found.fraction, found.interval
        if predicted is not None:
            again = with_simulated(group, {model: predicted})
            foreseen = closing(again, BASELINE, model, everything, seed).fraction
    return form.Misfit(
        rms=rms(z),
        fraction_closed=fraction,
        interval=interval,
        predicted=foreseen,
        by_experiment={name: rms(z[group.points.of(name)]) for name in group.points.names},
    )


def rms(z):
    """Root mean square."""
    return float(np.sqrt(np.mean(z**2)))


def confirmation(analysis, verdict, ladder):
    """How strong the wording may be; None where no effect is named."""
    if verdict.kind not in NAMED or WINNER not in ladder.fitted.simulated:
        return None
    rival = RUNNER_UP if RUNNER_UP in ladder.fitted.simulated else RECALIBRATED
    folds, beaten = [], {}
    for (name, held), own in fold_fractions(ladder).items():
        if WINNER in own:
            fold = form.Fold(
                experiment=name, winner=own[WINNER], runner_up=own.get(rival), held_out=held
            )
            folds.append(fold)
            beaten[name, held] = rival not in own or own[WINNER] > own[rival]
    hypothesis = analysis.evidence.hypotheses[ladder.names[WINNER]]
    inside = all(is_inside(u) for _, u in ladder.fits[WINNER].effects.values())
    p_value = predictive_check(analysis, ladder, hypothesis)
    gain = [
        closing(ladder.fitted, BASELINE, model, slice(None), analysis.seed).fraction
        for model in (WINNER, rival)
    ]
    reasons = confirmation_reasons(ladder, beaten, rival, inside, p_value)
    shrinks = all(fold.winner > 0.0 for fold in folds if fold.held_out)
    if not shrinks:
        reasons.append("the gap of an experiment held out does not shrink")
    alone = verdict.kind == "effect" or "+" in ladder.names[WINNER]
    apart = not any(len(group) > 1 for group in verdict.indistinguishable) or not any(
        name in group for group in verdict.indistinguishable for name in verdict.effects
    )
    held = [won for (_, held), won in beaten.items() if held]
    if held and all(held) and shrinks and inside and p_value >= CHECK_PASSED and alone and apart:
        wording = "confirmed"
    elif gain[0] <= 0.0 or p_value < CHECK_PASSED or (beaten and not any(beaten.values())):
        wording = "not confirmed"
    else:
        wording = "consistent with"
    return form.Confirmation(wording=wording, reasons=reasons, folds=folds)


def confirmation_reasons(ladder, beaten, rival, inside, p_value):
    """The tests of the wording, in words."""
    other = "the runner-up" if rival == RUNNER_UP else "the re-calibrated model"
    reasons = []
    for held, words in ((True, "held out"), (False, "left out in turn")):
        own = [won for (_, was_held), won in beaten.items() if was_held == held]
        if own:
            reasons.append(f"it beats {other} in {sum(own)} of {len(own)} experiments {words}")
    if ladder.held_out is None:
        reasons.append("no experiment was held out")
    place = "inside" if inside else "at the bound of"
    reasons.append(f"its parameters are {place} what was known of them before")
    check = "passes" if p_value >= CHECK_PASSED else "does not pass"
    reasons.append(f"what remains {check} the predictive check (p = {p_value:.2g})")
    return reasons


def predictive_check(analysis, ladder, hypothesis):
    """p-value of what remains in the true runs with the winner."""
    gap = gaps_of(ladder.fitted, WINNER)
    own = analysis.own
    covariance = ladder.fitted.covariance
    if not analysis.controls:
        covariance = covariance + set_up_covariance(analysis.library)[own, own]
    covariance = covariance + hypothesis.sigma**2 * analysis.kernel
    counted = (analysis.points.kind == "value") | (gap != 0.0)
    factor = cho_factor(covariance[np.ix_(counted, counted)], lower=True, check_finite=False)
    square = gap[counted] @ cho_solve(factor, gap[counted], check_finite=False)
    return float(chi2.sf(square, np.count_nonzero(counted)))


def next_experiment(choice):
    """A `Choice` as the report has it."""
    finite = {key: value for key, value in choice.candidate.changes.items() if value < inf}
    return form.NextExperiment(
        description=choice.candidate.words,
        separates=list(choice.separates),
        expected_gain=choice.gain,
        set_up=finite,
        repeats=choice.repeats,
    )


def grain_words(balance):
    """What a `MassBalance` says, one sentence for each part that is off; none where all grains are in view."""
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
            told = meaning.format(size=size, side=side, pace=pace, lost=lost)
            words.append(f"By their own mass balance, {told}")
    return words


# -- limits --------------------------------------------------------------------------------------


def limits(analysis, ladder):
    """What this diagnosis cannot say, one sentence each."""
    words = []
    if analysis.library.left_out:
        told = "; ".join(f"{name}: {why}" for name, why in analysis.library.left_out.items())
        words.append(f"Not compared: {told}.")
    weak = analysis.separability.insufficient
    if weak:
        words.append(
            "Too weak, or too like others, for these data to name for sure (signal-to-noise ratio of "
            f"its own below 3): {', '.join(weak)}."
        )
    like = [
        name
        for name, share in analysis.null_wins.items()
        if name in CATALOGUE and share >= LIKE_MISCALIBRATION
    ]
    if like:
        words.append(f"Calibrated parameters that are off look like: {', '.join(like)}.")
    if ladder.held_out is None:
        words.append("No experiment was held out, so no cause can be confirmed.")
    if analysis.evidence.balance is None:
        words.append(
            f"The profiles were not weighed: no experiment has {LEAST_FRAMES} of different reach that show "
            "all grains."
        )
    words += unseen_origins(analysis.experiments)
    words += far_words(ladder)
    if analysis.controls:
        words.append(control_words(analysis))
        if ladder.held_out is not None:
            words.append("Held-out experiments are judged without what the controls show.")
    for one in (*analysis.experiments, *analysis.controls):
        missing = default_uncertainties(one)
        if missing:
            words.append(
                f"{one.name} does not state the standard deviation of {', '.join(missing)}: the "
                "defaults hold (`fvcollapse keys --experiment`)."
            )
    return words + [f"A run of the ladder failed: {failure}." for failure in ladder.failures]


def far_words(ladder):
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


def model_words(model, evidence):
    """What the probabilities rest on."""
    if model is None:
        return (
            "Probabilities are tempered evidences and not calibrated: the verdict model was not fitted "
            "to these effects, to controls, or to so few measured values."
        )
    words = (
        "Probabilities hold for collapses like those the verdict was trained on, and for the effects "
        "of the catalogue."
    )
    if not model.is_of_this_solver:
        words += f" It was trained with solver {model.solver}, not the present one."
    new = [name for name in new_hypotheses(evidence, model.classes) if "+" not in name]
    if new:
        which = "each of them" if len(new) > 1 else "this effect"
        words += (
            f" The verdict was not trained on {', '.join(new)}: the probability of {which} is a tempered "
            "evidence and not calibrated. The other effects are compared with each other as without it."
        )
    return words


def control_words(analysis):
    """What the controls taught."""
    learned = analysis.discrepancy
    factors = ", ".join(f"{name} {factor:.2g}" for name, factor in learned.factors.items())
    names = ", ".join(one.name for one in analysis.controls)
    return (
        f"Gaps are judged after what the controls ({names}) show; discrepancy in units of the "
        f"calibration uncertainty: {factors}; correlation {learned.correlation:.2f} between runs whose "
        f"slopes differ by {SLOPE_APART:g}°."
    )


def default_uncertainties(experiment):
    """Measured observables whose standard deviation is a default."""
    stated, names = experiment.settings.uncertainty, []
    for name, curve in experiment.curves.items():
        key = CURVES[name].uncertainty
        default = experiment.standard_deviation(key)
        if getattr(stated, key) is None and np.all(curve.sigma == default):
            names.append(name)
    return names
