"""The part of a gap that no hypothesis explains: where, when, in which direction, how large, and what it resembles.

The remainder is the gap (simulated - measured) with the response to the best hypothesis of the catalogue added where
that closes half of it, else the gap itself: what a wrong effect leaves has the form of that effect too. Its
significant regions are found as those of the gap map. Every point of them has a place in the pile, a phase of the
collapse, and says whether the simulated grains move too easily (+1) or not easily enough (-1): a front too far, too
much at the front or too little at the back wall is +1, an interface too high is -1; a thickness in the middle says
neither, nor does a volume. Shares are those of the sum of z^2.

Likeness is the cosine between the whitened remainder, with the sign turned, and a whitened response: +1 is an effect
that would take it away. What speaks against the effect is its strength (the length that is needed over the
largest that its prior allows) and the observables that it would make worse.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from fvcollapse.diagnosis.gap_map import Region, beyond_bounds, significant_regions
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from fvcollapse.diagnosis.practical import sizes_left
from fvcollapse.diagnosis.separability import DISCREPANCY
from fvcollapse.measure.quantities import QUANTITIES

if TYPE_CHECKING:
    from collections.abc import Collection

    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.evidence import Hypothesis
    from fvcollapse.diagnosis.points import Block, Points
    from fvcollapse.diagnosis.report.parts import Range
    from fvcollapse.measure.experiment import Experiment

    Pair = tuple[np.ndarray, np.ndarray]

FRONT, THIN, MIDDLE, BACK, PILE = "front", "thin part", "middle", "back wall", "whole pile"
THIN_SHARE = 0.1  # of the height of the column: layers that are thinner are thin
BACK_SHARE = 0.5  # of the length of the column: places that are nearer are at the back wall
AHEAD = 0.5  # of the way to the front from which thin layers belong to the front part
EASY = {FRONT: 1, THIN: 1, MIDDLE: 0, BACK: -1, PILE: 0}  # what a value too large says of motion
RESEMBLES = 0.3  # cosine from which an effect is named
MOST_ALIKE = 3  # effects that are named
HALF = 0.5  # share of the gap from which a hypothesis counts as explaining it
WORSE = 1.05  # ratio of root mean squares from which an observable is made worse
PLACES = {  # of observables without a place of their own
    "front": FRONT,
    "runout": FRONT,
    "peak_front_velocity": FRONT,
    "time_stop": FRONT,
    "final_height": BACK,
    "volume": PILE,
}


class Share(NamedTuple):
    """Part of the remainder in one place and phase; `direction` from -1 to 1, +1: moves too easily."""

    place: str
    phase: str
    share: float
    direction: float


class Size(NamedTuple):
    """Remainder of one observable in its regions: root mean square, mean [its units], and rms in sd."""

    observable: str
    units: str
    rms: float
    mean: float
    deviations: float


class Likeness(NamedTuple):
    """How an effect resembles the remainder.

    Attributes
    ----------
    effect : str
    cosine : float
    strength : float
        Needed strength over the largest that its prior allows; 0 where the cosine is negative.
    worse : tuple of str
        Observables whose remainder it would enlarge.
    """

    effect: str
    cosine: float
    strength: float
    worse: tuple[str, ...]


class Unexplained(NamedTuple):
    """The part of a gap that no hypothesis explains.

    Attributes
    ----------
    beside, p_value : str, float
        Hypothesis whose response has been taken off ("none": the whole gap); chi-square check of what that leaves.
    z : (N,) array
        What is left, simulated - measured, in combined standard uncertainties.
    regions, shares, sizes : tuples of gap_map.Region, Share, Size
        Its significant regions, without which there are no shares and no sizes; the largest share first.
    direction : float
        From -1 to 1, of everything; 0 also where nothing says it.
    experiment, t_range, span : str, (float, float) or None, (float, float) or None
        That which has most of it; first and last time of its regions, and of all that was compared there [s].
    resembles : tuple of Likeness
        The most alike first, at most three.
    """

    beside: str
    p_value: float
    z: np.ndarray
    regions: tuple[Region, ...]
    shares: tuple[Share, ...]
    sizes: tuple[Size, ...]
    direction: float
    experiment: str
    t_range: "Range | None"
    span: "Range | None"
    resembles: tuple[Likeness, ...]


def unexplained(analysis: "Analysis", names: "Collection[str] | None" = None) -> Unexplained:
    """The `Unexplained` part of the gap of an `Analysis`; `names`: hypotheses that a verdict compares, default all."""
    points, covariance = analysis.points, analysis.covariance
    best = explaining(analysis, names)
    gap = analysis.gap + best.difference
    remainder = beyond_bounds(points, gap)
    z = remainder / np.sqrt(np.diag(covariance))
    rng = np.random.default_rng([analysis.seed, 3])
    regions = significant_regions(points, remainder, z, covariance, rng)
    own = np.concatenate([region.points for region in regions]) if regions else np.empty(0, int)
    weight = np.zeros(len(points))
    weight[own] = z[own] ** 2
    place = places_of(points, points.measured + remainder)
    easy = motion_of(points, place, remainder)
    return Unexplained(
        best.name,
        best.p_value,
        z,
        regions,
        shares_of(place, points.phase, weight, easy),
        sizes_of(points, remainder, z, own),
        direction_of(weight, easy),
        *moments_of(points, weight),
        likenesses(analysis, gap, best.name.split("+")),
    )


def explaining(analysis: "Analysis", names: "Collection[str] | None" = None) -> "Hypothesis":
    """The best `Hypothesis` of the catalogue, of some names, if it closes half of the gap; else that of none."""
    hypotheses, sizes = analysis.evidence.hypotheses, sizes_left(analysis)
    compared = hypotheses if names is None else [name for name in hypotheses if name in names]
    best = next(name for name in compared if name != UNKNOWN)
    closes = best != NONE and sizes[best] <= HALF * sizes[NONE] and sizes[NONE] > 0.0
    return hypotheses[best if closes else NONE]


# -- where and when ------------------------------------------------------------------------------


def places_of(points: "Points", simulated: np.ndarray) -> np.ndarray:
    """Place of each point in the pile, (N,): `FRONT`, `THIN`, `MIDDLE`, `BACK` or `PILE`."""
    places = np.full(len(points), MIDDLE, object)
    for block in points.blocks:
        own = slice(block.start, block.stop)
        if np.isnan(block.x).all():
            places[own] = PLACES.get(block.observable, PILE)
            continue
        experiment = next(one for one in points.experiments if one.name == block.experiment)
        if block.observable == "profiles":
            heights = points.measured[own], simulated[own]
            places[own] = places_along(block, heights, experiment)
        near = block.x < BACK_SHARE * experiment.settings.geometry.length_0  # type: ignore[operator]
        places[own][near] = BACK
    return places


def places_along(block: "Block", heights: "Pair", experiment: "Experiment") -> np.ndarray:
    """Places (n,) of a profile whose thicknesses are measured and simulated, (n,) each."""
    places, threshold = np.full(len(block.x), MIDDLE, object), experiment.case().front.thickness
    thin = np.maximum(*heights) < THIN_SHARE * experiment.settings.geometry.height_0  # type: ignore[operator]
    for moment in np.unique(block.time):
        rows = np.flatnonzero(block.time == moment)
        ends = [block.x[rows][h[rows] >= threshold].max(initial=0.0) for h in heights]
        x = block.x[rows]
        places[rows[thin[rows] & (x >= AHEAD * min(ends))]] = THIN
        places[rows[x >= min(ends)]] = FRONT
    return places


def motion_of(points: "Points", place: np.ndarray, remainder: np.ndarray) -> np.ndarray:
    """+1 where the simulated grains move too easily, -1 where not easily enough, 0 where it does not say, (N,)."""
    easy = np.array([EASY[each] for each in place])
    for block in points.blocks:
        own = slice(block.start, block.stop)
        if block.observable == "interface":
            easy[own] = -1
        if block.units not in ("m", "s", "m/s") or block.observable not in QUANTITIES:
            easy[own] = 0
    return easy * np.sign(remainder)


def shares_of(
    place: np.ndarray, phase: np.ndarray, weight: np.ndarray, easy: np.ndarray
) -> tuple[Share, ...]:
    """The `Share`s of the weight (N,), the largest first; what has none is left out."""
    total, shares = weight.sum(), []
    for where, when in dict.fromkeys(zip(place.tolist(), phase.tolist(), strict=True)):
        own = (place == where) & (phase == when)
        if weight[own].sum() > 0.0:
            share = float(weight[own].sum() / total)
            shares.append(Share(where, when, share, direction_of(weight[own], easy[own])))
    return tuple(sorted(shares, key=lambda one: -one.share))


def direction_of(weight: np.ndarray, easy: np.ndarray) -> float:
    """Mean of `motion_of` over the points that say it; 0 without any."""
    total = float((weight * np.abs(easy)).sum())
    return float((weight * easy).sum()) / total if total > 0.0 else 0.0


def moments_of(points: "Points", weight: np.ndarray) -> "tuple[str, Range | None, Range | None]":
    """(experiment, range of its times with weight, range of all its times) of the one with most weight."""
    sums = {name: weight[points.of(name)].sum() for name in points.names}
    name = max(sums, key=sums.get)  # type: ignore[arg-type]
    own = points.of(name)
    time, here = points.time[own], weight[own] > 0.0
    timed = np.isfinite(time)
    if not (timed & here).any():
        return name, None, None
    ranges = [time[rows] for rows in (timed & here, timed)]
    return name, *((float(some.min()), float(some.max())) for some in ranges)  # type: ignore[return-value]


def sizes_of(
    points: "Points", remainder: np.ndarray, z: np.ndarray, own: np.ndarray
) -> tuple[Size, ...]:
    """The `Size` of every observable that has points among `own`."""
    observable, sizes = points.observable, []
    units = {block.observable: block.units for block in points.blocks}
    for name, unit in units.items():
        rows = own[observable[own] == name]
        if len(rows):
            root, deviations = (float(np.sqrt(np.mean(v[rows] ** 2))) for v in (remainder, z))
            sizes.append(Size(name, unit, root, float(remainder[rows].mean()), deviations))
    return tuple(sizes)


# -- what it resembles -----------------------------------------------------------------------------


def likenesses(analysis: "Analysis", gap: np.ndarray, without: list[str]) -> tuple[Likeness, ...]:
    """The `Likeness` of the effects that resemble what is left of a gap (N,), those of `without` left out."""
    points = analysis.points
    covariance = analysis.covariance + DISCREPANCY**2 * analysis.kernel
    factor = cholesky(covariance, lower=True, check_finite=False)
    left = beyond_bounds(points, gap)
    wanted = -solve_triangular(factor, left, lower=True, check_finite=False)
    found = []
    for name, closures in analysis.responses.items():
        runs = np.vstack([closure.differences for closure in closures])
        runs = runs[np.abs(runs).max(axis=1) > 0.0]  # the level at which it vanishes tells nothing
        if name not in without and len(runs):
            white = solve_triangular(factor, runs.T, lower=True, check_finite=False).T
            found.append(likeness(name, points, gap, wanted, (runs, white)))
    found = [one for one in found if abs(one.cosine) >= RESEMBLES]
    return tuple(sorted(found, key=lambda one: -abs(one.cosine))[:MOST_ALIKE])


def likeness(
    name: str, points: "Points", gap: np.ndarray, wanted: np.ndarray, levels: "Pair"
) -> Likeness:
    """The `Likeness` of an effect whose levels are given, (m, N), plain and whitened."""
    runs, white = levels
    lengths = np.linalg.norm(white, axis=1)
    cosines = white @ wanted / np.maximum(lengths * np.linalg.norm(wanted), 1.0e-300)
    alike = int(np.argmax(np.abs(cosines)))
    cosine = float(np.clip(cosines[alike], -1.0, 1.0))
    if cosine <= 0.0:
        return Likeness(name, cosine, 0.0, ())
    direction = white[alike] / lengths[alike]
    needed, largest = float(wanted @ direction), float((white @ direction).max())
    change = runs[alike] * min(needed, largest) / lengths[alike]
    return Likeness(name, cosine, needed / largest, made_worse(points, gap, change))


def made_worse(points: "Points", gap: np.ndarray, change: np.ndarray) -> tuple[str, ...]:
    """Observables whose gap (N,) a change (N,) enlarges."""
    observable, worse = points.observable, []
    before, after = (beyond_bounds(points, values) for values in (gap, gap + change))
    for name in dict.fromkeys(observable.tolist()):
        own = observable == name
        if (after[own] ** 2).sum() > WORSE**2 * (before[own] ** 2).sum():
            worse.append(name)
    return tuple(worse)
