"""The size of a gap and the fraction of it that an effect closes.

The size of a gap is its root mean square beyond the noise: with z = gap / sd, sd that of measurement and
discretisation, sqrt(max(0, mean(z^2) - 1)); in units of an observable the same with gap and sd. Fraction
closed = 1 - size after / size before. Its range covers what another realisation of the noise would give
(90 %) and the values of all experiments that were left or held out.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cholesky

from fvcollapse.diagnosis.gap_map import beyond_bounds
from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.points import Points

if TYPE_CHECKING:
    from fvcollapse.case.case import Case

REALISATIONS = 400  # of the noise
SMALLEST_SIZE = 1.0e-3  # relative to the noise: no gap to close
RANGE = (5.0, 95.0)  # percentiles


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

    points: Points
    cases: "dict[str, Case]"
    shifts: dict[str, np.ndarray]
    covariance: np.ndarray
    simulated: dict[str, np.ndarray]


class Closing(NamedTuple):
    """Sizes of a gap before and after, the fraction that closed and its range."""

    before: float
    after: float
    fraction: float
    interval: tuple[float, float]


def gaps_of(group: Group, model: str) -> np.ndarray:
    """Simulated - measured after what the controls let expect, (n,); of a bound what is beyond it."""
    shown = group.simulated[model] - group.shifts[model]
    return beyond_bounds(group.points, shown - group.points.measured)


def remaining(group: Group, own: slice, model: str) -> float:
    """Root mean square of the gap that is left on some points, noise included, in standard deviations."""
    deviation = np.sqrt(np.diag(group.covariance))[own]
    return float(np.sqrt(np.mean((gaps_of(group, model)[own] / deviation) ** 2)))


def size(gap: np.ndarray, deviation: np.ndarray) -> float:
    """Root mean square of a gap beyond the noise, in the units of both."""
    return float(np.sqrt(max(0.0, np.mean(gap**2) - np.mean(deviation**2))))


def closing(
    group: Group,
    model: str,
    rows: np.ndarray | slice,
    seed: int,
    in_units: bool = False,
    values: Sequence[float] = (),
) -> Closing:
    """The `Closing` between the baseline and a model on some points.

    Parameters
    ----------
    group : Group
    model : str
    rows : (n,) bool array
    seed : int
        Of the realisations of the noise.
    in_units : bool
        Sizes in the units of the observable, not in standard deviations.
    values : sequence of float
        Fractions that the range must cover.
    """
    deviation = np.sqrt(np.diag(group.covariance))[rows]
    gaps = [gaps_of(group, which)[rows] for which in (BASELINE, model)]
    scale = np.ones_like(deviation) if in_units else deviation
    noise = deviation / scale
    sizes = [size(gap / scale, noise) for gap in gaps]
    fraction = fraction_closed(*sizes, noise)  # type: ignore[arg-type, call-arg]
    factor = cholesky(group.covariance, lower=True, check_finite=False)
    draws = np.random.default_rng(seed).standard_normal((REALISATIONS, len(factor)))
    errors = (draws @ factor.T)[:, rows] / scale
    again = [
        fraction_closed(*(size(gap / scale + error, np.sqrt(2.0) * noise) for gap in gaps), noise)  # type: ignore[arg-type, call-arg]
        for error in errors
    ]
    low, high = np.percentile(again, RANGE)
    found = (fraction, low, high, *values)
    return Closing(*sizes, fraction, (float(min(found)), float(max(found))))  # type: ignore[arg-type, call-arg]


def fraction_closed(before: float, after: float, noise: np.ndarray) -> float:
    """1 - after / before, at least -1; 0 where there is no gap to close."""
    least = SMALLEST_SIZE * float(np.sqrt(np.mean(noise**2)))
    if before <= least:
        return 0.0 if after <= least else -1.0
    return float(max(-1.0, 1.0 - after / before))


def with_simulated(group: Group, simulated: dict[str, np.ndarray]) -> Group:
    """The group with other values of some models."""
    return group._replace(simulated=group.simulated | simulated)


def one_fraction(group: Group, own: slice, model: str) -> float:
    """Fraction closed in the experiment whose points are `own`."""
    deviation = np.sqrt(np.diag(group.covariance))[own]
    noise = np.ones(len(deviation))
    sizes = [size(gaps_of(group, each)[own] / deviation, noise) for each in (BASELINE, model)]
    return fraction_closed(*sizes, noise)  # type: ignore[arg-type, call-arg]
