"""Where simulation and measurement differ beyond all uncertainties.

Every point has z = gap / combined standard uncertainty (V&V 20; |z| <= 2: inside the validation
uncertainty). Significant regions are clusters of neighbouring points with |z| > 2 of one sign, whose
mass, the sum of |z| - 2, is larger than what simulated gaps without a cause, drawn from N(0, U), have.
Masses are compared within their curve, and the smallest probability over all curves with the one
of the same simulations: 5 % false alarms over everything, under the correlation as it is.
A second view is the false discovery rate of single points after Benjamini & Yekutieli.

The shares of E' U^-1 E come from the whitening that changes each point least (ZCA-cor), so that they
are not negative and sum to one.

References
----------
ASME V&V 20 (2009); Bullmore et al. (1999), IEEE Trans. Med. Imaging 18, 32 (cluster mass); Westfall &
Young (1993), Resampling-based multiple testing; Benjamini & Yekutieli (2001), Ann. Stat. 29, 1165; Kessy,
Lewin & Strimmer (2018), Am. Stat. 72, 309 (whitening).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsFloat

import numpy as np
from scipy.linalg import cholesky, eigh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.stats import false_discovery_control, norm

from fvcollapse.diagnosis.points import PHASES

if TYPE_CHECKING:
    from fvcollapse.diagnosis.points import Block, Points

THRESHOLD = 2.0  # |z| inside the validation uncertainty
FALSE_ALARM = 0.05
NULLS = 2000
REACH = 0.75  # of the spacing of the places: neighbours at successive moments


class Region(NamedTuple):
    """Neighbouring points at which the gap is significant.

    `t_range` [s] and `x_range` [m] are None where the observable has no time or place; `gap` is the
    mean of simulated - measured, `uncertainty` its combined standard uncertainty, `significance`
    their ratio; `p_value` is family-wise; `points` are the indices (n,).
    """

    experiment: str
    observable: str
    units: str
    t_range: tuple[float, float] | None
    x_range: tuple[float, float] | None
    gap: float
    uncertainty: float
    significance: float
    p_value: float
    points: np.ndarray


class Share(NamedTuple):
    """Part of E' U^-1 E in one observable and phase of one run; `sign` is +1 if simulated is larger."""

    experiment: str
    observable: str
    phase: str
    share: float
    sign: int


class Level(NamedTuple):
    """Gap of one observable: rms, combined standard uncertainty (rms) and their ratio.

    `experiment` is "" for all together.
    """

    experiment: str
    observable: str
    units: str
    rms: float
    combined: float
    ratio: float


@dataclass(frozen=True)
class GapMap:
    """Where the gap lies.

    Attributes
    ----------
    gap, uncertainty, z : (N,) arrays
        Of a bound only what is beyond it.
    regions : tuple of Region
        Significant at a family-wise 5 %, the most significant first.
    discoveries : (N,) bool array
        Points at a false discovery rate of 5 %.
    shares : tuple of Share
    by_observable : tuple of Level
    """

    gap: np.ndarray
    uncertainty: np.ndarray
    z: np.ndarray
    regions: tuple[Region, ...]
    discoveries: np.ndarray
    shares: tuple[Share, ...]
    by_observable: tuple[Level, ...]


def gap_map(
    points: "Points", simulated: np.ndarray, covariance: np.ndarray, rng: np.random.Generator
) -> GapMap:
    """The `GapMap` of simulated values.

    Parameters
    ----------
    points : Points
    simulated : (N,) array
        On the points.
    covariance : (N, N) array
        U, of everything but the error of the model.
    rng : numpy.random.Generator
        Draws the gaps without a cause.
    """
    gap = beyond_bounds(points, simulated - points.measured)
    uncertainty = np.sqrt(np.diag(covariance))
    z = gap / uncertainty
    regions = significant_regions(points, gap, z, covariance, rng)
    one_sided = points.kind != "value"
    p = norm.sf(np.abs(z)) * np.where(one_sided, 1.0, 2.0)
    discoveries = false_discovery_control(p, method="by") <= FALSE_ALARM
    shares = shares_of(points, gap, covariance)
    levels = (*levels_of(points, gap, uncertainty), *levels_of(points, gap, uncertainty, True))
    return GapMap(gap, uncertainty, z, regions, discoveries, shares, levels)


def beyond_bounds(points: "Points", difference: np.ndarray) -> np.ndarray:
    """Gaps (..., N): of a bound only what is beyond it."""
    kind = points.kind
    difference = np.where(kind == "upper", np.maximum(difference, 0.0), difference)
    return np.where(kind == "lower", np.minimum(difference, 0.0), difference)


def significant_regions(
    points: "Points",
    gap: np.ndarray,
    z: np.ndarray,
    covariance: np.ndarray,
    rng: np.random.Generator,
) -> tuple[Region, ...]:
    """The regions whose mass no more than 5 % of simulated gaps without a cause reach anywhere."""
    factor = cholesky(covariance, lower=True, check_finite=False)
    nulls = rng.standard_normal((NULLS, len(points))) @ factor.T
    nulls = beyond_bounds(points, nulls) / np.sqrt(np.diag(covariance))
    smallest, found = np.ones(NULLS), []
    for block in points.blocks:
        own = slice(block.start, block.stop)
        edges = neighbours(block)
        labels, masses = clusters(nulls[:, own], edges)
        largest = np.zeros(NULLS)
        np.maximum.at(largest, labels.pop("sample"), masses)
        smallest = np.minimum(smallest, probability(largest, np.sort(largest)))
        labels, masses = clusters(z[None, own], edges)
        for mass, members in zip(masses, labels["members"], strict=True):
            found.append((block, block.start + members, probability(mass, np.sort(largest))))
    smallest = np.sort(smallest)
    regions = []
    for block, members, p in found:
        p_value = (1 + np.searchsorted(smallest, p, side="right")) / (NULLS + 1)
        if p_value <= FALSE_ALARM:
            regions.append(region_of(block, members, gap, covariance, p_value))
    regions.sort(key=lambda region: (region.p_value, -abs(region.significance)))
    return tuple(regions)


