"""Curves of another code as a laboratory would film them: experiment folders in which nothing is hidden.

The other code solves the same equations with the same constants (mu(I), no lateral walls, gate removed at once, free
slip at the back wall). Its thickness is stored at a few moments only, so that these are the frames of the film; an
error of the clock moves the time that is written beside a frame, and nothing is interpolated in time. All other
errors are those of `fvcollapse.blind.measurement`.
"""

import zlib
from typing import NamedTuple

import numpy as np

from fvcollapse.blind.measurement import (
    BARE,
    FRAME,
    LEAST_THICKNESS,
    SPACING,
    Errors,
    curve_csv,
    drifting_errors,
    frames,
    jumping_errors,
    kept_frames,
    mixed,
    mixed_series,
)
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.experiment import load_experiment

PREFIX = "basilisk"  # folders of the data
MOVING = 0.05  # m/s; slower fronts are read better
# standard deviations of the measurement: what `fvcollapse.measure.uncertainty` takes where none is stated
ERRORS = Errors(
    thickness=0.002,
    front=0.010,
    relative_volume=0.01,
    interface=0.003,
    scale=0.007,
    offset=0.001,
    time=0.005,
)
SETTINGS = """title = "volume of fluid, {cells} cells of {cell_size:g} mm in the height, {slope:g} deg, {bed}"
source = "another code that solves the same equations; nothing is hidden; noise {noise}"

[geometry]
slope_angle_deg = {slope}
height_0 = 0.14
length_0 = 0.20

[material]
grain_diameter = 0.0007
density_grain = 2500.0
density_bulk = 1550.0
mu_1 = 0.48
mu_2 = 0.73
I_0 = 0.279
mu_back_wall = 0.0{friction}

[uncertainty]
thickness = {errors.thickness}
front = {errors.front}
relative_volume = {errors.relative_volume}
time = {errors.time}
height_0 = {scale}
length_0 = {errors.offset}{friction_sd}

[front]
thickness = 0.005
"""


class Peer(NamedTuple):
    """One collapse of the other code.

    Attributes
    ----------
    folder : str
        Of its curves in the data.
    slope : float
        [deg].
    cell_size : float
        [m].
    end, reach : float
        Last frame [s] and last place on the film [m].
    mu_bed : float or None
        Friction of the bed; None: no slip.
    """

    folder: str
    slope: float
    cell_size: float
    end: float
    reach: float
    mu_bed: float | None = None


class Seen(NamedTuple):
    """The curves of a `Peer` without noise; SI units, X from the back wall, t = 0 at the release.

    `front` and `volume` (n, 2) are time and value; `profiles` is {time: (x, h)}.
    """

    front: np.ndarray
    volume: np.ndarray
    profiles: dict


# The Coulomb bed of that code gave 80 to 85 % of its 0.48 of the pressure (at 0 degrees, over the moving grains): the
# friction that is stated is the one that acted. At 22 degrees nobody measured what acted: this bed is left out there,
# as are the runs with lateral walls, whose friction that code applies in a way that no exact solution confirms.
SLIPPERY = 0.396  # 0.825 of 0.48
SLIPPERY_SD = 0.012
PEERS = {
    "flat_3mm": Peer("a0_l6_e4_ns", 0.0, 0.003125, 0.96, 0.75),
    "flat_6mm": Peer("a0_l5_e4_ns", 0.0, 0.00625, 0.96, 0.75),
    "flat_1.5mm": Peer("a0_l7_e4_ns", 0.0, 0.0015625, 0.48, 0.55),
    "flat_3mm_thin": Peer("a0_l6_e2_ns", 0.0, 0.003125, 0.96, 0.75),
    "flat_3mm_slippery": Peer("a0_l6_e4_mb", 0.0, 0.003125, 0.96, 0.75, SLIPPERY),
    "flat_6mm_slippery": Peer("a0_l5_e4_mb", 0.0, 0.00625, 0.96, 0.75, SLIPPERY),
    "steep_3mm": Peer("a22_l6_e4_ns", 22.0, 0.003125, 1.96, 1.85),
    "steep_6mm": Peer("a22_l5_e4_ns", 22.0, 0.00625, 1.96, 1.85),
}


