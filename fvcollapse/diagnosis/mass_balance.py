"""Whether the measured profiles hold the grains of the column: a mass balance of the data, without a simulation.

    B(t) = integral of h dx / (area of the column (1 + V(t)))  -  1  =  shift + stretch phi(t)

with the measured relative change of volume V and phi the part of the grains that is beyond the gate. Where the column
is the one that is stated and V is right, both are zero however the grains move. A wrong scale shifts B from the first
frame on. A camera at the wall or above the middle, where grains move slower or faster than the mean of the width
(`transverse_profile`), sees what has passed the gate stretched by view factor - 1. A comparison with
simulated profiles cannot see this error: the discrepancy term absorbs it.

What it cannot do: a volume that was read off the same profiles balances whatever the view, so that agreement is
no evidence against one; grains lost unseen look like a view from the wall; heights read vertically, and
grains that lie on the bed from the start, look like a wrong scale.

References
----------
Bartlett (1935), J. R. Stat. Soc. 98, 536 (variance where neighbours in time are correlated); Kendall (1954),
Biometrika 41, 403 (bias of a correlation in short series).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.integrate import trapezoid

from fvcollapse.diagnosis.names import UNKNOWN, effects_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fvcollapse.case.case import Case
    from fvcollapse.case.sections import Geometry
    from fvcollapse.measure.curves import Curve
    from fvcollapse.measure.experiment import Experiment

# standard deviations of (shift, stretch)
UNMEASURED = (0.05, 0.10)  # V that was not measured; it may come at once or as the grains move
RIM = (0.0, 0.012)  # thin rim of the pile that is not seen
LEAST = 1.0e-4  # of both, of one experiment alone
# least standard deviations of the picture: of all heights (relative), of the origin of X and the zero of heights [m]
SCALE, ORIGIN, ZERO = 0.005, 0.001, 1.0e-4
VOLUME_MOST = 0.2  # of V in the first frame: what is larger is no relative change
BARE = 3.0  # standard deviations up to which a last thickness is the bed
BARE_SHARE = 0.03  # of height_0, up to which it must be anyway
AHEAD = 0.1  # of length_0: distance from the front at which the bed is bare
BED_POINTS = 20  # from which the bed is measured; by a line if they span length_0
NEAR_WALL = 0.1  # of length_0: where profiles begin
SPACING = 0.25  # of length_0: largest distance of places
LEAST_FRAMES, LEAST_RANGE = 10, 0.2  # number of profiles, and range of phi
LEAST_PHI = 0.02  # before, the upright face lies between two places
LARGEST_CORRELATION = 0.9  # from one frame to the next

# what changes the balance: probability that it does, and standard deviations of the change
VIEW_EFFECT = "transverse_profile"  # two of its three closures are seen from a side
CHANGES = {VIEW_EFFECT: (2.0 / 3.0, (0.0, 0.1)), UNKNOWN: (0.2, (0.05, 0.0))}
MISSTATED = 0.01  # probability that column or bed are not as stated, beside whatever acts
ANYTHING = (0.05, 0.1)


class MassBalance(NamedTuple):
    """Shift and stretch, parts of the column, (2,), and their covariance, (2, 2)."""

    mean: np.ndarray
    covariance: np.ndarray

    def log_odds(self, spread: "ArrayLike") -> float:
        """Logarithm of the density of `mean` if it scatters by `spread` (2,) more, over that if it does not."""
        wide = self.covariance + np.diag(np.square(spread))
        precision, wide_precision = np.linalg.inv(self.covariance), np.linalg.inv(wide)
        gain = self.mean @ (precision - wide_precision) @ self.mean
        return 0.5 * float(gain - np.linalg.slogdet(wide @ precision)[1])

    def logit(self, name: str) -> float:
        """Logarithm of the odds that a hypothesis gives to the balance, over one that conserves what is in view.

        Of the view it is never negative (see above). That column or bed may be misstated bounds it.
        """
        part = VIEW_EFFECT if VIEW_EFFECT in effects_of(name) else name
        if part not in CHANGES:
            return 0.0
        share, spread = CHANGES[part]
        conserved = np.logaddexp(np.log1p(-MISSTATED), np.log(MISSTATED) + self.log_odds(ANYTHING))
        changed = np.log(share) + self.log_odds(spread) - conserved
        found = float(np.logaddexp(np.log1p(-share), changed))
        return max(found, 0.0) if part == VIEW_EFFECT else found


def mass_balance(
    experiments: "Sequence[Experiment]", cases: "Mapping[str, Case]"
) -> MassBalance | None:
    """The `MassBalance` of all experiments together; None if none of them tells.

    The column of each is its own; how the pictures were taken is common to them.

    Parameters
    ----------
    experiments : sequence of Experiment
    cases : dict
        Name of each experiment -> `Case`: the initial column.
    """
    found: list[tuple[MassBalance, np.ndarray]] = [
        balance_of(one, cases[one.name].geometry)  # type: ignore[misc]
        for one in experiments
    ]
    found = [each for each in found if each is not None]
    if not found:
        return None
    precisions = [np.linalg.inv(own.covariance) for own, _ in found]
    covariance = np.linalg.inv(sum(precisions))
    mean = covariance @ sum(p @ own.mean for p, (own, _) in zip(precisions, found, strict=True))
    shared = np.mean([shared for _, shared in found], axis=0)
    return MassBalance(mean, covariance + np.diag(shared))


def balance_of(
    experiment: "Experiment", geometry: "Geometry"
) -> tuple[MassBalance, np.ndarray] | None:
    """(`MassBalance` with the errors of one experiment alone, variances (2,) of those that all share).

    None without ten profiles of different reach that show all grains.
    """
    if "profiles" not in experiment.curves:
        return None
    volume = volume_of(experiment)
    frames = np.array(list(frames_of(experiment, geometry, volume))).reshape(-1, 3)
    if len(frames) < LEAST_FRAMES or np.ptp(frames[:, 1]) < LEAST_RANGE:
        return None
    excess, beyond, reach = frames.T
    columns = np.column_stack([np.ones_like(beyond), beyond])
    mean, *_ = np.linalg.lstsq(columns, excess, rcond=None)
    rest = excess - columns @ mean
    degrees = len(rest) - 2  # of Student's t, whose variance is degrees / (degrees - 2)
    scatter = rest @ rest / (degrees - 2) * inflation(rest)
    height = experiment.standard_deviation("height_0", geometry.height_0) / geometry.height_0
    origin = experiment.standard_deviation("length_0", geometry.length_0)
    own = np.array([height**2 + (origin / geometry.length_0) ** 2, 0.0]) + LEAST**2
    own += np.square(UNMEASURED) if volume is None else [0.0, float(np.median(volume.sigma)) ** 2]
    shift = max(height, SCALE) ** 2 + (max(origin, ORIGIN) / geometry.length_0) ** 2
    lengths = np.array([geometry.length_0, np.median(reach) - geometry.length_0])
    zero = error_of_zero(experiment, geometry) * lengths / column_area(geometry)
    covariance = scatter * np.linalg.inv(columns.T @ columns) + np.diag(own)
    return MassBalance(mean, covariance), np.array([shift, 0.0]) + np.square(RIM) + zero**2


def column_area(geometry: "Geometry") -> float:
    """Area of the initial column, m2."""
    if not geometry.polygon:
        return geometry.height_0 * geometry.length_0
    x, z = np.array(geometry.polygon).T
    return 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1))


def volume_of(experiment: "Experiment") -> "Curve | None":
    """The measured relative change of volume; None if there is none, or if it does not begin near zero."""
    volume = experiment.curves.get("volume")
    return volume if volume is not None and abs(volume.value[0]) < VOLUME_MOST else None


def end_of_pile(experiment: "Experiment", geometry: "Geometry") -> np.ndarray:
    """Place at the time of every measured thickness beyond which there is nothing but the bed, (n,)."""
    time, front = experiment.curves["profiles"].time, experiment.curves.get("front")
    if front is None:
        return np.full_like(time, np.inf)
    farthest = np.maximum.accumulate(front.value)
    return np.interp(time, front.time, farthest) + AHEAD * geometry.length_0


def error_of_zero(experiment: "Experiment", geometry: "Geometry") -> float:
    """Standard deviation of the zero of the heights, m: what is measured where nothing but the bed is.

    It is not taken off: of errors that are cut at zero the mean is positive too.
    """
    profiles = experiment.curves["profiles"]
    bare = profiles.x > end_of_pile(experiment, geometry)
    if np.count_nonzero(bare) < BED_POINTS:
        return float(np.median(profiles.sigma))
    x, h = profiles.x[bare], profiles.value[bare]
    bed = np.polyfit(x, h, 1 if np.ptp(x) > geometry.length_0 else 0)
    return max(float(np.sqrt(np.mean(np.polyval(bed, profiles.x) ** 2))), ZERO)


def frames_of(
    experiment: "Experiment", geometry: "Geometry", volume: "Curve | None"
) -> Iterator[tuple[float, float, float]]:
    """(B, phi, end of the pile [m]) of every profile that shows all grains while or after they move."""
    time, x, h, sigma = experiment.curves["profiles"]
    end = end_of_pile(experiment, geometry)
    limit = np.minimum(BARE * sigma, BARE_SHARE * geometry.height_0)
    for moment in np.unique(time):
        own = (time == moment) & (x <= end)
        place, thickness = x[own], h[own]
        begins = len(place) > 1 and place[0] <= NEAR_WALL * geometry.length_0
        if not (
            begins
            and np.diff(place).max() <= SPACING * geometry.length_0
            and abs(thickness[-1]) <= limit[own][-1]
        ):
            continue
        area = thickness[0] * place[0] + trapezoid(thickness, place)
        swollen = 1.0 if volume is None else 1.0 + np.interp(moment, volume.time, volume.value)
        if area <= 0.0 or swollen <= 0.0:
            continue
        beyond = area_beyond(place, thickness, geometry.length_0) / area
        if beyond >= LEAST_PHI:
            yield area / (column_area(geometry) * swollen) - 1.0, beyond, place[-1]


def area_beyond(x: np.ndarray, thickness: np.ndarray, gate: float) -> float:
    """Area under a profile beyond the gate."""
    further = x > gate
    at_gate = np.interp(gate, x, thickness)
    return trapezoid(np.append(at_gate, thickness[further]), np.append(gate, x[further]))


def inflation(rest: np.ndarray) -> float:
    """Factor of the variance of a mean over residuals that follow one another in time."""
    square = float(rest @ rest)
    found = float(rest[1:] @ rest[:-1]) / square if square > 0.0 else 0.0
    found = min(max(found + (1.0 + 3.0 * found) / len(rest), 0.0), LARGEST_CORRELATION)
    return (1.0 + found) / (1.0 - found)
