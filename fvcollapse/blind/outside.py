"""Causes outside the catalogue: forces on the grains, other columns, and wrong readings.

Every cause is a dictionary of plain numbers, so that a label can hold it; the function named by its
`kind` says what it does. The same forces serve as model-form error: a bed whose friction varies
from place to place.
"""

from collections.abc import Iterable, Sequence
from math import cos, radians
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import trapezoid

from fvcollapse.blind.plain_values import Force, Outside, Reading
from fvcollapse.case.case import GRAVITY
from fvcollapse.measure.pile import front_position

if TYPE_CHECKING:
    from fvcollapse.blind.truth import View
    from fvcollapse.case.sections import Geometry

REST = 0.05  # m/s; friction of a force rises linearly up to this speed, so that rest stays rest
# of the error of a model: largest relative standard deviations of thickness and reach (two codes with the same
# equations differ by 4 % in the thickness), number of waves, and the time after which it is there [s]
HEIGHT_ERROR, REACH_ERROR, ERROR_WAVES, ONSET = 0.06, 0.02, 8, 0.1
BRAKE_MAX = 0.5  # largest part of the velocity that a force takes in one step


# -- forces: rate [1/s] at which a velocity is damped, negative where it is driven ---------------------


def linear_drag(force: Force, x: np.ndarray, speed: np.ndarray, gravity: float) -> np.ndarray:
    """Damping in proportion to the velocity, at `rate` [1/s]."""
    return np.full_like(speed, force["rate"])


def quadratic_drag(force: Force, x: np.ndarray, speed: np.ndarray, gravity: float) -> np.ndarray:
    """Damping over the `length` [m], as that of a surrounding fluid."""
    return speed / force["length"]


def strip(force: Force, x: np.ndarray, speed: np.ndarray, gravity: float) -> np.ndarray:
    """Friction higher (or lower) by `friction` between `first` and `last` [m] along the bed."""
    inside = (x >= force["first"]) & (x <= force["last"])
    return np.where(inside, force["friction"], 0.0) * gravity / np.hypot(speed, REST)


def uneven_friction(force: Force, x: np.ndarray, speed: np.ndarray, gravity: float) -> np.ndarray:
    """Friction that varies along the bed: a sum of cosines of standard deviation `friction`."""
    waves, phases = np.asarray(force["waves"]), np.asarray(force["phases"])
    pattern = np.cos(np.multiply.outer(x, waves) + phases).sum(axis=-1) * (2.0 / len(waves)) ** 0.5
    return force["friction"] * pattern * gravity / np.hypot(speed, REST)


FORCES = {
    "linear_drag": linear_drag,
    "quadratic_drag": quadratic_drag,
    "strip": strip,
    "uneven_friction": uneven_friction,
}


def brake(
    forces: Sequence[Force],
    u: np.ndarray,
    w: np.ndarray,
    dt: float,
    dx: float,
    slope_angle_deg: float,
) -> None:
    """Let the forces act on a staggered velocity for a step; all depths alike.

    Parameters
    ----------
    forces : sequence of dict
    u, w : (nx + 1, nz), (nx, nz + 1) arrays
        Changed in place [m/s].
    dt, dx, slope_angle_deg : float
        Step [s], cell size along the bed [m], inclination [deg].
    """
    gravity = GRAVITY * cos(radians(slope_angle_deg))
    speed_u, speed_w = np.hypot(u, w_on_xfaces(w)), np.hypot(w, u_on_zfaces(u))
    x_u = dx * np.arange(len(u))
    x_w = dx * (np.arange(len(w)) + 0.5)
    for values, speed, x in ((u, speed_u, x_u), (w, speed_w, x_w)):
        place = np.broadcast_to(x[:, None], speed.shape)
        rate = sum(FORCES[force["kind"]](force, place, speed, gravity) for force in forces)
        values *= 1.0 - np.clip(dt * rate, -BRAKE_MAX, BRAKE_MAX)


def w_on_xfaces(w: np.ndarray) -> np.ndarray:
    """Mean of the four w around each x-face; at the ends of the two there."""
    row = 0.5 * (w[:, :-1] + w[:, 1:])
    return np.vstack([row[:1], 0.5 * (row[:-1] + row[1:]), row[-1:]])


