"""Whether something is left that asks for an explanation: beyond chance, and larger than honest errors of a model.

A gap may be significant and still be no cause: two codes that solve the same equations differ by millimetres, and a
laboratory that measures better than that sees it. Beside the statistical tests (regions of the gap map, chi-square of
"none") stands the size of what no calibration explains, in the units of the observable, and what it is compared with.

    r' = r - Sigma_nu U^-1 r        beyond = sqrt(max(0, mean r'^2 - mean sd^2))

r is the gap (simulated - measured, after what controls let expect), r' what a linear re-calibration leaves of it, sd
the standard deviation of measurement and grid. With controls r is judged after them and they have calibrated it.

References
----------
Kennedy & O'Hagan (2001), J. R. Stat. Soc. B 63, 425; ASME V&V 20 (2009).
"""

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from fvcollapse.diagnosis.closing import size
from fvcollapse.diagnosis.covariance import discrepancy_of
from fvcollapse.diagnosis.evidence import CHECK_PASSED
from fvcollapse.diagnosis.gap_map import beyond_bounds
from fvcollapse.diagnosis.left import Left
from fvcollapse.diagnosis.names import NONE, UNKNOWN

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.points import Block, Points

# What two codes for the same equations differ by, root mean square over the points of a diagnosis, without noise: the
# thickness in heights of the column, the front in distances that it travels. A volume-of-fluid code (no slip, no walls)
# against this one on the finer cells of a diagnosis (8.75 mm), `python -m runs.cross_code.study differences`. On 3 mm
# cells of that code 1.63 mm (0 degrees) and 1.97 mm (22) of a column of 140 mm, 10 of 210 mm and 85 of 1058 mm of way;
# on 6 mm cells 1.89 and 2.15 mm, 14 of 210 mm and 125 of 1128 mm. The largest of these count: which grid a code has is
# no cause either. (The null of that study asks about the same collapses: it does not test these numbers.) The front at
# 22 degrees is the end of a layer of millimetres, on whose thickness both agree.
CROSS_CODE = {"profiles": 0.0154, "front": 0.111}


class Practical(NamedTuple):
    """Size of what is left of one observable, and what it is compared with; in the units of the observable.

    Attributes
    ----------
    observable, units : str
    gap : float
        Root mean square that no re-calibration explains.
    beyond : float
        Part of it beyond the noise of measurement and grid.
    share : float
        beyond^2 / gap^2.
    uncertainty : float
        Combined standard uncertainty, root mean square.
    controls : float or None
        Standard deviation of the error of the model that the controls leave open; None without controls.
    codes : float or None
        What two codes for the same equations differ by (`CROSS_CODE`); None where that was not measured.
    """

    observable: str
    units: str
    gap: float
    beyond: float
    share: float
    uncertainty: float
    controls: float | None
    codes: float | None

    @property
    def honest(self) -> float:
        """The error that a model may have although nothing is missing.

        As controls show it, else what codes differ by, else the combined uncertainty.
        """
        if self.controls is not None:
            return self.controls
        return self.uncertainty if self.codes is None else self.codes

    @property
    def is_larger(self) -> bool:
        """Whether more is left than an honest error of the model."""
        return self.beyond > self.honest


class Remainder(NamedTuple):
    """What is left without an effect.

    Attributes
    ----------
    regions : int
        Significant regions of the gap map.
    p_value : float
        Chi-square check of "none".
    practical : tuple of Practical
        One for each observable.
    left, best_left : float
        Size of the gap beyond the noise [standard deviations] after a re-calibration, without an effect and with
        the one that closes most, as the responses foresee it.
    best : str
        Name of the hypothesis that closes most; "none" where none closes anything.
    """

    regions: int
    p_value: float
    practical: tuple[Practical, ...]
    left: float
    best_left: float
    best: str

    @property
    def gain(self) -> float:
        """Fraction of the re-calibrated gap that the best effect closes."""
        return 1.0 - self.best_left / self.left if self.left > 0.0 else 0.0

    @property
    def is_significant(self) -> bool:
        """Whether chance does not explain it: a region of the map, or all points taken together."""
        return self.regions > 0 or self.p_value < CHECK_PASSED

    @property
    def largest(self) -> float:
        """Largest size beyond noise over an honest error of the model."""
        return max(
            (part.beyond / max(part.honest, 1.0e-12) for part in self.practical), default=0.0
        )

    @property
    def is_practical(self) -> bool:
        """Whether some observable is off by more than an honest error of the model."""
        return any(part.is_larger for part in self.practical)

    @property
    def is_something(self) -> bool:
        """Whether there is something to explain; without it the cause is not "unknown"."""
        return self.is_significant and self.is_practical


