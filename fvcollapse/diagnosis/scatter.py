"""Effects that scatter: their response is a mean over realisations, beside the covariance of one realisation.

Grains that jump ahead of the front do so in their own way in every run. What is measured is one realisation, and no
seed of a simulation is that of the laboratory. The response to such an effect is therefore the mean over `SEEDS` seeds
of the observation, which need no run of their own (`fvcollapse.measure.observation`). What a realisation departs from
it by is Gaussian, with the covariance that the effect states of its front times (1 + 1/SEEDS), for the mean has an
error too: scale(u)^2 sum_j e_j e_j', in the place of the errors of the emulator.

Limits: the mean is interpolated as if it were exact. The run-out scatters as the front at rest does; another number
that is changed, as the peak velocity, scatters by itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.emulator import Response
from fvcollapse.effects import front_saltation
from fvcollapse.effects.catalogue import CATALOGUE

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.levels import Closure
    from fvcollapse.diagnosis.points import Points
    from fvcollapse.diagnosis.runner import Number
    from fvcollapse.measure.observables import Observations

SEEDS = 4
# effect: (parameter that is the standard deviation of its scatter, covariance of the front over its square)
SCATTERS = {"front_saltation": ("spread", front_saltation.scatter_covariance)}
FRONT, RUNOUT = "front", "runout"


@dataclass(frozen=True)
class ScatteredResponse(Response):
    """A `Response` whose `errors` are those of one realisation, at the largest scatter of the levels.

    Attributes
    ----------
    scale : (n,) array
        Scatter at the levels over the largest.
    """

    scale: np.ndarray
    scatters = True

    def weights(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the levels (q, n) and variance (q,) of the scatter, 1 at the level of the largest."""
        weights, _ = self.kriging(u)
        return weights, np.maximum(weights @ self.scale, 0.0) ** 2


def realisations(effect: str, case: "Case") -> "list[Case]":
    """Cases that differ in the realisation of an effect; the case itself of one that does not scatter."""
    if effect not in SCATTERS:
        return [case]
    return [case.replace(**{f"effects.{effect}.seed": seed}) for seed in range(SEEDS)]


def labels(effect: str, level: int | str) -> "list[Number]":
    """Numbers of the realisations of a level in the labels of the runs; the first is that of the level."""
    return [level, *((level, seed) for seed in range(1, SEEDS if effect in SCATTERS else 1))]


def scattered(
    mean: Response,
    closure: "Closure",
    departures: np.ndarray,
    curves: "Sequence[tuple[Points, Observations, Case]]",
) -> ScatteredResponse:
    """The `ScatteredResponse` of an effect.

    Parameters
    ----------
    mean : Response
        Through the means of the realisations, (n, N).
    closure : Closure
    departures : (n, SEEDS, N) array
        Of the realisations of each level from their mean.
    curves : sequence of (Points, Observations, Case)
        Points of each experiment, in the order of the vectors, with baseline and case.
    """
    parameter, covariance_of = SCATTERS[closure.effect]
    section = CATALOGUE[closure.effect].section(**closure.keys)
    size = np.array([closure.values(u)[parameter] for u in mean.levels])
    count, start, columns = mean.differences.shape[1], 0, [np.empty((0, departures.shape[2]))]
    for points, seen, case in curves:
        rows, times = front_rows(points)
        covariance = covariance_of(section, case.resolved, *seen.front.T, times)  # type: ignore[call-arg]
        own = np.zeros((len(rows), count))
        own[:, start + rows] = factor_of(covariance).T
        columns.append(own)
        start += len(points)
    of_front = np.vstack(columns)
    relative = departures / size[:, None, None]
    alone = np.sqrt((relative**2).sum(axis=1).mean(axis=0) / (SEEDS - 1.0))
    others = np.flatnonzero((alone > 0.0) & ~of_front.any(axis=0))
    errors = np.vstack([of_front, np.eye(count)[others] * alone])
    errors = errors[errors.any(axis=1)] * size.max() * np.sqrt(1.0 + 1.0 / SEEDS)
    return ScatteredResponse(mean.levels, mean.differences, errors, size / size.max())


def front_rows(points: "Points") -> tuple[np.ndarray, np.ndarray]:
    """Rows of the front and of the run-out, and their times [s]; that of the run-out is inf: at rest."""
    rows, times = [np.empty(0, int)], [np.empty(0)]
    for block in points.blocks:
        if block.observable in (FRONT, RUNOUT):
            rows.append(np.arange(block.start, block.stop))
            times.append(np.where(np.isnan(block.time), inf, block.time))
    return np.concatenate(rows), np.concatenate(times)


def factor_of(covariance: np.ndarray) -> np.ndarray:
    """F (n, n) with F F' = covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))
