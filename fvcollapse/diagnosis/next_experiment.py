"""What to measure next: the set-up that would best separate the hypotheses that are left.

For every candidate the leading hypotheses are run there at the level nearest to their best values, and so
is the baseline, once as it is and once with mu_1 one standard deviation off. With means m_j and the
covariance C of measurement, set-up, calibration and discrepancy, which all hypotheses share,

    U = sum_{j<k} P_j P_k (m_j - m_k)' C^-1 (m_j - m_k)

ranks the candidates (Box & Hill 1967 with equal covariances); how well a strength is known enters C.
The expected drop of the entropy of the probabilities is computed by simulation, and the number of repeats
after which the expected logarithm of the Bayes factor of the leading pair reaches 5. Repeats average
the measurement only.

References
----------
Box & Hill (1967), Technometrics 9, 57; Meyer, Steinberg & Box (1996), Technometrics 38, 303.
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.special import logsumexp

from fvcollapse.diagnosis.covariance import (
    discrepancy_amplitude,
    discrepancy_kernel,
    measurement_covariance,
)
from fvcollapse.diagnosis.levels import acts_in
from fvcollapse.diagnosis.names import UNKNOWN, effects_of
from fvcollapse.diagnosis.next_candidates import Candidate, candidates, set_up
from fvcollapse.diagnosis.nuisances import with_nuisances
from fvcollapse.diagnosis.point_choice import choose_points
from fvcollapse.diagnosis.progress import NEXT
from fvcollapse.diagnosis.separability import DISCREPANCY
from fvcollapse.measure.align import align_curve
from fvcollapse.measure.curves import Curve
from fvcollapse.measure.quantities import CURVES

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.nuisances import Nuisance
    from fvcollapse.diagnosis.runner import Runner
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations

MOST_HYPOTHESES = 3
LEAST_PROBABILITY = 0.02  # of a hypothesis that is worth separating
LEAST_ENTROPY = 0.15  # bit; below it nothing is left to separate
LOG_BAYES_FACTOR = 5.0
MOST_REPEATS = 20
DRAWS = 4000  # of simulated outcomes
FRAME, PLACE = 0.02, 0.01  # s, m between the simulated readings
LEAST_THICKNESS = 1.0e-3  # m; thinner places are read as bare


class Choice(NamedTuple):
    """What a candidate promises.

    Attributes
    ----------
    candidate : Candidate
    separates : tuple of str
        The pair of hypotheses that it separates best.
    gain : float
        Expected drop of the entropy [bit].
    utility : float
        Box-Hill.
    repeats : int or None
        None: more than 20, or never.
    """

    candidate: Candidate
    separates: tuple[str, str]
    gain: float
    utility: float
    repeats: int | None


def choices(
    analysis: "Analysis", probability: Mapping[str, float], runner: "Runner"
) -> list[Choice]:
    """The candidates as `Choice`s, the best first; empty where nothing is left to separate.

    Parameters
    ----------
    analysis : Analysis
    probability : dict
        Of the verdict.
    runner : Runner
    """
    hypotheses = leading(probability, analysis.responses)
    if len(hypotheses) < 2 or entropy(np.array(list(hypotheses.values()))) < LEAST_ENTROPY:
        return []
    reference = reference_experiment(analysis)
    base = analysis.library.cases[reference.name]
    planned = candidates(reference, base)
    wanted, known = {}, mu_1_of(analysis, reference)
    for number, candidate in enumerate(planned):
        experiment = set_up(reference, candidate)
        case = base.replace(**candidate.changes)
        wanted[number, "base"] = (experiment, case)
        if known is not None:
            shifted = with_nuisances(case, experiment.name, [known], [1.0])
            wanted[number, "mu_1"] = (experiment, shifted)
        for name in hypotheses:
            if all(acts_in(part, case) for part in effects_of(name)):
                wanted[number, name] = (experiment, with_hypothesis(case, analysis, name))
    seen, _ = runner.observations(wanted, NEXT)
    found = []
    for number, candidate in enumerate(planned):
        own = {label: each for (n, label), each in seen.items() if n == number}
        if "base" in own:
            experiment = set_up(reference, candidate)
            found.append(judge(analysis, candidate, experiment, own, hypotheses))
    found.sort(key=lambda choice: -choice.gain)
    return found


def leading(probability: Mapping[str, float], responses: Container[str]) -> dict[str, float]:
    """{name: probability} of the hypotheses that can be run, at most three, summing to 1."""
    able = {
        name: value
        for name, value in probability.items()
        if value >= LEAST_PROBABILITY and all(part in responses for part in effects_of(name))
    }
    able.pop(UNKNOWN, None)
    best = sorted(able, key=lambda name: -able[name])[:MOST_HYPOTHESES]
    total = sum(able[name] for name in best)
    return {name: able[name] / total for name in best}


def reference_experiment(analysis: "Analysis") -> "Experiment":
    """The experiment with the largest gap in combined standard uncertainties."""
    z = analysis.gap_map.z
    return max(
        analysis.experiments, key=lambda one: float(np.mean(z[analysis.points.of(one)] ** 2))
    )


def mu_1_of(analysis: "Analysis", reference: "Experiment") -> "Nuisance | None":
    """The `Nuisance` mu_1 of an experiment under any name; None if it is not calibrated."""
    for quantity in analysis.library.quantities:
        if quantity.key == "rheology.mu_1" and reference.name in quantity.experiments:
            return quantity._replace(experiments=("candidate",))
    return None


def with_hypothesis(case: "Case", analysis: "Analysis", name: str) -> "Case":
    """The case with the effects of a hypothesis at the level of the library nearest to their values."""
    changes, first = {}, 0
    hypothesis = analysis.evidence.hypotheses.get(name)
    for position, effect in enumerate(effects_of(name)):
        variant = hypothesis.variant[position] if hypothesis else 0
        closure = analysis.library.closures[effect][variant]
        levels = closure.levels()
        u = (
            hypothesis.u[first : first + levels.shape[1]]
            if hypothesis
            else np.full(levels[0].shape, 0.5)
        )
        first += levels.shape[1]
        nearest = levels[np.argmin(np.linalg.norm(levels - u, axis=1))]
        changes[f"effects.{effect}"] = closure.section(nearest)
    return case.replace(**changes) if changes else case


# -- what a candidate promises --------------------------------------------------------------------


def judge(
    analysis: "Analysis",
    candidate: Candidate,
    experiment: "Experiment",
    seen: "Mapping[str, Observations]",
    hypotheses: Mapping[str, float],
) -> Choice:
    """The `Choice` of a candidate from its simulated outcomes."""
    end = min(
        float(each.front[-1, 0]) for each in seen.values()
    )  # some may be longer runs of others
    experiment = with_readings(experiment, candidate.observables, seen["base"], end)
    points = choose_points((experiment,))
    values = {label: points.simulated({experiment.name: each}) for label, each in seen.items()}
    base = values["base"]
    names = tuple(hypotheses)
    means = np.array([values.get(name, base) - base for name in names])
    slope = values.get("mu_1", base) - base
    measurement = measurement_covariance(
        points, points.sensitivity({experiment.name: seen["base"]})
    )
    kernel = discrepancy_kernel(points, discrepancy_amplitude(points, slope**2))
    shared = np.outer(slope, slope) + DISCREPANCY**2 * kernel
    for name, mean in zip(names, means, strict=True):
        spread = strength_spread(analysis, name) * mean
        shared = shared + hypotheses[name] * np.outer(spread, spread)
    white = whitened(means, measurement + shared)
    chance = np.array([hypotheses[name] for name in names])
    square = ((white[:, None] - white) ** 2).sum(axis=2)
    utility = 0.5 * float(chance @ square @ chance)
    weight = np.triu(np.outer(chance, chance) * square, 1)
    j, k = np.unravel_index(int(np.argmax(weight)), weight.shape)
    rng = np.random.default_rng([analysis.seed, 3])
    return Choice(
        candidate=candidate,
        separates=(names[j], names[k]),
        gain=expected_gain(white, chance, rng),
        utility=utility,
        repeats=repeats(means[j] - means[k], measurement, shared),
    )


def whitened(means: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Means (K, N) multiplied by the inverse Cholesky factor."""
    factor = cholesky(covariance, lower=True, check_finite=False)
    return solve_triangular(factor, means.T, lower=True, check_finite=False).T


