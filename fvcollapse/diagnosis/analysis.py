"""From runs and measurements to the gap map and the evidence of every effect.

With controls, experiments in which nothing is hidden, all gaps are judged after what the controls show:
their expected discrepancy is subtracted, its covariance is part of U.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fvcollapse.diagnosis.controls import condition, learn, set_ups_apart
from fvcollapse.diagnosis.covariance import (
    calibration_covariance,
    discrepancy_amplitude,
    discrepancy_kernel,
    measurement_covariance,
    numerical_covariance,
)
from fvcollapse.diagnosis.effect_library import (
    CALIBRATED,
    DRAWS,
    REFINEMENT,
    add_levels,
    baseline_cases,
    build_library,
)
from fvcollapse.diagnosis.evidence import Comparison
from fvcollapse.diagnosis.gap_map import gap_map
from fvcollapse.diagnosis.mass_balance import mass_balance
from fvcollapse.diagnosis.points import choose_points
from fvcollapse.diagnosis.separability import null_test, separability

ORDER = 1.0  # of convergence; see the convergence study
REFINEMENTS = 2  # rounds of further levels
REFINED = 2  # effects in each
UNCERTAIN = 4.0  # expected chi-square of the error of the emulator at the best values
SAME_LEVEL = 0.01  # quantile
LEAST_QUANTILE = 0.01  # of a further level
RIDGE = 0.1  # of the regression on the draws: few draws leave some directions open


@dataclass(frozen=True)
class Analysis:
    """What the data say, before any verdict; the (N,) vectors are over `points`.

    Attributes
    ----------
    experiments, controls : tuple of Experiment
    library : Library
        Over the points of experiments and controls, N + M of them.
    points : Points
        Of the experiments.
    measurement, numerical : (N, N) arrays
        Parts of U.
    calibration : (N, N) array
        Sigma_nu, the last part (but for the controls).
    covariance, kernel : (N, N) arrays
        U and K_delta; U is conditioned on the controls.
    shift : (N,) array
        Discrepancy that the controls let expect (simulated - measured); zero without them.
    expected : (N,) array
        Mean of the ensemble minus the baseline.
    discrepancy : Discrepancy or None
        What was learned from the controls.
    everything : (N + M, N + M) array
        Covariance of all gaps that no calibration explains: measurement, discretisation, set-up and the
        learned discrepancy.
    gap_map : GapMap
    comparison : Comparison
    evidence : Evidence
    seed : int
    """

    experiments: tuple
    controls: tuple
    library: object
    points: object
    measurement: np.ndarray
    numerical: np.ndarray
    calibration: np.ndarray
    covariance: np.ndarray
    kernel: np.ndarray
    shift: np.ndarray
    expected: np.ndarray
    discrepancy: object
    everything: np.ndarray
    gap_map: object
    comparison: object
    evidence: object
    seed: int

    @property
    def own(self):
        """Slice of the points of the experiments among those of the library."""
        return slice(0, len(self.points))

    @property
    def baseline(self):
        """Baseline on the finer grid, (N,)."""
        return self.library.fine[self.own]

    @property
    def responses(self):
        """Effect -> `Response`s on the points of the experiments."""
        return own_responses(self.library.responses, self.own)

    @property
    def gap(self):
        """Simulated - measured, (N,), as it is compared: mean of the ensemble, less the shift."""
        return self.baseline - self.shift + self.expected - self.points.measured

    def evidence_of(self, effects):
        """The `Evidence` of some effects, as if the others were not in the catalogue."""
        responses = {name: each for name, each in self.responses.items() if name in effects}
        comparison = Comparison(self.covariance, self.kernel, responses, self.points)
        return replace(comparison.evidence(self.gap), balance=self.evidence.balance)

    @cached_property
    def separability(self):
        """The `Separability` of the effects."""
        return separability(self.covariance, self.kernel, self.responses)

    @cached_property
    def null_wins(self):
        """Effects that win where only the calibration is off: {name: share of the draws}."""
        samples = self.library.samples[:, self.own]
        rng = np.random.default_rng([self.seed, 2])
        return null_test(samples, samples.mean(axis=0), self.comparison, self.measurement, rng)


def analyse(
    experiments,
    runner,
    case=None,
    *,
    effects=None,
    controls=(),
    cell_size=None,
    draws=DRAWS,
    seed=0,
    refinements=REFINEMENTS,
):
    """The `Analysis` of some experiments: runs what is missing, then compares.

    Where the emulator is uncertain at the best values of the two best effects, they are run there too.

    Parameters
    ----------
    experiments, controls : sequences of Experiment
    runner : Runner
    case : Case, optional
        What the user believes.
    effects : sequence of str, optional
        Only these of the catalogue.
    cell_size : float, optional
        Of the coarser grid [m].
    draws : int
        Size of the ensemble of calibrated parameters.
    seed : int
    refinements : int
        Rounds of further levels at most.
    """
    experiments, controls = tuple(experiments), tuple(controls)
    everyone = choose_points((*experiments, *controls)).experiments  # refuses a name twice
    cases = baseline_cases(everyone, case, cell_size)
    library = build_library(experiments, cases, runner, effects, controls, draws, seed)
    analysis = compare_library(library, experiments, controls, seed)
    for _ in range(refinements):
        wanted = uncertain_levels(analysis)
        if not wanted:
            break
        library = add_levels(library, wanted, runner)
        analysis = compare_library(library, experiments, controls, seed)
    return analysis


def uncertain_levels(analysis):
    """(effect, closure, u) of the two best effects where the emulator errs by more than the noise."""
    found = []
    single = [
        each
        for name, each in analysis.evidence.hypotheses.items()
        if name in analysis.library.responses
    ]
    single.sort(key=lambda each: -each.log_evidence)
    for each in single[:REFINED]:
        (variant,) = each.variant
        response = analysis.responses[each.name][variant]
        u = np.clip(each.u, LEAST_QUANTILE, 1.0 - LEAST_QUANTILE)
        _, variance = response.weights(u[None])
        white = analysis.comparison.whitened[each.sigma].solve(
            response.errors[:, analysis.comparison.values].T
        )
        apart = np.abs(response.levels - u).max(axis=1).min()
        if variance[0] * (white**2).sum() > UNCERTAIN and apart > SAME_LEVEL:
            found.append((each.name, variant, u))
    return found


def compare_library(library, experiments, controls=(), seed=0):
    """The `Analysis` of a library that is there."""
    every, points = library.points, choose_points(experiments)
    own = slice(0, len(points))
    sensitivity = every.sensitivity(library.seen)
    measurement = measurement_covariance(every, sensitivity)
    ratio = 1.0 / REFINEMENT
    numerical = numerical_covariance(every, library.coarse, library.fine, ratio, ORDER, "fine")
    mean, calibration = calibration_of(library)
    known = measurement + numerical + calibration
    amplitude = discrepancy_amplitude(every, np.diag(calibration))
    kernel = discrepancy_kernel(every, amplitude)
    set_up = set_up_covariance(library)
    expected = mean - library.coarse
    gap = library.fine + expected - every.measured
    learned, shift, covariance = None, np.zeros(len(points)), known[own, own]
    everything = measurement + numerical + set_up
    if controls:
        wanted = np.arange(len(every)) < len(points)
        given = ~wanted & (every.kind == "value")
        run = every.per_point(lambda block: every.names.index(block.experiment))
        apart = set_ups_apart(every.experiments)[np.ix_(run, run)]
        learned = learn(every, given, gap, known, kernel, apart)
        found = condition(given, wanted, gap, known + learned.covariance)
        shift, covariance = found.mean, found.covariance
        everything = everything + learned.covariance
    compared = library.fine[own] - shift
    rng = np.random.default_rng([seed, 1])
    responses = own_responses(library.responses, own)
    comparison = Comparison(covariance, kernel[own, own], responses, points)
    evidence = comparison.evidence(compared + expected[own] - points.measured)
    return Analysis(
        experiments=experiments,
        controls=controls,
        library=library,
        points=points,
        measurement=measurement[own, own],
        numerical=numerical[own, own],
        calibration=calibration[own, own],
        covariance=covariance,
        kernel=kernel[own, own],
        shift=shift,
        expected=expected[own],
        discrepancy=learned,
        everything=everything,
        gap_map=gap_map(points, compared, covariance, rng),
        comparison=comparison,
        evidence=replace(evidence, balance=mass_balance(experiments, library.cases)),
        seed=seed,
    )


def own_responses(responses, own):
    """The responses on some of the points."""
    return {
        name: [
            type(each)(each.levels, each.differences[:, own], each.errors[:, own]) for each in given
        ]
        for name, given in responses.items()
    }


def calibration_of(library):
    """Mean of the ensemble (N,) and Sigma_nu (N, N)."""
    linear = sensitivities(library)
    drawn = library.draws - library.draws.mean(axis=0)
    mean = library.samples.mean(axis=0)
    rest = library.samples - mean - drawn @ linear
    entering = [
        sum(name in each.experiments for each in library.quantities)
        for name in library.points.names
    ]
    spare = max(len(library.draws) - 1 - max(entering), 1)
    return calibration_covariance(library.samples, linear, rest, spare)


def sensitivities(library):
    """Change of the simulated values per standard deviation of each quantity, (n, N).

    Least squares over the ensemble, experiment by experiment on the quantities that enter it.
    """
    found = np.zeros((len(library.quantities), library.samples.shape[1]))
    for name in library.points.names:
        own = library.points.of(name)
        columns = [n for n, each in enumerate(library.quantities) if name in each.experiments]
        z = library.draws[:, columns]
        z = z - z.mean(axis=0)
        change = library.samples[:, own] - library.samples[:, own].mean(axis=0)
        normal = z.T @ z + RIDGE * np.eye(len(columns))
        found[columns, own] = np.linalg.solve(normal, z.T @ change)
    return found


def set_up_covariance(library):
    """Part of Sigma_nu that comes from the set-up and not from the material, (N, N)."""
    rows = [each.key not in CALIBRATED for each in library.quantities]
    own = sensitivities(library)[rows]
    return own.T @ own
