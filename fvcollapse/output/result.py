"""A result, read only: series, profiles, fields, and its summary."""

import io
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from fvcollapse.case.case import case_from_text
from fvcollapse.case.words import set_up_words
from fvcollapse.draw.html import html_table
from fvcollapse.files.hdf5 import reading, text_attribute
from fvcollapse.measure.series_readings import LOSSES, WORKS, arrest_time, peak_front_velocity
from fvcollapse.output.field_layout import read_field
from fvcollapse.output.labels import tree_of
from fvcollapse.output.record_layout import check_header, read_record
from fvcollapse.output.stored_names import SERIES
from fvcollapse.output.summary import summary_rows
from fvcollapse.output.tables import tabled
from fvcollapse.output.trust import COMPLETE, INTERRUPTED, Trust, trust_of

if TYPE_CHECKING:
    import xarray

    from fvcollapse.draw.drawing import Picture

FORMAT = "fvcollapse-result"


class Profiles(NamedTuple):
    """Profiles over the nodes x (nx,) at the times (m,); heights (m, nx); all in m and s."""

    time: np.ndarray
    x: np.ndarray
    thickness: np.ndarray
    static_height: np.ndarray


# of the summary -> series: the runouts are the farthest fronts, the final front is that of the deposit
LAST = {
    "runout_10mm": "runout_10mm",
    "runout": "runout",
    "final_front": "front_position",
    "runout_1mm": "runout_1mm",
    "x_99": "x_99",
}