def u_on_zfaces(u: np.ndarray) -> np.ndarray:
    """Mean of the four u around each z-face; at bed and top of the two there."""
    column = 0.5 * (u[:-1] + u[1:])
    inner = 0.5 * (column[:, :-1] + column[:, 1:])
    return np.hstack([column[:, :1], inner, column[:, -1:]])


# -- wrong readings ----------------------------------------------------------------------------------------


def magnification(reading: Reading, threshold: float, view: "View") -> "View":
    """Lengths along the bed are read too long by the part `error`."""
    factor = 1.0 + reading["error"]
    return view._replace(x=view.x * factor, front=view.front * [1.0, factor])


def clock(reading: Reading, threshold: float, view: "View") -> "View":
    """Times are read too long by the part `error`."""
    factor = 1.0 + reading["error"]
    return view._replace(
        time=view.time * factor,
        front=view.front * [factor, 1.0],
        volume=view.volume * [factor, 1.0],
    )


def grain_loss(reading: Reading, threshold: float, view: "View") -> "View":
    """Grains trickle out under the lateral walls: the part `lost` is gone at the end, evenly over time."""
    left = 1.0 - reading["lost"] * view.time / view.time[-1]
    thickness = view.thickness * left[:, None]
    before = np.array([front_position(view.x, h, threshold) for h in view.thickness])
    after = np.array([front_position(view.x, h, threshold) for h in thickness])
    front, volume = view.front.copy(), view.volume.copy()
    front[:, 1] += np.interp(front[:, 0], view.time, after - before)
    volume[:, 1] = (1.0 + volume[:, 1]) * np.interp(volume[:, 0], view.time, left) - 1.0
    return view._replace(
        thickness=thickness,
        static_height=view.static_height * left[:, None],
        front=front,
        volume=volume,
    )


def fallen_grains(reading: Reading, threshold: float, view: "View") -> "View":
    """Grains that fell off the end of the channel are missing in the volume that is seen."""
    area = trapezoid(view.thickness, view.x, axis=1)
    most = np.maximum.accumulate(area)  # at t = 0 the nodes miss a part of the upright face
    return view._replace(volume=np.column_stack([view.time, area / most - 1.0]))


