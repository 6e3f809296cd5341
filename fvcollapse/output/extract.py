"""Extract of a run: what a comparison with an experiment needs, in some 100 kB.

An extract is a result file without fields, its series in tables (see `tables`): `open_result` and `observe` read it.
Series are thinned to `INTERVAL`, with the last step kept; profiles and series are single precision, to `RESOLUTION`.
The rows of `steps` are summed up between the rows of the series, so that totals do not change
and `dt` is the time between two rows. It is made from a result, or from the record of a run that has just ended.
"""

import io
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.files.hdf5 import build_image, write_dataset
from fvcollapse.output.checkpoint import write_header
from fvcollapse.output.record_layout import RESOLUTION
from fvcollapse.output.result import FORMAT, Profiles, Result, write_status
from fvcollapse.output.stepping import trust_of_record
from fvcollapse.output.stored_names import PROFILES, SERIES
from fvcollapse.output.tables import LAYOUT, TABLES, write_table
from fvcollapse.output.trust import COMPLETE, Trust
from fvcollapse.version import __version__

if TYPE_CHECKING:
    from fvcollapse.output.recorder import Recorder


INTERVAL = 0.005  # s between rows of the series
SMALL = ("v110", "v110")  # the index of a data set takes 2 kB less than in older formats
LARGEST = ("residual", "divergence")  # of merged steps; of `time` the last, of others the sum


class FinishedRun(NamedTuple):
    """What an extract is made of, as a `Result` has it."""

    case: Case
    code_version: str
    status: str
    trust: Trust
    series: dict
    steps: dict
    profiles: Profiles

    @classmethod
    def of(cls, recorder: "Recorder", case: Case) -> "FinishedRun":
        """Of the record of a run that has reached its end."""
        columns = recorder.columns()
        trust = trust_of_record(recorder, COMPLETE, case)
        profiles = Profiles(**columns.profiles)
        return cls(case, __version__, COMPLETE, trust, columns.series, columns.steps, profiles)


def extract_image(result: Any) -> bytes:
    """The extract of a finished `Result` or `FinishedRun`, as bytes."""

    def fill(file):
        write_header(file, FORMAT, result.case)
        file.attrs["code_version"], file.attrs[LAYOUT] = result.code_version, TABLES
        write_status(file, result.status, result.trust)
        rows = kept_rows(result.series["time"])
        series = {name: result.series[name][rows] for name in SERIES}
        group = file.create_group("series")
        write_dataset(group, "time", series.pop("time"), *SERIES["time"])
        single = {name: values.astype(np.float32) for name, values in series.items()}
        write_table(group, single, "series of a result")
        steps = summed_steps(result.steps, rows)
        double = {name: values.astype(np.float64) for name, values in steps.items()}
        write_table(file.create_group("steps"), double, "sums of the step log between two rows")
        write_profiles(file.create_group("profiles"), result.profiles)
        file.create_group("fields")

    return build_image(fill, SMALL)


def write_profiles(group: h5py.Group, profiles: Profiles) -> None:
    """Write the profiles of a result into an open group."""
    write_dataset(group, "time", profiles.time, "s", "times of the profiles")
    write_dataset(group, "x", profiles.x, "m", "distance along the bed from the back wall")
    heights = {name: rounded(getattr(profiles, name)) for name in PROFILES}
    write_table(group, heights, "heights of the pile")


def open_image(image: bytes) -> Result:
    """The extract in bytes as a `Result`."""
    return Result(io.BytesIO(image))


def kept_rows(time: np.ndarray) -> np.ndarray:
    """Indices of the retained rows: the first at or after each multiple of `INTERVAL`, the last."""
    wanted = np.arange(time[0], time[-1], INTERVAL)
    return np.unique([*np.searchsorted(time, wanted - 1.0e-9), len(time) - 1])


def summed_steps(steps: dict, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Steps between kept rows; step n ends at row n + 1 of the series."""
    if len(rows) < 2:
        return {name: values[:0] for name, values in steps.items()}
    reductions = {"time": lambda values: values[rows[1:] - 1]}
    reductions |= {name: lambda v: np.maximum.reduceat(v, rows[:-1]) for name in LARGEST}
    return {
        name: reductions.get(name, lambda v: np.add.reduceat(v, rows[:-1]))(values)
        for name, values in steps.items()
    }


def rounded(heights: np.ndarray) -> np.ndarray:
    """Heights in single precision, to `RESOLUTION` [m]."""
    return (np.round(heights / RESOLUTION) * RESOLUTION).astype(np.float32)