class Result:
    """Read-only view of `result.h5`.

    Attributes
    ----------
    series, steps : dict of (n,) arrays
        Named as in the file; each series is an attribute as well (`result.runout`).
    profiles : Profiles
    case : Case
    complete : bool
        False while the run goes on, or after it was interrupted or failed.
    ended_at_rest : bool
        True if it is complete before the end of its case, since the pile rests (`time.stop_at_rest`).
    status : str
        "complete", "running", "interrupted", "stopped: why" (a stated limit) or "failed: why".
    trust : Trust
        How far the result is to be trusted, with the reasons.
    field_times : (n_fields,) array
    path : Path or None
        None for a run in memory.
    """

    def __init__(self, source: Any) -> None:
        self._source = source
        self.path = None if isinstance(source, io.BytesIO) else Path(source)
        with reading(source, FORMAT) as file:
            check_header(file, complete=True)
            self.complete = bool(file.attrs["complete"])
            self.status = read_status(file, self.complete)
            self.code_version = text_attribute(file, "code_version")
            self.case_text = text_attribute(file, "case")
            self.case = case_from_text(self.case_text, self.path or "result")
            record = read_record(tabled(file), self.case)
            self.series, self.steps = record.series, record.steps
            self.profiles = Profiles(**record.profiles)
            self.field_times = read_field_times(file)
            trust = read_trust(file)
        capped, count = int(self.steps["capped"].sum()), len(self.steps["capped"])
        volume, corrected = self.series["relative_volume"], self.series["volume_correction"][-1]
        self.trust = trust or trust_of(self.status, volume, corrected, capped, count, self.case)

    def __getattr__(self, name: str) -> np.ndarray:
        if name in SERIES:
            return self.series[name]
        raise AttributeError(f"a result has no {name}")

    @property
    def ended_at_rest(self) -> bool:
        """See the attributes."""
        from fvcollapse.output.recorder import SAME_TIME  # loads the compiler

        early = self.series["time"][-1] < self.case.time.end - SAME_TIME
        return self.complete and self.case.time.stop_at_rest and bool(early)

    def field(self, index: int) -> dict[str, Any]:
        """Fields of one stored time (−1: the last): dict of arrays, and floats time, dx, dz."""
        index = range(len(self.field_times))[index]
        with reading(self._source, FORMAT, f"fields/{index}") as file:
            return read_field(file, index)

    def summary(self) -> dict[str, Any]:
        """The numbers of the summary table, SI units; `arrest_time` is None when not at rest."""
        series, steps = self.series, self.steps
        peak, peak_time = peak_front_velocity(series["time"], series["front_velocity"])
        return {
            "complete": self.complete,
            "ended_at_rest": self.ended_at_rest,
            "status": self.status,
            "trust": self.trust.verdict,
            "trust_reasons": "; ".join(self.trust.reasons),
            "time": float(series["time"][-1]),
            **{name: float(series[source][-1]) for name, source in LAST.items()},
            "final_thickness": float(series["max_thickness"][-1]),
            "max_thickness": float(series["max_thickness"].max()),
            "peak_front_velocity": peak,
            "peak_front_velocity_time": peak_time,
            "arrest_time": arrest_time(series["time"], series["max_speed"]),
            "final_max_speed": float(series["max_speed"][-1]),
            "volume_error_max": float(np.abs(series["relative_volume"]).max()),
            "volume_correction": float(series["volume_correction"][-1]),
            **{name: float(series[name][-1]) for name in LOSSES},
            "numerical_loss": float(series["numerical_loss"][-1]),
            "dissipation": float(sum(series[name][-1] for name in WORKS)),
            "detached_volume_max": float(series["detached_volume"].max()),
            "negative_pressure_cells_max": int(series["negative_pressure_cells"].max()),
            "steps": len(steps["dt"]),
            "sweeps": int(steps["sweeps"].sum()),
            "capped_steps": int(steps["capped"].sum()),
            "residual_max": float(steps["residual"].max(initial=0.0)),
            "wall_time": float(steps["wall_time"].sum()),
        }

    def plot(self, what: str = "speed", **look: Any) -> "Picture":
        """A figure, which a notebook shows.

        Parameters
        ----------
        what : str
            "profiles", "interface", "front", "volume", "speed", or a field at the cell centres.
        **look
            Options of `fvcollapse.draw.look.Look`: `upright=True`, `times=(0.1, 0.5)`.

        Raises
        ------
        InputError
            There is no such field.
        """
        from fvcollapse.draw.figures import draw  # loads matplotlib
        from fvcollapse.draw.look import Look

        return draw(self, what, Look(**look))

    def to_xarray(self, fields: bool = True) -> "xarray.DataTree":
        """All arrays with names, units and coordinates, in the groups series, steps, profiles and fields.

        Parameters
        ----------
        fields : bool
            The fields as well: all in memory, on the largest of their grids, NaN beyond an earlier one.

        Raises
        ------
        ImportError
            xarray is not installed.
        """
        return tree_of(self, fields)

    def __repr__(self) -> str:
        end = self.series["time"][-1]
        words = (set_up_words(self.case), f"t = 0 to {end:.4g} s", self.status)
        return f"<Result: {', '.join(words)}, trust: {self.trust.verdict}>"

    def _repr_html_(self) -> str:
        return html_table("run", summary_rows(self.summary(), self.case))

    def summary_table(self) -> str:
        """The summary as aligned plain text."""
        rows = summary_rows(self.summary(), self.case)
        width = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def open_result(path: str | Path) -> Result:
    """The result at `path`: the file, or the folder that holds `result.h5`.

    Raises
    ------
    InputError
        One line, if it is missing, truncated, or no result.
    """
    path = Path(path)
    return Result(path / "result.h5" if os.path.isdir(path) else path)


def write_status(file: h5py.File, status: str, trust: Trust) -> None:
    """Write status and trust of a run as root attributes of an open result.

    Parameters
    ----------
    file : h5py.File
    status : str
        See `Result`.
    trust : Trust
    """
    file.attrs["complete"] = status == COMPLETE
    file.attrs["status"] = status
    file.attrs["trust"] = trust.verdict
    file.attrs["trust_reasons"] = json.dumps(trust.reasons)


def read_status(file: h5py.File, complete: bool) -> str:
    """`Result.status`; for an older file without this attribute it follows from `complete`."""
    if "status" in file.attrs:
        return text_attribute(file, "status")
    return COMPLETE if complete else INTERRUPTED


def read_trust(file: h5py.File) -> Trust | None:
    """The `Trust` in a file; None for an older file without it."""
    if "trust" not in file.attrs:
        return None
    reasons = json.loads(text_attribute(file, "trust_reasons"))
    return Trust(text_attribute(file, "trust"), tuple(map(str, reasons)))


def read_field_times(file: h5py.File) -> np.ndarray:
    """Times of the fields in order; the groups are numbered from 0."""
    fields = file["fields"]
    return np.array([fields[str(index)].attrs["time"] for index in range(len(fields))])