def probability(mass: np.ndarray | float, largest: np.ndarray) -> np.ndarray | float:
    """Share of the sorted largest masses that reach a mass; a mass of zero is reached by all."""
    return (1 + NULLS - np.searchsorted(largest, mass, side="left")) / (NULLS + 1)


def neighbours(block: "Block") -> np.ndarray:
    """Pairs (k, 2) of neighbouring points of a block, counted from its start."""
    if len(block.time) == 1:
        return np.empty((0, 2), int)
    moments = [np.flatnonzero(block.time == moment) for moment in np.unique(block.time)]
    if np.isnan(block.x).all():
        return np.array([(a[0], b[0]) for a, b in pairwise(moments)])
    pairs = [pair for row in moments for pair in pairwise(row)]
    spacings = [block.x[b] - block.x[a] for a, b in pairs]
    reach = REACH * (np.median(spacings) if spacings else np.inf)
    for before, after in pairwise(moments):
        near = np.abs(block.x[before][:, None] - block.x[after]) <= reach
        pairs += [(before[i], after[j]) for i, j in np.argwhere(near)]
    return np.array(pairs, int).reshape(-1, 2)


def clusters(z: np.ndarray, edges: np.ndarray) -> tuple[dict[str, Any], np.ndarray]:
    """Clusters of |z| > 2 of one sign in samples (m, n).

    Returns
    -------
    dict, (k,) array
        "sample" (k,) and "members" (list of k index arrays) of the clusters; their masses.
    """
    m, n = z.shape
    sign = np.where(np.abs(z) > THRESHOLD, np.sign(z), 0.0)
    a, b = edges[:, 0], edges[:, 1]
    sample, edge = np.nonzero((sign[:, a] != 0.0) & (sign[:, a] == sign[:, b]))
    start, stop = sample * n + a[edge], sample * n + b[edge]
    graph = coo_array((np.ones(len(start), bool), (start, stop)), shape=(m * n, m * n))
    _, label = connected_components(graph, directed=False)
    active = np.flatnonzero(sign)
    _, first, own = np.unique(label[active], return_index=True, return_inverse=True)
    masses = np.bincount(own, np.abs(z.ravel()[active]) - THRESHOLD, len(first))
    members = [active[own == k] % n for k in range(len(first))] if m == 1 else []
    return {"sample": active[first] // n, "members": members}, masses


def region_of(
    block: "Block",
    members: np.ndarray,
    gap: np.ndarray,
    covariance: np.ndarray,
    p_value: SupportsFloat,
) -> Region:
    """The `Region` of some points of a block."""
    inside = members - block.start
    time, x = block.time[inside], block.x[inside]
    t_range = None if np.isnan(time).any() else (float(time.min()), float(time.max()))
    x_range = None if np.isnan(x).any() else (float(x.min()), float(x.max()))
    mean = float(gap[members].mean())
    deviation = float(np.sqrt(covariance[np.ix_(members, members)].mean()))
    return Region(
        *(block.experiment, block.observable, block.units, t_range, x_range, mean, deviation),
        *(mean / deviation, float(p_value), members),
    )


def shares_of(points: "Points", gap: np.ndarray, covariance: np.ndarray) -> tuple[Share, ...]:
    """The `Share` of every observable and phase of every run."""
    deviation = np.sqrt(np.diag(covariance))
    size, turn = eigh(covariance / np.outer(deviation, deviation), driver="evd")
    white = turn @ ((turn.T @ (gap / deviation)) / np.sqrt(np.maximum(size, 1.0e-12)))
    squares = white**2
    total = max(float(squares.sum()), 1.0e-300)
    phase, shares = points.phase, []
    for block in points.blocks:
        for name in PHASES:
            own = block.start + np.flatnonzero(phase[block.start : block.stop] == name)
            if len(own):
                sign = int(np.sign((gap[own] / deviation[own]).sum()))
                share = float(squares[own].sum()) / total
                shares.append(Share(block.experiment, block.observable, name, share, sign))
    return tuple(shares)


def levels_of(
    points: "Points", gap: np.ndarray, uncertainty: np.ndarray, together: bool = False
) -> Iterator[Level]:
    """The `Level` of every observable, run by run or of all runs together."""
    levels: dict[tuple[str, str, str], list[np.ndarray]] = {}
    for block in points.blocks:
        key = ("" if together else block.experiment, block.observable, block.units)
        levels.setdefault(key, []).append(np.arange(block.start, block.stop))
    for key, parts in levels.items():
        own = np.concatenate(parts)
        rms = float(np.sqrt(np.mean(gap[own] ** 2)))
        combined = float(np.sqrt(np.mean(uncertainty[own] ** 2)))
        yield Level(*key, rms, combined, rms / combined)
