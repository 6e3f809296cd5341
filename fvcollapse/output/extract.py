"""Extract of a result: what a comparison with an experiment needs, in some 100 kB.

An extract is a result file without fields: `open_result` and `observe` read it. Series are thinned
to `INTERVAL`, with the last step kept; profiles and series are single precision, to `RESOLUTION`.
The rows of `steps` are summed up between the rows of the series, so that totals do not change
and `dt` is the time between two rows.
"""

import io

import numpy as np

from fvcollapse.files.hdf5 import build_image, write_dataset
from fvcollapse.output.checkpoint import write_header
from fvcollapse.output.result import FORMAT, Result, write_status
from fvcollapse.output.stored_names import PROFILES, SERIES, STEPS

INTERVAL = 0.005  # s between rows of the series
RESOLUTION = 2.0**-18  # m, 4 micrometres: trailing zeros compress
SMALL = ("v110", "v110")  # the index of a data set takes 2 kB less than in older formats
LARGEST = ("residual", "divergence")  # of merged steps; of `time` the last, of others the sum


def extract_image(result):
    """The extract of a finished result, as bytes."""

    def fill(file):
        write_header(file, FORMAT, result.case)
        file.attrs["code_version"] = result.code_version
        write_status(file, result.status, result.trust)
        rows = kept_rows(result.series["time"])
        for name, about in SERIES.items():
            kind = np.float64 if name == "time" else np.float32
            values = result.series[name][rows].astype(kind)
            write_dataset(file.require_group("series"), name, values, *about)
        for name, values in summed_steps(result.steps, rows).items():
            about = STEPS.get(name, ("SI", name.replace("_", " ")))
            write_dataset(file.require_group("steps"), name, values, *about)
        profiles = file.create_group("profiles")
        write_dataset(profiles, "time", result.profiles.time, "s", "times of the profiles")
        write_dataset(
            profiles, "x", result.profiles.x, "m", "distance along the bed from the back wall"
        )
        for name, about in PROFILES.items():
            write_dataset(profiles, name, rounded(getattr(result.profiles, name)), *about)
        file.create_group("fields")

    return build_image(fill, SMALL)


def open_image(image):
    """The extract in bytes as a `Result`."""
    return Result(io.BytesIO(image))


def kept_rows(time):
    """Indices of the retained rows: the first at or after each multiple of `INTERVAL`, the last."""
    wanted = np.arange(time[0], time[-1], INTERVAL)
    return np.unique([*np.searchsorted(time, wanted - 1.0e-9), len(time) - 1])


def summed_steps(steps, rows):
    """Steps between kept rows; step n ends at row n + 1 of the series."""
    if len(rows) < 2:
        return {name: values[:0] for name, values in steps.items()}
    reductions = {"time": lambda values: values[rows[1:] - 1]}
    reductions |= {name: lambda v: np.maximum.reduceat(v, rows[:-1]) for name in LARGEST}
    return {
        name: reductions.get(name, lambda v: np.add.reduceat(v, rows[:-1]))(values)
        for name, values in steps.items()
    }


def rounded(heights):
    """Heights in single precision, to `RESOLUTION` [m]."""
    return (np.round(heights / RESOLUTION) * RESOLUTION).astype(np.float32)
