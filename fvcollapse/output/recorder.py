"""Record of a run: series at every step, profiles, fields, step log.

The schedule is a pure function of the case, so that a resumed run lands on the same times to the
last bit. Fields are compressed once, into an HDF5 file in memory. Every result and checkpoint
copies them from there.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from fvcollapse.files.hdf5 import memory_file, write_dataset
from fvcollapse.march import SAME_TIME
from fvcollapse.measure.pile import ill_posed_share, static_height, thickness
from fvcollapse.measure.series_readings import front_velocity, numerical_loss
from fvcollapse.measure.series_row import ROW
from fvcollapse.output.stored_names import PROFILES, SERIES, STEPS, about_field
from fvcollapse.step.erodible_bed import layer_thickness
from fvcollapse.step.geometry import cell_fractions

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.simulation import Simulation
    from fvcollapse.step.grid import Grid
    from fvcollapse.step.state import State


DERIVED = ("front_velocity", "numerical_loss")  # from the other series, when written
RUNNING = {"runout": "front_position", "runout_1mm": "front_1mm", "runout_10mm": "front_10mm"}
AT_LANDINGS = (
    "ill_posed_fraction"  # costs as much as a sweep: computed at landings, kept until the next
)
NOT_STORED = ("filled_fraction", "ill_posed")  # cell quantities that follow from the stored fields


class Landing(NamedTuple):
    """A time that a step must end on, and what is recorded there."""

    time: float
    profile: bool
    field: bool


class Columns(NamedTuple):
    """The record of a run as arrays by name, as a result has them: series, step log and profiles."""

    series: dict
    steps: dict
    profiles: dict


def schedule(case: "Case") -> list[Landing]:
    """All `Landing`s of a case in order; times are k * interval, never accumulated."""
    end = case.time.end
    wanted = [(0.0, True, True)]
    wanted += [(time, True, False) for time in multiples(case.time.output_interval, end)]
    wanted += [(time, False, True) for time in multiples(case.time.field_interval, end)]
    wanted += [(time, True, True) for time in case.time.output_times if time <= end]
    wanted.append((end, True, True))
    merged = []
    for time, profile, field in sorted(wanted, key=lambda item: item[0]):
        if merged and time - merged[-1].time < SAME_TIME:
            merged[-1] = Landing(
                merged[-1].time, merged[-1].profile or profile, merged[-1].field or field
            )
        else:
            merged.append(Landing(time, profile, field))
    return merged


def multiples(interval: float, end: float) -> list[float]:
    """Values k * interval for k = 1, 2, … up to the end (and the round-off of it)."""
    return [k * interval for k in range(1, int(end / interval + SAME_TIME) + 1)]


class Recorder:
    """Record of a run in memory; `read` restores exactly what `write` has stored.

    Attributes
    ----------
    series, steps : dict of lists
        One value per step; `series` has one more, at t = 0.
    profile_times, profiles : list, dict of lists of (nx + 1,) arrays
        The arrays grow with the domain.
    store : h5py.File
        In memory; /fields/<index> and /paraview/<index>.
    """

    def __init__(self) -> None:
        self.series = {name: [] for name in SERIES if name not in DERIVED}
        self.steps = {}
        self.profile_times, self.x = [], np.zeros(0)
        self.profiles = {name: [] for name in PROFILES}
        self.store = memory_file()
        for name in ("fields", "paraview"):
            self.store.create_group(name)

    # -- while the run goes on -------------------------------------------------------------------

    def add_start(self, simulation: "Simulation", landing: Landing) -> None:
        """Record the start of a run."""
        self.add_rows(simulation.row[None])
        self.add_landing(simulation, landing)

    def add_rows(self, rows: np.ndarray) -> None:
        """Append rows (n, len(ROW)) of the series, and the running maxima."""
        columns = dict(zip(ROW, rows.T, strict=True))
        columns["negative_pressure_cells"] = columns["negative_pressure_cells"].astype(int)
        for name, source in RUNNING.items():
            highest = self.series[name][-1:] or [-np.inf]
            columns[name] = np.maximum(np.maximum.accumulate(columns[source]), highest)
        for name, values in self.series.items():
            if name != AT_LANDINGS:
                values += columns[name].tolist()
        share = self.series[AT_LANDINGS]
        share += len(rows) * (share[-1:] or [0.0])

    def add_steps(self, marched: Any, wall_time: float) -> None:
        """Append what a march has done in so many seconds; they are divided evenly among its steps."""
        if not marched.records:
            return
        self.add_rows(marched.rows)
        each = wall_time / len(marched.records)
        for record in marched.records:
            for name, value in (record._asdict() | {"wall_time": each}).items():
                self.steps.setdefault(name, []).append(value)

    def add_landing(self, simulation: "Simulation", landing: Landing) -> None:
        """Record what is due at a landing: the ill-posed share, the profile, the field."""
        quantities = simulation.cell_quantities()
        self.series[AT_LANDINGS][-1] = ill_posed_share(simulation.state, quantities)
        if landing.profile:
            self.add_profile(simulation)
        if landing.field:
            self.add_field(simulation, quantities)

    def add_profile(self, simulation: "Simulation") -> None:
        """Append thickness and static–flowing interface, from the surface of an erodible layer."""
        state, grid, layer = simulation.state, simulation.grid, layer_thickness(simulation.case)
        self.profile_times.append(state.time)
        self.x = grid.dx * np.arange(grid.nx + 1)
        self.profiles["thickness"].append(thickness(state.level_set, grid.dz) - layer)
        self.profiles["static_height"].append(static_height(state, grid) - layer)

    def add_field(self, simulation: "Simulation", quantities: dict[str, np.ndarray]) -> None:
        """Compress the present fields into /fields/<index>, and write the arrays for ParaView.

        `quantities` are those of `Simulation.cell_quantities`.
        """
        state, grid = simulation.state, simulation.grid
        own = ("level_set", "u", "w", *state.effect_fields())
        arrays = {name: getattr(state, name) for name in own}
        arrays |= {name: values for name, values in quantities.items() if name not in NOT_STORED}
        index = str(len(self.store["fields"]))
        group = self.store["fields"].create_group(index)
        group.attrs["time"] = state.time
        group.attrs["dx"], group.attrs["dz"] = grid.dx, grid.dz
        for name, values in arrays.items():
            write_dataset(group, name, values, *about_field(name))
        write_paraview(self.store["paraview"].create_group(index), state, grid)

    def drop_end(self, landings: list[Landing], end: float) -> None:
        """Forget the snapshots at a previous `end` that are not in the present schedule."""
        here = [landing for landing in landings if abs(landing.time - end) < SAME_TIME]
        profile, field = (
            any(landing.profile for landing in here),
            any(landing.field for landing in here),
        )
        if not profile and self.profile_times and abs(self.profile_times[-1] - end) < SAME_TIME:
            for values in (self.profile_times, *self.profiles.values()):
                values.pop()
        last = str(len(self.store["fields"]) - 1)
        if (
            not field
            and last != "-1"
            and abs(self.store["fields"][last].attrs["time"] - end) < SAME_TIME
        ):
            del self.store["fields"][last], self.store["paraview"][last]

    # -- to and from a file ----------------------------------------------------------------------

    def columns(self) -> Columns:
        """The `Columns` of the record."""
        series = self.series | {
            "front_velocity": front_velocity(self.series["time"], self.series["front_position"]),
            "numerical_loss": numerical_loss(self.series),
        }
        heights = {name: pad_rows(self.profiles[name], len(self.x)) for name in PROFILES}
        return Columns(
            {name: np.array(series[name]) for name in SERIES},
            {name: np.array(self.steps.get(name, [])) for name in STEPS | self.steps},
            {"time": np.array(self.profile_times), "x": self.x} | heights,
        )

    def write(self, file: h5py.File) -> None:
        """Write /series, /profiles, /fields, /steps and /paraview into an open HDF5 file."""
        columns = self.columns()
        for name, about in SERIES.items():
            write_dataset(file.require_group("series"), name, columns.series[name], *about)
        for name, values in columns.steps.items():
            about = STEPS.get(name, ("SI", name.replace("_", " ")))
            write_dataset(file.require_group("steps"), name, values, *about)
        group, profiles = file.create_group("profiles"), columns.profiles
        write_dataset(group, "time", profiles["time"], "s", "times of the profiles")
        write_dataset(group, "x", profiles["x"], "m", "distance along the bed from the back wall")
        for name, about in PROFILES.items():
            write_dataset(group, name, profiles[name], *about)
        for name in ("fields", "paraview"):
            self.store.copy(name, file)

    @classmethod
    def read(cls, file: h5py.File) -> "Recorder":
        """The recorder that wrote this file, whose form has been checked (see `record_layout`)."""
        recorder = cls()
        recorder.series = {name: file["series"][name][:].tolist() for name in recorder.series}
        recorder.steps = {name: file["steps"][name][:].tolist() for name in file["steps"]}
        recorder.profile_times = file["profiles/time"][:].tolist()
        recorder.x = file["profiles/x"][:]
        recorder.profiles = {name: list(file["profiles"][name][:]) for name in PROFILES}
        for name in ("fields", "paraview"):
            del recorder.store[name]
            file.copy(name, recorder.store)
        return recorder


def pad_rows(rows: list[np.ndarray], width: int) -> np.ndarray:
    """Rows of growing length as one array, with zeros beyond the end that the domain had then."""
    table = np.zeros((len(rows), width))
    for row, values in zip(table, rows, strict=True):
        row[: len(values)] = values
    return table


def write_paraview(group: h5py.Group, state: "State", grid: "Grid") -> None:
    """Node coordinates and cell-centred velocity, (…, 3): what XDMF cannot express.

    ParaView's y is z here (normal to the bed), so that its first view shows the pile upright. The velocity is zero
    where there are no grains: there the stored one is the continuation that the scheme needs, and no flow of air.
    """
    x, z = grid.dx * np.arange(grid.nx + 1), grid.dz * np.arange(grid.nz + 1)
    coordinates = np.zeros((grid.nx + 1, grid.nz + 1, 3), np.float32)
    coordinates[..., 0], coordinates[..., 1] = x[:, None], z[None, :]
    velocity = np.zeros((grid.nx, grid.nz, 3), np.float32)
    velocity[..., 0] = 0.5 * (state.u[:-1] + state.u[1:])
    velocity[..., 1] = 0.5 * (state.w[:, :-1] + state.w[:, 1:])
    velocity[cell_fractions(state.level_set) == 0.0] = 0.0
    write_dataset(group, "coordinates", coordinates, "m", "x, z and 0 of the nodes")
    write_dataset(
        group,
        "velocity",
        velocity,
        "m/s",
        "u, w and 0 at the cell centres; 0 outside of the grains",
    )