def strength_spread(analysis: "Analysis", name: str) -> float:
    """Relative standard deviation of the strength of a hypothesis, given the data; 0 for none."""
    hypothesis = analysis.evidence.hypotheses.get(name)
    if hypothesis is None or not len(hypothesis.u):
        return 0.0
    changes, first = [], 0
    for effect, variant in zip(effects_of(name), hypothesis.variant, strict=True):
        response = analysis.responses[effect][variant]
        # one parameter after the other, the others at their best
        for axis in range(response.dimension):
            ends = np.tile(hypothesis.u[first : first + response.dimension], (2, 1))
            ends[:, axis] = hypothesis.low[first + axis], hypothesis.high[first + axis]
            low, high = response.at(ends)
            changes.append(high - low)
        first += response.dimension
    white = whitened(np.array([*changes, hypothesis.difference]), analysis.covariance)
    size = np.linalg.norm(white[-1])
    return min(1.0, float(np.linalg.norm(white[:-1]) / (3.29 * size))) if size else 0.0


def with_readings(
    experiment: "Experiment", observables: Sequence[str], observed: "Observations", end: float
) -> "Experiment":
    """The experiment with what would be read: the baseline, at every frame up to `end` (s) and place."""
    frames = np.arange(FRAME, end, FRAME)
    places = np.arange(0.5 * PLACE, 1.1 * float(observed.front[:, 1].max()), PLACE)
    curves = {}
    for name in observables:
        grid = CURVES[name].is_profile
        time = np.repeat(frames, len(places)) if grid else frames
        x = np.tile(places, len(frames)) if grid else None
        sigma = np.full(len(time), experiment.standard_deviation(CURVES[name].uncertainty))
        curves[name] = Curve(time, x, np.zeros(len(time)), sigma)
    read = replace(experiment, curves=curves)
    for name, curve in curves.items():
        curves[name] = curve._replace(value=align_curve(observed, read, name).simulated)
    return read


