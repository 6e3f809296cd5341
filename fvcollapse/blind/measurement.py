"""A laboratory that films the hidden truth: same frames and places for all, errors as real ones are.

Errors of a whole run (scale of the picture, origin of X, clock), errors that neighbours share (lens,
light, grains stuck to the glass), outliers, pixels, and frames that are missing. What `[uncertainty]` of
the experiment states is the standard deviation of each.
"""

from math import sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fvcollapse.measure.align import on_points
from fvcollapse.measure.curves import csv_text
from fvcollapse.measure.quantities import CURVES

if TYPE_CHECKING:
    from fvcollapse.blind.truth import View

FRAME = 0.04  # s between frames
SPACING = 0.01  # m between places
MISSING = 0.05  # part of the frames that is missing
PIXEL = {"front": 0.001, "profiles": 0.0005, "volume": 0.0005, "interface": 0.0005}
DECIMALS = {"t_s": 3, "x_m": 3, "x_front_m": 4, "h_m": 5, "relative_volume_change": 5}
LEAST_THICKNESS = 0.004  # m; the interface is read where the pile is thicker
TAIL = (
    4.0  # degrees of freedom of Student's t: one reading in a hundred is 4 standard deviations off
)
SHARED = 0.7  # part of the variance of a thickness that neighbours share
SHARED_LENGTH = 0.04  # m over which they do
MEMORY = 0.6  # correlation of what is shared from one frame to the next
BARE = 0.3  # errors on the bare bed, relative to those on the grains


class Errors(NamedTuple):
    """Standard deviations of the measurement of one run; SI units, `scale` of all heights."""

    thickness: float
    front: float
    relative_volume: float
    interface: float
    scale: float
    offset: float
    time: float


def frames(end: float) -> np.ndarray:
    """Times of all frames [s]."""
    return FRAME * np.arange(int(round(end / FRAME)) + 1)


def film(
    view: "View",
    end: float,
    reach: float,
    errors: Errors,
    rng: np.random.Generator,
    common: dict[str, float] | None = None,
) -> dict[str, str]:
    """The CSV texts of one run, by file name.

    Parameters
    ----------
    view : truth.View
    end, reach : float
        Last frame [s] and last place [m]; the same for every run of a set-up.
    errors : Errors
    rng : numpy.random.Generator
    common : dict, optional
        Errors in standard deviations of `time`, `offset` and `scale` that all runs share; others are drawn.
    """
    drawn = {name: rng.standard_normal() for name in ("time", "offset", "scale")} | (common or {})
    ahead, offset = errors.time * drawn["time"], errors.offset * drawn["offset"]
    scale = 1.0 + errors.scale * drawn["scale"]
    time = kept_frames(frames(end), rng)
    x = SPACING * (np.arange(int(round(reach / SPACING))) + 0.5)
    at = np.maximum(time - ahead, 0.0)
    grid_t, grid_x = (part.ravel() for part in np.meshgrid(at, x - offset, indexing="ij"))
    seen = [
        on_points(view.time, view.x, values, grid_t, np.maximum(grid_x, 0.0)).reshape(len(at), -1)
        for values in (view.thickness, view.static_height)
    ]
    bare = np.where(seen[0] > LEAST_THICKNESS, 1.0, BARE)
    shared = drifting_errors(len(time), x, rng)
    thickness = scale * seen[0] + errors.thickness * bare * mixed(shared, rng)
    interface = scale * seen[1] + errors.interface * mixed(shared, rng)
    interface = np.minimum(np.maximum(interface, 0.0), np.maximum(thickness, 0.0))
    front = np.interp(at, *view.front.T) + offset
    moving = np.gradient(front, time) > 0.05  # m/s
    front += errors.front * np.where(moving, 1.0, 0.5) * jumping_errors(len(time), rng)
    volume = np.interp(at, *view.volume.T)
    volume += errors.relative_volume * (time > 0.0) * mixed_series(len(time), rng)
    rows = np.column_stack([np.repeat(time, len(x)), np.tile(x, len(time))])
    in_view = np.maximum.accumulate(front) <= reach
    covered = (seen[0] > LEAST_THICKNESS).ravel() & (rows[:, 0] > 0.0)
    curves = {
        "front": np.column_stack([time, front])[in_view],
        "profiles": np.column_stack([rows, thickness.ravel()]),
        "volume": np.column_stack([time, volume])[in_view],
        "interface": np.column_stack([rows, interface.ravel()])[covered],
    }
    return {f"{name}.csv": curve_csv(name, table) for name, table in curves.items()}


def kept_frames(time: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The frames that are not missing; the first and the last never are."""
    kept = rng.random(len(time)) >= MISSING
    kept[[0, -1]] = True
    return time[kept]


def heavy_tailed(shape: int | tuple[int, ...], rng: np.random.Generator) -> np.ndarray:
    """Errors of unit variance with outliers."""
    return rng.standard_t(TAIL, shape) * sqrt((TAIL - 2.0) / TAIL)


def drifting_errors(count: int, x: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Errors (count, nx) of unit variance, smooth along x, that fade from frame to frame."""
    distance = (x[:, None] - x) / SHARED_LENGTH
    factor = np.linalg.cholesky(np.exp(-0.5 * distance**2) + 1.0e-6 * np.eye(len(x)))
    errors = np.empty((count, len(x)))
    for row in range(count):
        fresh = factor @ rng.standard_normal(len(x))
        errors[row] = fresh if row == 0 else MEMORY * errors[row - 1] + fading() * fresh
    return errors


def fading() -> float:
    """Weight of what is new in a frame."""
    return sqrt(1.0 - MEMORY**2)


def mixed(shared: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Errors of unit variance of which a part is shared."""
    return sqrt(SHARED) * shared + sqrt(1.0 - SHARED) * heavy_tailed(shared.shape, rng)


def mixed_series(count: int, rng: np.random.Generator) -> np.ndarray:
    """Errors (count,) of unit variance, half of it a drift."""
    drift = rng.standard_normal() * np.linspace(0.0, 1.0, count)
    return sqrt(0.5) * (drift + heavy_tailed(count, rng))


def jumping_errors(count: int, rng: np.random.Generator) -> np.ndarray:
    """Errors (count,) of a front: grains jump ahead of it, and some are seen in several frames."""
    errors = np.empty(count)
    for row in range(count):
        fresh = (rng.standard_gamma(2.0) - 2.0) / sqrt(2.0)  # skewed to the front, unit variance
        errors[row] = fresh if row == 0 else MEMORY * errors[row - 1] + fading() * fresh
    return errors


def curve_csv(name: str, table: np.ndarray) -> str:
    """CSV text of a curve in whole pixels, with so many decimals that rounding leaves no trace."""
    columns = CURVES[name].columns
    table = table.copy()
    table[:, -1] = PIXEL[name] * np.round(table[:, -1] / PIXEL[name])
    table[:, -1] += 0.0  # no -0
    places = [DECIMALS.get(column, 5) for column in columns]
    rows = [[f"{v:.{n}f}" for v, n in zip(row, places, strict=True)] for row in table]
    return csv_text(columns, rows)
