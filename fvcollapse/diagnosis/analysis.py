"""From runs and measurements to the gap map and the evidence of every effect.

With controls, experiments in which nothing is hidden, all gaps are judged after what the controls show:
their expected discrepancy is subtracted, its covariance is part of U.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fvcollapse.diagnosis.baseline import REFINEMENT
from fvcollapse.diagnosis.calibration import calibration_of
from fvcollapse.diagnosis.controls import Discrepancy, Shown, condition, learn, set_ups_apart
from fvcollapse.diagnosis.covariance import (
    discrepancy_amplitude,
    discrepancy_kernel,
    measurement_covariance,
    numerical_covariance,
)
from fvcollapse.diagnosis.evidence import Evidence, ModelComparison
from fvcollapse.diagnosis.gap_map import GapMap, gap_map
from fvcollapse.diagnosis.library import DRAWS, Library, add_levels, build_library
from fvcollapse.diagnosis.mass_balance import MassBalance, mass_balance
from fvcollapse.diagnosis.practical import with_left
from fvcollapse.diagnosis.question import Question
from fvcollapse.diagnosis.separability import Separability, null_test, separability

if TYPE_CHECKING:
    from fvcollapse.diagnosis.emulator import Response
    from fvcollapse.diagnosis.points import Points
    from fvcollapse.diagnosis.runner import Runner
    from fvcollapse.measure.experiment import Experiment

ORDER = 1.0  # of convergence; see the convergence study
REFINEMENTS = 2  # rounds of further levels
REFINED = 2  # effects in each
UNCERTAIN = 4.0  # expected chi-square of the error of the emulator at the best values
SAME_LEVEL = 0.01  # quantile
LEAST_QUANTILE = 0.01  # of a further level


@dataclass(frozen=True)
class Analysis:
    """What the data say, before any verdict; the (N,) vectors are over `points`.

    Attributes
    ----------
    question : Question
    library : Library
        Over the points of experiments and controls, N + M of them.
    measurement, numerical, calibration : (N, N) arrays
        Parts of U, but for the controls; the last is Sigma_nu.
    covariance, kernel : (N, N) arrays
        U and K_delta; U is conditioned on the controls.
    shift, expected : (N,) arrays
        Discrepancy that controls let expect (simulated - measured; 0 without them); mean of the ensemble - baseline.
    discrepancy : Discrepancy or None
        What was learned from the controls.
    everything : (N + M, N + M) array
        Covariance of all gaps that no calibration explains: measurement, grid, set-up and learned discrepancy.
    gap_map : GapMap
    comparison : ModelComparison
    evidence : Evidence
    """

    question: Question
    library: Library
    measurement: np.ndarray
    numerical: np.ndarray
    calibration: np.ndarray
    covariance: np.ndarray
    kernel: np.ndarray
    shift: np.ndarray
    expected: np.ndarray
    discrepancy: Discrepancy | None
    everything: np.ndarray
    gap_map: GapMap
    comparison: ModelComparison
    evidence: Evidence

    @property
    def experiments(self) -> "tuple[Experiment, ...]":
        """The experiments to fit."""
        return self.question.experiments

    @property
    def controls(self) -> "tuple[Experiment, ...]":
        """Experiments in which nothing is hidden."""
        return self.question.controls

    @property
    def points(self) -> "Points":
        """`Points` of the experiments."""
        return self.question.points

    @property
    def seed(self) -> int:
        """Of all random draws."""
        return self.question.seed

    @property
    def own(self) -> slice:
        """Slice of the points of the experiments among those of the library."""
        return slice(0, len(self.points))

    @property
    def baseline(self) -> np.ndarray:
        """Baseline on the finer grid, (N,)."""
        return self.library.fine[self.own]

    @cached_property
    def responses(self) -> "dict[str, list[Response]]":
        """Effect -> `Response`s on the points of the experiments."""
        return responses_on(self.library.responses, self.own)

    @property
    def gap(self) -> np.ndarray:
        """Simulated - measured, (N,), as it is compared: mean of the ensemble, less the shift."""
        return self.baseline - self.shift + self.expected - self.points.measured

    def evidence_of(self, effects: Collection[str]) -> Evidence:
        """The `Evidence` of some effects, as if the others were not in the catalogue."""
        responses = {name: each for name, each in self.responses.items() if name in effects}
        comparison = ModelComparison(self.covariance, self.kernel, responses, self.points)
        known = self.evidence
        return replace(comparison.evidence(self.gap), balance=known.balance, left=known.left)

    @cached_property
    def separability(self) -> Separability:
        """The `Separability` of the effects."""
        return separability(self.covariance, self.kernel, self.responses)

    @cached_property
    def null_wins(self) -> dict[str, float]:
        """Effects that win where only the calibration is off: {name: share of the draws}."""
        samples = self.library.samples[:, self.own]
        rng = np.random.default_rng([self.seed, 2])
        return null_test(samples, samples.mean(axis=0), self.comparison, self.measurement, rng)


def analyse(
    question: Question,
    runner: "Runner",
    *,
    effects: Sequence[str] | None = None,
    draws: int = DRAWS,
    refinements: int = REFINEMENTS,
) -> Analysis:
    """The `Analysis` of a question: runs what is missing, then compares.

    Where the emulator is uncertain at the best values of the two best effects, they are run there too.

    Parameters
    ----------
    question : Question
    runner : Runner
    effects : sequence of str, optional
        Only these of the catalogue.
    draws, refinements : int
        Size of the ensemble of calibrated parameters; rounds of further levels at most.

    Raises
    ------
    InputError
        An experiment is given twice, or an effect is not in the catalogue.
    NumericalError
        A baseline fails, or too much of the ensemble.
    """
    library = build_library(question, runner, effects, draws)
    analysis = compare_library(question, library)
    for _ in range(refinements):
        wanted = uncertain_levels(analysis)
        if not wanted:
            break
        library = add_levels(library, wanted, runner)
        analysis = compare_again(analysis, library)
    return with_left(analysis)


def uncertain_levels(analysis: Analysis) -> list[tuple[str, int, np.ndarray]]:
    """(effect, closure, u) of the two best effects where the emulator errs by more than the noise."""
    hypotheses = analysis.evidence.hypotheses
    single = [hypotheses[name] for name in hypotheses if name in analysis.library.responses]
    single.sort(key=lambda hypothesis: -hypothesis.log_evidence)
    levels = []
    for hypothesis in single[:REFINED]:
        (variant,) = hypothesis.variant
        response = analysis.responses[hypothesis.name][variant]
        if response.scatters:
            continue
        u = np.clip(hypothesis.u, LEAST_QUANTILE, 1.0 - LEAST_QUANTILE)
        _, variance = response.weights(u[None])
        white = analysis.comparison.whitened[hypothesis.sigma].solve(
            response.errors[:, analysis.comparison.values].T
        )
        apart = np.abs(response.levels - u).max(axis=1).min()
        if variance[0] * (white**2).sum() > UNCERTAIN and apart > SAME_LEVEL:
            levels.append((hypothesis.name, variant, u))
    return levels


class Uncertainty(NamedTuple):
    """Covariances over all points of the library, (n, n), and the mean change of the ensemble (n,)."""

    measurement: np.ndarray
    numerical: np.ndarray
    calibration: np.ndarray
    kernel: np.ndarray
    expected: np.ndarray

    @property
    def known(self) -> np.ndarray:
        """U: everything but the error of the model."""
        return self.measurement + self.numerical + self.calibration


class Discount(NamedTuple):
    """What the controls take off a gap: shift (N,), U (N, N), the learned `Discrepancy`, `everything`."""

    shift: np.ndarray
    covariance: np.ndarray
    discrepancy: Discrepancy | None
    everything: np.ndarray


def uncertainty_of(library: Library) -> Uncertainty:
    """The `Uncertainty` of a library."""
    points = library.points
    measurement = measurement_covariance(points, points.sensitivity(library.seen))
    numerical = numerical_covariance(points, library.coarse, library.fine, 1.0 / REFINEMENT, ORDER)
    mean, calibration = calibration_of(library)
    kernel = discrepancy_kernel(points, discrepancy_amplitude(points, np.diag(calibration)))
    return Uncertainty(measurement, numerical, calibration, kernel, mean - library.coarse)


def discount(question: Question, library: Library, uncertainty: Uncertainty) -> Discount:
    """The `Discount` of the controls; without controls nothing is taken off."""
    points, count = library.points, len(question.points)
    everything = uncertainty.measurement + uncertainty.numerical + library.set_up_covariance
    known = uncertainty.known
    if not question.controls:
        return Discount(np.zeros(count), known[:count, :count], None, everything)
    gap = library.fine + uncertainty.expected - points.measured
    wanted = np.arange(len(points)) < count
    given = ~wanted & (points.kind == "value")
    run = points.per_point(lambda block: points.names.index(block.experiment))
    apart = set_ups_apart(points.experiments)[np.ix_(run, run)]
    learned = learn(Shown(points, given, gap), known, uncertainty.kernel, apart, library.everywhere)
    conditioned = condition(given, wanted, gap, known + learned.covariance)
    return Discount(*conditioned, learned, everything + learned.covariance)


def compare_library(question: Question, library: Library) -> Analysis:
    """The `Analysis` of a library that is there."""
    points, uncertainty = question.points, uncertainty_of(library)
    own = slice(0, len(points))
    known = discount(question, library, uncertainty)
    compared = library.fine[own] - known.shift
    rng = np.random.default_rng([question.seed, 1])
    parts: dict[str, Any] = {
        "measurement": uncertainty.measurement[own, own],
        "numerical": uncertainty.numerical[own, own],
        "calibration": uncertainty.calibration[own, own],
        "kernel": uncertainty.kernel[own, own],
        "expected": uncertainty.expected[own],
        **known._asdict(),
        "gap_map": gap_map(points, compared, known.covariance, rng),
    }
    balance = mass_balance(question.experiments, library.cases)
    return Analysis(question, library, **parts, **evidence_on(library, parts, points, balance))


def compare_again(analysis: Analysis, library: Library) -> Analysis:
    """The `Analysis` after further levels: the responses differ, and what follows from them; nothing else does."""
    parts, balance = vars(analysis), analysis.evidence.balance
    parts = {field.name: parts[field.name] for field in fields(analysis)}
    changed = evidence_on(library, parts, analysis.points, balance)
    return Analysis(**parts | {"library": library} | changed)


def evidence_on(
    library: Library, parts: Mapping[str, Any], points: "Points", balance: MassBalance | None
) -> dict[str, Any]:
    """{"comparison", "evidence"} of a library on the `points` of experiments; `parts`: attributes of an `Analysis`."""
    responses = responses_on(library.responses, slice(0, len(points)))
    comparison = ModelComparison(parts["covariance"], parts["kernel"], responses, points)
    compared = library.fine[: len(points)] - parts["shift"]
    evidence = comparison.evidence(compared + parts["expected"] - points.measured)
    return {"comparison": comparison, "evidence": replace(evidence, balance=balance)}


def responses_on(
    responses: "Mapping[str, Sequence[Response]]", rows: slice
) -> "dict[str, list[Response]]":
    """The responses on some of the points."""
    return {name: [each.on(rows) for each in variants] for name, variants in responses.items()}