def smooth_error(reading: Reading, threshold: float, view: "View") -> "View":
    """Another code: the pile reaches farther or less far, and is thicker here and thinner there, by a little.

    At t = 0 the column is as it was set up, and every profile keeps its area.
    """
    waves = np.asarray(reading["waves"])  # (n, 2): 1/m and 1/s
    phases, size = np.asarray(reading["phases"]), (2.0 / len(waves)) ** 0.5

    def pattern(x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """A smooth function of unit variance that vanishes at t = 0."""
        angle = np.multiply.outer(x, waves[:, 0]) + np.multiply.outer(time, waves[:, 1]) + phases
        return size * np.cos(angle).sum(axis=-1) * (1.0 - np.exp(-time / ONSET))

    def stretch(time: np.ndarray) -> np.ndarray:
        """Factor on the lengths along the bed."""
        return 1.0 + reading["reach"] * pattern(np.zeros_like(time), time)

    grid_t, grid_x = np.meshgrid(view.time, view.x, indexing="ij")
    place = grid_x / stretch(view.time)[:, None]
    factor = np.maximum(1.0 + reading["height"] * pattern(grid_x, grid_t), 0.0)
    moved = [
        np.array([np.interp(at, view.x, row) for at, row in zip(place, rows, strict=True)]) * factor
        for rows in (view.thickness, view.static_height)
    ]
    before, after = (trapezoid(rows, view.x, axis=1) for rows in (view.thickness, moved[0]))
    kept = (before / np.maximum(after, 1.0e-300))[:, None]
    front = np.column_stack([view.front[:, 0], view.front[:, 1] * stretch(view.front[:, 0])])
    return view._replace(front=front, thickness=moved[0] * kept, static_height=moved[1] * kept)


READINGS = {
    "smooth_error": smooth_error,
    "magnification": magnification,
    "clock": clock,
    "grain_loss": grain_loss,
    "fallen_grains": fallen_grains,
}


def read_wrongly(readings: Iterable[Reading], threshold: float, view: "View") -> "View":
    """What is seen of a collapse (`truth.View`) after the wrong readings."""
    for reading in readings:
        view = READINGS[reading["kind"]](reading, threshold, view)
    return view


def draw_smooth_error(
    rng: np.random.Generator, size: float, lengths: tuple[float, float]
) -> Reading:
    """A `smooth_error` of a size in (0, 1) that varies over some length [m] and time [s]."""
    waves = rng.standard_normal((ERROR_WAVES, 2)) / lengths
    return {
        "kind": "smooth_error",
        "height": HEIGHT_ERROR * float(size),
        "reach": REACH_ERROR * float(size),
        "waves": waves.tolist(),
        "phases": rng.uniform(0.0, 2.0 * np.pi, ERROR_WAVES).tolist(),
    }


# -- the kinds of unknown ----------------------------------------------------------------------------------


def draw_linear_drag(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """Some medium, or a brush of fibres, slows all grains."""
    return {"forces": [{"kind": "linear_drag", "rate": loguniform(rng, 0.3, 2.0)}]}


def draw_quadratic_drag(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """A fluid between the grains slows the fast ones."""
    return {"forces": [{"kind": "quadratic_drag", "length": loguniform(rng, 0.3, 2.0)}]}


def draw_strip(rng: np.random.Generator, geometry: "Geometry", low: float, high: float) -> Outside:
    """A strip of the bed with another friction."""
    first = geometry.length_0 + rng.uniform(0.02, 0.15)
    last = first + rng.uniform(0.10, 0.30)
    friction = rng.uniform(low, high)
    return {"forces": [{"kind": "strip", "friction": friction, "first": first, "last": last}]}


def draw_rough_strip(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """Sandpaper on a part of the bed."""
    return draw_strip(rng, geometry, 0.05, 0.30)


def draw_slippery_strip(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """A worn part of the bed."""
    return draw_strip(rng, geometry, -0.25, -0.05)


def draw_sloping_surface(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """The column was not levelled: higher at one end, the same volume."""
    rise = rng.choice([-1.0, 1.0]) * rng.uniform(0.10, 0.30) * geometry.height_0
    low, high, length = geometry.height_0 - rise, geometry.height_0 + rise, geometry.length_0
    return {"polygon": [[0.0, 0.0], [length, 0.0], [length, high], [0.0, low]]}


def draw_slumped_column(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """The corner at the gate had slumped before the release, the same volume."""
    length = geometry.length_0
    start, drop = rng.uniform(0.3, 0.6) * length, rng.uniform(0.25, 0.6) * geometry.height_0
    top = geometry.height_0 + 0.5 * drop * (length - start) / length
    return {"polygon": [[0.0, 0.0], [length, 0.0], [length, top - drop], [start, top], [0.0, top]]}


def draw_short_channel(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """The channel ends: what goes further falls off."""
    end = geometry.length_0 + rng.uniform(0.12, 0.30)
    return {"channel_end": end, "readings": [{"kind": "fallen_grains"}]}


def draw_magnification(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """The scale of the camera was taken elsewhere."""
    return {"readings": [{"kind": "magnification", "error": signed(rng, 0.03, 0.08)}]}


def draw_clock(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """The frame rate was not what the camera says."""
    return {"readings": [{"kind": "clock", "error": signed(rng, 0.04, 0.12)}]}


def draw_grain_loss(rng: np.random.Generator, geometry: "Geometry") -> Outside:
    """Grains are lost under the lateral walls."""
    return {"readings": [{"kind": "grain_loss", "lost": rng.uniform(0.04, 0.15)}]}


# kind: function (rng, geometry) -> {"forces", "readings", "polygon", "channel_end"}, those that it needs
UNKNOWNS = {
    "linear_drag": draw_linear_drag,
    "rough_strip": draw_rough_strip,
    "sloping_surface": draw_sloping_surface,
    "clock": draw_clock,
    "grain_loss": draw_grain_loss,
    "quadratic_drag": draw_quadratic_drag,
    "slippery_strip": draw_slippery_strip,
    "slumped_column": draw_slumped_column,
    "magnification": draw_magnification,
    "short_channel": draw_short_channel,
}


def loguniform(rng: np.random.Generator, low: float, high: float) -> float:
    """A number between two limits, uniform in its logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def signed(rng: np.random.Generator, low: float, high: float) -> float:
    """A number of either sign whose size is between two limits."""
    return float(rng.choice([-1.0, 1.0]) * rng.uniform(low, high))
