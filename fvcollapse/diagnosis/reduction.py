"""How far the gap shrinks when an effect is really added: a ladder of models, each run by the solver.

    G0 baseline as given,  G1 re-calibrated,  G2 winner and re-calibrated,  G2' runner-up and re-calibrated

Re-calibration is Gauss-Newton on the emulator: parameters of the effects inside the central 98 % of their
priors, calibrated parameters of the material held by their uncertainty; one true run of every experiment
verifies it. Held-out experiments take no part in it. Without any, each experiment is left out in turn.

The size of a gap is its root mean square beyond the noise: with z = gap / sd, sd that of measurement and
discretisation, sqrt(max(0, mean(z^2) - 1)); in units of an observable the same with gap and sd. Fraction
closed = 1 - size after / size before. Its range covers what another realisation of the noise would give
(90 %) and the values of all experiments that were left or held out.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.special import ndtri

from fvcollapse.diagnosis.analysis import ORDER, sensitivities
from fvcollapse.diagnosis.controls import condition
from fvcollapse.diagnosis.covariance import measurement_covariance, numerical_covariance
from fvcollapse.diagnosis.effect_library import (
    CALIBRATED,
    REFINEMENT,
    Reading,
    baseline_cases,
    refined,
    value_of,
    with_nuisances,
)
from fvcollapse.diagnosis.gap_map import beyond_bounds
from fvcollapse.diagnosis.names import NONE, effects_of
from fvcollapse.diagnosis.points import choose_points
from fvcollapse.diagnosis.report import BASELINE, RECALIBRATED, RUNNER_UP, WINNER
from fvcollapse.errors import CaseError

LEAST_QUANTILE = 0.01  # of the prior of a parameter of an effect, and 1 - this the largest
MOST_DEVIATIONS = 3.0  # of a calibrated parameter from its value
REALISATIONS = 400  # of the noise
SMALLEST_SIZE = 1.0e-3  # relative to the noise: no gap to close
RANGE = (5.0, 95.0)  # percentiles


class Fit(NamedTuple):
    """A model re-calibrated on the emulator.

    Attributes
    ----------
    effects : dict
        Effect -> (`Closure`, quantiles u (d,)).
    z : (n,) array
        Of the calibrated parameters of the material, in standard deviations.
    """

    effects: dict
    z: np.ndarray


class Group(NamedTuple):
    """Experiments that are compared with true runs.

    Attributes
    ----------
    points : Points
    cases : dict
        Experiment -> `Case` on the coarser grid.
    shifts : dict
        Model -> discrepancy (n,) that its gaps to the controls let expect; zero without controls.
    covariance : (n, n) array
        Of measurement and discretisation; with controls also of set-up and discrepancy, given their gaps.
    simulated : dict
        Model -> (n,) values.
    """

    points: object
    cases: dict
    shifts: dict
    covariance: np.ndarray
    simulated: dict


@dataclass(frozen=True)
class Ladder:
    """The models and what they give.

    Attributes
    ----------
    fits : dict
        Model (key of `report.RUNGS`) -> `Fit`; a model whose runs failed is not there.
    names : dict
        Model -> name of its hypothesis ("" for the first two).
    quantities : tuple of Nuisance
        The calibrated parameters that `Fit.z` is of.
    fitted : Group
    held_out : Group or None
    predicted : dict
        Model -> (n,) values of the emulator on the points that were fitted.
    left_out : dict
        Experiment -> {model: (n,) values} of models calibrated without it.
    failures : tuple of str
    """

    fits: dict
    names: dict
    quantities: tuple
    fitted: Group
    held_out: Group | None
    predicted: dict
    left_out: dict
    failures: tuple


def climb(analysis, runner, winner=None, runner_up=None, hold_out=(), case=None, cell_size=None):
    """The `Ladder`.

    Parameters
    ----------
    analysis : Analysis
    runner : Runner
    winner, runner_up : str, optional
        Names of hypotheses of the evidence; without a winner there are the first two models only.
    hold_out : sequence of Experiment
    case, cell_size
        As for `analyse`.

    Raises
    ------
    NumericalError
        The baseline of a held-out experiment fails.
    """
    problem = Recalibration(analysis)
    names = {BASELINE: "", RECALIBRATED: ""}
    names |= {model: name for model, name in ((WINNER, winner), (RUNNER_UP, runner_up)) if name}
    everything = np.ones(len(analysis.library.points), bool)
    fits = {model: problem.fit(name, everything) for model, name in names.items()}
    fits[BASELINE] = Fit({}, np.zeros(len(problem.quantities)))
    held = baseline_cases(hold_out, case, cell_size)
    everyone, cases = (*analysis.experiments, *hold_out), analysis.library.cases | held
    wanted, refused = true_runs(problem, fits, everyone, cases)
    for model in refused:
        del fits[model], names[model]
    wanted |= {("coarse", None, one.name): (one, held[one.name]) for one in hold_out}
    folds = analysis.experiments if not hold_out and len(analysis.experiments) > 1 else ()
    left_out, impossible = fold_runs(problem, names, folds)
    seen, failures = runner.observations(wanted | left_out)
    failures = failures | impossible
    reading = Reading(analysis.points, seen, failures)
    held_out = held_out_group(analysis, hold_out, held, seen, failures, fits) if hold_out else None
    told = [f"{model}: {error}" for model, error in refused.items()]
    told += [f"{model} ({name}): {error}" for (model, _, name), error in failures.items()]
    return Ladder(
        fits=fits,
        names=names,
        quantities=problem.quantities,
        fitted=fitted_group(problem, reading, fits),
        held_out=held_out,
        predicted={model: problem.predicted(fit)[analysis.own] for model, fit in fits.items()},
        left_out=left_out_values(reading, folds, names),
        failures=tuple(told),
    )


def true_runs(problem, fits, experiments, cases):
    """({label: (experiment, case)} of all models, {model: CaseError} of effects that cannot be together)."""
    wanted, refused = {}, {}
    for model, fit in fits.items():
        try:
            wanted |= {
                (model, None, one.name): (one, problem.case(fit, one, cases[one.name]))
                for one in experiments
            }
        except CaseError as error:
            refused[model] = error
    return wanted, refused


def fold_runs(problem, names, folds):
    """Runs of the models calibrated without each experiment in turn, and why others cannot be.

    Returns
    -------
    (dict, dict)
        {label: (experiment, case)}, {label: CaseError}.
    """
    points, wanted, refused = problem.library.points, {}, {}
    for one in folds:
        rest = np.ones(len(points), bool)
        rest[points.of(one)] = False
        for model, name in names.items():
            if model != BASELINE:
                fit = problem.fit(name, rest)
                label = without(model, one)
                try:
                    wanted[label] = one, problem.case(fit, one, problem.library.cases[one.name])
                except CaseError as error:
                    refused[label] = error
    return wanted, refused


def without(model, experiment):
    """Label of the run of an experiment with a model calibrated without it."""
    return f"{model} without", None, experiment.name


def fitted_group(problem, reading, fits):
    """The `Group` of the experiments that were fitted."""
    shifts, covariance = problem.after_controls(fits)
    simulated = simulated_by(reading, fits, reading.failures)
    return Group(reading.points, problem.library.cases, shifts, covariance, simulated)


def simulated_by(reading, models, failures):
    """{model: values on the points} of the models of which no run failed."""
    broken = {model for model, _, name in failures if name in reading.parts}
    return {model: reading.vector(model, None) for model in models if model not in broken}


def left_out_values(reading, folds, names):
    """{experiment: {model: values on its points}} of the models calibrated without it."""
    return {
        one.name: {
            model: reading.parts[one.name].simulated({one.name: reading.seen[without(model, one)]})
            for model in names
            if without(model, one) in reading.seen
        }
        for one in folds
    }


def held_out_group(analysis, hold_out, cases, seen, failures, fits):
    """The `Group` of the experiments that were held out."""
    points = choose_points(hold_out)
    reading = Reading(points, seen, failures)
    fine, coarse = reading.vector(BASELINE, None), reading.vector("coarse", None)
    baseline = {one.name: seen[BASELINE, None, one.name] for one in hold_out}
    covariance = measurement_covariance(points, points.sensitivity(baseline))
    covariance += numerical_covariance(points, coarse, fine, 1.0 / REFINEMENT, ORDER, "fine")
    simulated = simulated_by(reading, fits, failures)
    shifts = {model: np.zeros(len(points)) for model in fits}
    return Group(points, cases, shifts, covariance, simulated)


class Recalibration:
    """The least-squares problem of all models, on the points of the library.

    What no parameter of the material can explain is in the covariance: measurement, discretisation,
    set-up, and the discrepancy at the size that the hypothesis found.
    """

    def __init__(self, analysis):
        library = analysis.library
        self.analysis, self.library = analysis, library
        rows = [n for n, each in enumerate(library.quantities) if each.key in CALIBRATED]
        self.quantities = tuple(library.quantities[n] for n in rows)
        self.slopes = sensitivities(library)[rows]
        self.kind = library.points.kind

    def fit(self, name, rows):
        """The `Fit` of a hypothesis ("": no effect) on some points (N,) of the library."""
        hypothesis = self.analysis.evidence.hypotheses[name or NONE]
        parts = self.parts(name, hypothesis)
        count = sum(len(u) for _, _, u in parts)
        start = np.concatenate([*(u for _, _, u in parts), np.zeros(len(self.quantities))])
        start[:count] = np.clip(start[:count], 2.0 * LEAST_QUANTILE, 1.0 - 2.0 * LEAST_QUANTILE)
        low = np.full(len(start), -MOST_DEVIATIONS)
        low[:count] = LEAST_QUANTILE
        high = np.where(np.arange(len(start)) < count, 1.0 - LEAST_QUANTILE, MOST_DEVIATIONS)
        residual = self.residual(parts, count, hypothesis.sigma, rows)
        if len(start):
            start = least_squares(residual, start, bounds=(low, high), x_scale=0.3).x
        effects, first = {}, 0
        for closure, _, u in parts:
            effects[closure.effect] = (closure, start[first : first + len(u)])
            first += len(u)
        return Fit(effects, start[count:])

    def parts(self, name, hypothesis):
        """(closure, response, u) of each effect of a hypothesis, as the evidence has them."""
        found, first = [], 0
        for effect, variant in zip(effects_of(name or NONE), hypothesis.variant, strict=True):
            response = self.library.responses[effect][variant]
            u = hypothesis.u[first : first + response.dimension]
            first += response.dimension
            found.append((self.library.closures[effect][variant], response, u))
        return found

    def residual(self, parts, count, sigma, rows):
        """Function of (u, z): whitened gaps, gaps beyond bounds, and the priors: z, and u as a standard normal.

        Without its prior a parameter that the data do not see would run along a ridge to its bound.
        """
        values, bounds = rows & (self.kind == "value"), rows & (self.kind != "value")
        covariance = self.analysis.everything + 0.0
        own = self.analysis.own
        covariance[own, own] += sigma**2 * self.analysis.kernel
        factor = cholesky(covariance[np.ix_(values, values)], lower=True, check_finite=False)
        deviation = np.sqrt(np.diag(covariance))[bounds]
        gap, points = self.library.fine - self.library.points.measured, self.library.points

        def evaluate(parameters):
            whole = gap + self.change(parts, parameters[:count]) + parameters[count:] @ self.slopes
            white = solve_triangular(factor, whole[values], lower=True, check_finite=False)
            beyond = beyond_bounds(points, whole)[bounds] / deviation
            normal = ndtri(parameters[:count])
            return np.concatenate([white, beyond, normal, parameters[count:]])

        return evaluate

    def change(self, parts, u):
        """Response of the effects at their quantiles, (N,)."""
        total, first = np.zeros(len(self.library.points)), 0
        for _, response, own in parts:
            total = total + response.at(u[first : first + len(own)])
            first += len(own)
        return total

    def predicted(self, fit):
        """Values that the emulator gives for a fit, (N,)."""
        total = self.library.fine + fit.z @ self.slopes
        for effect, (closure, u) in fit.effects.items():
            number = self.library.closures[effect].index(closure)
            total = total + self.library.responses[effect][number].at(u)
        return total

    def after_controls(self, fits):
        """({model: shift (n,)}, covariance (n, n)) of the gaps of the experiments, given the controls."""
        analysis, points = self.analysis, self.library.points
        if not analysis.controls:
            nothing = np.zeros(len(analysis.points))
            covariance = analysis.measurement + analysis.numerical
            return dict.fromkeys(fits, nothing), covariance
        wanted = np.arange(len(points)) < len(analysis.points)
        given = ~wanted & (self.kind == "value")
        gap, shifts = self.library.fine - points.measured, {}
        for model, fit in fits.items():
            found = condition(given, wanted, gap + fit.z @ self.slopes, analysis.everything)
            shifts[model] = found.mean
        return shifts, found.covariance

    def case(self, fit, experiment, base):
        """The case of a fit on the finer grid, for an experiment whose coarser baseline is `base`."""
        name = experiment.name
        own = [  # a material of the same value is the same material
            (each._replace(experiments=(name,)), shift)
            for each, shift in zip(self.quantities, fit.z, strict=True)
            if name in each.experiments or value_of(base, each.key) == each.mean
        ]
        case = with_nuisances(base, name, [each for each, _ in own], [shift for _, shift in own])
        sections = {
            f"effects.{effect}": closure.section(u) for effect, (closure, u) in fit.effects.items()
        }
        return refined(case.replace(**sections))


# -- sizes of gaps -------------------------------------------------------------------------------


class Closing(NamedTuple):
    """Sizes of a gap before and after, the fraction that closed and its range."""

    before: float
    after: float
    fraction: float
    interval: tuple


def gaps_of(group, model):
    """Simulated - measured after what the controls let expect, (n,); of a bound what is beyond it."""
    shown = group.simulated[model] - group.shifts[model]
    return beyond_bounds(group.points, shown - group.points.measured)


def size(gap, deviation):
    """Root mean square of a gap beyond the noise, in the units of both."""
    return float(np.sqrt(max(0.0, np.mean(gap**2) - np.mean(deviation**2))))


def closing(group, before, after, rows, seed, in_units=False, values=()):
    """The `Closing` between two models on some points.

    Parameters
    ----------
    group : Group
    before, after : str
        Models.
    rows : (n,) bool array
    seed : int
        Of the realisations of the noise.
    in_units : bool
        Sizes in the units of the observable, not in standard deviations.
    values : sequence of float
        Fractions that the range must cover.
    """
    deviation = np.sqrt(np.diag(group.covariance))[rows]
    gaps = [gaps_of(group, model)[rows] for model in (before, after)]
    scale = np.ones_like(deviation) if in_units else deviation
    noise = deviation / scale
    sizes = [size(gap / scale, noise) for gap in gaps]
    fraction = fraction_closed(*sizes, noise)
    factor = cholesky(group.covariance, lower=True, check_finite=False)
    draws = np.random.default_rng(seed).standard_normal((REALISATIONS, len(factor)))
    errors = (draws @ factor.T)[:, rows] / scale
    again = [
        fraction_closed(*(size(gap / scale + error, np.sqrt(2.0) * noise) for gap in gaps), noise)
        for error in errors
    ]
    low, high = np.percentile(again, RANGE)
    found = (fraction, low, high, *values)
    return Closing(*sizes, fraction, (float(min(found)), float(max(found))))


def fraction_closed(before, after, noise):
    """1 - after / before, at least -1; 0 where there is no gap to close."""
    least = SMALLEST_SIZE * float(np.sqrt(np.mean(noise**2)))
    if before <= least:
        return 0.0 if after <= least else -1.0
    return float(max(-1.0, 1.0 - after / before))


def fold_fractions(ladder):
    """{(experiment, held out): {model: fraction closed}} of all experiments that took no part."""
    found = {}
    for name, values in ladder.left_out.items():
        own = ladder.fitted.points.of(name)
        found[name, False] = {}
        for model, each in values.items():
            simulated = {model: ladder.fitted.simulated[BASELINE].copy()}
            simulated[model][own] = each
            group = with_simulated(ladder.fitted, simulated)
            found[name, False][model] = one_fraction(group, own, model)
    if ladder.held_out is not None:
        group = ladder.held_out
        for name in group.points.names:
            own = group.points.of(name)
            models = [model for model in group.simulated if model != BASELINE]
            found[name, True] = {model: one_fraction(group, own, model) for model in models}
    return found


def with_simulated(group, simulated):
    """The group with other values of some models."""
    return group._replace(simulated=group.simulated | simulated)


def one_fraction(group, own, model):
    """Fraction closed in the experiment whose points are `own`."""
    deviation = np.sqrt(np.diag(group.covariance))[own]
    noise = np.ones(len(deviation))
    sizes = [size(gaps_of(group, each)[own] / deviation, noise) for each in (BASELINE, model)]
    return fraction_closed(*sizes, noise)