def something_unexplained(analysis: "Analysis") -> Remainder:
    """The `Remainder` of an `Analysis`; `is_something` says whether there is anything to explain."""
    hypotheses = analysis.evidence.hypotheses
    sizes = sizes_left(analysis)
    best = min(sizes, key=sizes.get)  # type: ignore[arg-type]
    return Remainder(
        regions=len(analysis.gap_map.regions),
        p_value=hypotheses[NONE].p_value,
        practical=practical_sizes(analysis, recalibration_of(analysis)(analysis.gap)),
        left=sizes[NONE],
        best_left=sizes[best],
        best=best,
    )


def with_left(analysis: "Analysis") -> "Analysis":
    """The analysis whose evidence tells what is `left`."""
    remainder = something_unexplained(analysis)
    left = Left(remainder.regions, remainder.largest, remainder.gain)
    return dataclasses.replace(analysis, evidence=dataclasses.replace(analysis.evidence, left=left))


def sizes_left(analysis: "Analysis") -> dict[str, float]:
    """{hypothesis but "unknown": size of the re-calibrated gap beyond the noise}, "none" first."""
    noise, calibrate = noise_of(analysis), recalibration_of(analysis)
    hypotheses = analysis.evidence.hypotheses
    names = [NONE, *(name for name in hypotheses if name not in (NONE, UNKNOWN))]
    gaps = {name: calibrate(analysis.gap + hypotheses[name].difference) for name in names}
    return {name: size(gap / noise, np.ones(len(noise))) for name, gap in gaps.items()}


def noise_of(analysis: "Analysis") -> np.ndarray:
    """Standard deviation of measurement and grid, (N,)."""
    return np.sqrt(np.diag(analysis.measurement + analysis.numerical))


def recalibration_of(analysis: "Analysis") -> Callable[[np.ndarray], np.ndarray]:
    """The function (gap (N,)) that takes off what a linear re-calibration explains, (N,); of a bound what is beyond."""
    points, covariance = analysis.points, analysis.covariance

    def calibrate(gap: np.ndarray) -> np.ndarray:
        gap = beyond_bounds(points, gap)
        rows = (points.kind == "value") | (gap != 0.0)
        if analysis.controls or not rows.any():
            return gap
        factor = cho_factor(covariance[np.ix_(rows, rows)], lower=True, check_finite=False)
        explained = analysis.calibration[:, rows] @ cho_solve(factor, gap[rows])
        return beyond_bounds(points, np.where(rows, gap - explained, 0.0))

    return calibrate


def practical_sizes(analysis: "Analysis", gap: np.ndarray) -> tuple[Practical, ...]:
    """The `Practical` of every observable, for what a re-calibration leaves of the gap (N,)."""
    points, noise = analysis.points, noise_of(analysis)
    variance, observable = np.diag(analysis.covariance), points.observable
    scale = points.per_point(lambda block: scale_of(points, block))
    units = {block.observable: block.units for block in points.blocks}
    parts = []
    for name in units:
        own = observable == name
        root, beyond = rms(gap[own]), size(gap[own], noise[own])
        share = (beyond / root) ** 2 if root > 0.0 else 0.0
        open_error = None
        if analysis.controls:
            open_error = float(np.sqrt(np.mean(np.maximum(variance[own] - noise[own] ** 2, 0.0))))
        relative = CROSS_CODE.get(discrepancy_of(name)) if units[name] == "m" else None
        codes = None if relative is None else relative * rms(scale[own])
        uncertainty = float(np.sqrt(np.mean(variance[own])))
        parts.append(
            Practical(name, units[name], root, beyond, share, uncertainty, open_error, codes)
        )
    return tuple(parts)


def scale_of(points: "Points", block: "Block") -> float:
    """Length of which `CROSS_CODE` is a part [m]: height of the column, for a front its farthest way."""
    experiment = next(one for one in points.experiments if one.name == block.experiment)
    geometry = experiment.settings.geometry
    if discrepancy_of(block.observable) != "front":
        return geometry.height_0  # type: ignore[return-value]
    return max(points.measured[block.start : block.stop].max() - geometry.length_0, 0.0)


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