def expected_gain(white: np.ndarray, chance: np.ndarray, rng: np.random.Generator) -> float:
    """Expected drop of the entropy of the probabilities by one outcome [bit].

    Parameters
    ----------
    white : (K, N) array
        Whitened means.
    chance : (K,) array
    rng : numpy.random.Generator
    """
    apart = white - white.mean(axis=0)
    size, turn = np.linalg.eigh(apart @ apart.T)
    place = turn * np.sqrt(np.maximum(size, 0.0))  # the hypotheses differ in these directions only
    truth = rng.choice(len(chance), DRAWS, p=chance)
    outcome = place[truth] + rng.standard_normal((DRAWS, place.shape[1]))
    logs = np.log(chance) - 0.5 * ((outcome[:, None] - place) ** 2).sum(axis=2)
    after = np.exp(logs - logsumexp(logs, axis=1, keepdims=True))
    drop = entropy(chance) - entropy(after).mean()
    return max(0.0, float(drop))


def entropy(chance: np.ndarray) -> np.ndarray | np.float64:
    """Entropy of probabilities along the last axis [bit]."""
    logs = np.log2(chance, out=np.zeros_like(chance), where=chance > 0.0)
    return -(chance * logs).sum(axis=-1)


def repeats(difference: np.ndarray, measurement: np.ndarray, shared: np.ndarray) -> int | None:
    """Number of experiments whose mean reaches the wanted Bayes factor; None: more than 20."""
    for count in range(1, MOST_REPEATS + 1):
        white = whitened(difference[None], measurement / count + shared)[0]
        if 0.5 * float(white @ white) >= LOG_BAYES_FACTOR - 1.0e-9:
            return count
    return None
