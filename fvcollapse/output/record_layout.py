"""The form of the record in a file: which data sets, of what type and shape, and what their values can be.

The checks hold for everything that a run can leave, also for one that went wrong. They do not judge a
result: a volume that has doubled is a bad result and a sound file, a volume below nothing is neither.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from fvcollapse.output.field_layout import (
    LONGEST,
    SAME,
    check_field_forms,
    check_paraview,
    read_field,
)
from fvcollapse.output.stored_names import PROFILES, SERIES, SINCE_RELEASED, STEPS
from fvcollapse.output.stored_numbers import (
    ANY,
    LARGEST,
    NUMBERS,
    POSITIVE,
    group_of,
    numbers_of,
    refuse,
    refuse_fall,
)

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


FORMAT_VERSION = 1
RESOLUTION = 2.0**-18  # m, 4 micrometres, of the heights of an extract: trailing zeros compress
FASTEST = 3.0e8  # m/s, the speed of light
FRACTION = (0.0, 1.0 + SAME)
LENGTH = (0.0, LONGEST)
SERIES_RANGE = {
    "time": POSITIVE,
    "front_position": LENGTH,
    "front_velocity": (-FASTEST, FASTEST),
    "runout": LENGTH,
    "runout_1mm": LENGTH,
    "runout_10mm": LENGTH,
    "x_99": LENGTH,
    "detached_volume": FRACTION,
    "relative_volume": (-1.0 - SAME, LARGEST),
    "volume_correction": POSITIVE,
    "kinetic_energy": POSITIVE,
    "max_speed": (0.0, FASTEST),
    "ill_posed_fraction": FRACTION,
    "negative_pressure_cells": POSITIVE,
}
NEVER_FALLING = ("runout", "runout_1mm", "runout_10mm")
STEPS_RANGE = dict.fromkeys(("time", "dt", "sweeps", "linear_iterations", "wall_time"), POSITIVE)


class Record(NamedTuple):
    """What a file holds of a run: {name: array} of /series, /steps and /profiles."""

    series: dict
    steps: dict
    profiles: dict


def read_record(file: Any, case: "Case", complete_fields: bool = False) -> Record:
    """Read /series, /steps and /profiles, and check them and the forms of /fields.

    Parameters
    ----------
    file : h5py.File
        A result, an extract or a checkpoint, see `files.hdf5.reading`.
    case : Case
        The one in the file.
    complete_fields : bool
        Check the values of the fields, and what ParaView needs beside them, as well.

    Returns
    -------
    Record

    Raises
    ------
    InputError
    """
    for name in ("series", "steps", "profiles", "fields"):
        group_of(file, name)
    series = read_series(file, case)
    record = Record(series, read_steps(file, series["time"]), read_profiles(file, case))
    check_field_forms(file, series["time"][-1])
    if complete_fields:
        for index in range(len(file["fields"])):
            read_field(file, index)
            check_paraview(file, index)
    return record


def read_series(file: Any, case: "Case") -> dict[str, np.ndarray]:
    """Read /series; one that came later may be absent and is zero then."""
    time = numbers_of(file, "series/time", (None,), POSITIVE, kinds="f")
    if not time.size:
        refuse(file, "series/time", "no values", "one value or more")
    refuse_fall(file, "series/time", time, strictly=True)
    end = case.time.end
    if time[-1] > end * (1.0 + SAME) + SAME:
        refuse(file, "series/time", f"{time[-1]:g}", f"at most time.end = {end:g} of its case")
    ranges = SERIES_RANGE | {"max_thickness": (lowest(case), LONGEST)}
    series, stored = {"time": time}, set(file["series"])
    for name in SERIES:
        if name in SINCE_RELEASED and name not in stored:
            series[name] = np.zeros(len(time))
        elif name != "time":
            path = f"series/{name}"
            series[name] = numbers_of(file, path, time.shape, ranges.get(name, ANY))
            if name in NEVER_FALLING:
                refuse_fall(file, path, series[name])
    return series


def read_steps(file: Any, time: np.ndarray) -> dict[str, np.ndarray]:
    """Read /steps, one row less than the series, and every further data set in it."""
    shape, kinds = (len(time) - 1,), NUMBERS + "b"
    steps = {
        name: numbers_of(file, f"steps/{name}", shape, STEPS_RANGE.get(name, ANY), kinds)
        for name in dict.fromkeys([*STEPS, *file["steps"]])
    }
    refuse_fall(file, "steps/time", steps["time"])
    return steps


def read_profiles(file: Any, case: "Case") -> dict[str, np.ndarray]:
    """Read /profiles."""
    time = numbers_of(file, "profiles/time", (None,), POSITIVE)
    x = numbers_of(file, "profiles/x", (None,), LENGTH)
    for path, values, least in (("profiles/time", time, 1), ("profiles/x", x, 2)):
        if len(values) < least:
            refuse(file, path, f"{len(values)} values", f"{least} or more")
        refuse_fall(file, path, values, strictly=True)
    shape, limits = (len(time), len(x)), (lowest(case), LONGEST)
    heights = {
        name: numbers_of(file, f"profiles/{name}", shape, limits, kinds="f") for name in PROFILES
    }
    excess = heights["static_height"] - heights["thickness"]
    if excess.max() > SAME * (1.0 + heights["thickness"].max()) + 1.0e-5:
        found = f"{excess.max():g} m above the surface"
        refuse(file, "profiles/static_height", found, "at most the thickness")
    return {"time": time, "x": x} | heights


def lowest(case: "Case") -> float:
    """Least height of a surface [m]: an erodible layer may be gone; an extract rounds it."""
    from fvcollapse.step.erodible_bed import layer_thickness  # loads the compiler

    return -layer_thickness(case) * (1.0 + SAME) - SAME - 0.5 * RESOLUTION


def check_header(file: h5py.File, complete: bool = False) -> None:
    """Check the version of the format, and whether there is a truth value `complete` if there must be.

    Raises
    ------
    InputError
    """
    version = np.asarray(file.attrs.get("format_version", np.nan))
    if version.shape != () or version.dtype.kind not in "iu" or not 1 <= version <= FORMAT_VERSION:
        refuse(file, "format_version", "another version", f"1 to {FORMAT_VERSION}")
    if complete and not isinstance(file.attrs.get("complete"), bool | np.bool_):
        refuse(file, "complete", "no truth value", "true or false")