def seen_of(data, peer):
    """The `Seen` of a collapse in a folder of data.

    Raises
    ------
    InputError
        No such collapse.
    """
    folder = data / f"{PREFIX}_{peer.folder}"
    if not (folder / "front.csv").is_file():
        raise InputError(folder, "front.csv", "no such file", "the curves of the other code")
    rows = table(folder / "front.csv")
    rows = rows[rows["t_s"] <= peer.end + 0.5 * FRAME]
    profiles = {}
    for path in folder.glob("profile_t*.csv"):
        time = float(path.stem.removeprefix("profile_t"))
        if time <= peer.end + 0.5 * FRAME:
            curve = table(path)
            profiles[time] = curve["x_m"], np.maximum(curve["h_m"], 0.0)
    return Seen(
        np.column_stack([rows["t_s"], rows["x_cont5mm_m"]]),
        np.column_stack([rows["t_s"], rows["volume_rel_err"]]),
        dict(sorted(profiles.items())),
    )


def table(path):
    """A numeric table of the data, by column name."""
    return np.genfromtxt(path, delimiter=",", names=True)


def filmed(seen, peer, rng, errors=ERRORS):
    """The CSV texts of a film, by file name.

    Parameters
    ----------
    seen : Seen
    peer : Peer
    rng : numpy.random.Generator
    errors : Errors
        All zero: the curves as they are.
    """
    ahead, offset = errors.time * rng.standard_normal(), errors.offset * rng.standard_normal()
    scale = 1.0 + errors.scale * rng.standard_normal()
    time = kept_frames(frames(peer.end)[1:], rng)  # the first frame would show a clock before zero
    front = np.interp(time, *seen.front.T) + offset
    moving = np.gradient(front, time) > MOVING
    front += errors.front * np.where(moving, 1.0, 0.5) * jumping_errors(len(time), rng)
    volume = np.interp(time, *seen.volume.T)
    volume += errors.relative_volume * mixed_series(len(time), rng)
    curves = {
        "front": np.column_stack([time + ahead, front]),
        "profiles": film_of_profiles(seen, peer.reach, (ahead, offset, scale), errors, rng),
        "volume": np.column_stack([time + ahead, volume]),
    }
    return {f"{name}.csv": curve_csv(name, rows) for name, rows in curves.items()}


def film_of_profiles(seen, reach, shifts, errors, rng):
    """Rows (n, 3) of time, place and thickness.

    Parameters
    ----------
    seen : Seen
    reach : float
        Last place on the film [m].
    shifts : (float, float, float)
        Errors of the whole run: of the clock [s], of the origin of X [m], factor of the heights.
    errors : Errors
    rng : numpy.random.Generator
    """
    ahead, offset, scale = shifts
    x = SPACING * (np.arange(round(reach / SPACING)) + 0.5)
    shared = drifting_errors(int(max(seen.profiles) / FRAME) + 1, x, rng)
    rows = []
    for time, (place, thickness) in seen.profiles.items():
        h = np.interp(x - offset, place, thickness)
        error = mixed(shared[int(time / FRAME)], rng)
        bare = np.where(h > LEAST_THICKNESS, 1.0, BARE)
        measured = scale * h + errors.thickness * bare * error
        rows.append(np.column_stack([np.full(len(x), time + ahead), x, measured]))
    return np.concatenate(rows)


def write_experiment(folder, data, peer, seed, errors=ERRORS):
    """The `Experiment` of a collapse, filmed into a folder.

    Parameters
    ----------
    folder, data : Path
    peer : Peer
    seed : int
        Of the noise.
    errors : Errors
        Also what is stated; all zero: the curves as they are, with the errors of a laboratory stated.
    """
    rng = np.random.default_rng([seed, zlib.crc32(peer.folder.encode())])
    texts = filmed(seen_of(data, peer), peer, rng, errors)
    folder.mkdir(parents=True, exist_ok=True)
    write_atomic(
        folder / "experiment.toml",
        settings_text(peer, seed, errors if any(errors) else ERRORS).encode(),
    )
    for name, text in texts.items():
        write_atomic(folder / name, text.encode())
    return load_experiment(folder)


def settings_text(peer, seed, stated):
    """`experiment.toml` of a collapse; `stated` are its errors."""
    slips = peer.mu_bed is not None
    return SETTINGS.format(
        cells=round(0.14 / peer.cell_size),
        cell_size=1000.0 * peer.cell_size,
        slope=peer.slope,
        bed="slippery bed" if slips else "no slip",
        noise=seed,
        friction=f"\nmu_bed = {peer.mu_bed:.3f}" if slips else "",
        friction_sd=f"\nmu_bed = {SLIPPERY_SD}" if slips else "",
        errors=stated,
        scale=round(0.14 * stated.scale, 5),
    )
