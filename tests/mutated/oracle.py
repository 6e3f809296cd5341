"""What no collapse of grains can be: bounds that are independent of what the package checks.

Every function takes what a loader has accepted and yields one sentence for each thing that is impossible.
"""

import math

import msgspec
import numpy as np

LONGEST = 1.0e6  # m
LIGHT = 3.0e8  # m/s
NO_END = ("channel_width", "mu_bed", "mu_back_wall", "mu_gate", "speed", "mu_wall")  # may be inf
FRACTIONS = ("detached_volume", "ill_posed_fraction")
LENGTHS = ("front_position", "runout", "runout_1mm", "runout_10mm", "x_99", "max_thickness")
POSITIVE = ("kinetic_energy", "max_speed", "volume_correction", "negative_pressure_cells", "time")
RUNNING = ("runout", "runout_1mm", "runout_10mm")


def numbers(tree, path=""):
    """(path, number) of every number in nested structures."""
    if isinstance(tree, msgspec.Struct):
        tree = {name: getattr(tree, name) for name in tree.__struct_fields__}
    if isinstance(tree, dict):
        for name, value in tree.items():
            yield from numbers(value, f"{path}.{name}")
    elif isinstance(tree, list | tuple):
        for value in tree:
            yield from numbers(value, path)
    elif isinstance(tree, int | float) and not isinstance(tree, bool):
        yield path, float(tree)


def impossible_case(case):
    """A case no laboratory can set up."""
    for path, value in numbers(case):
        name = path.rpartition(".")[2]
        if math.isnan(value) or (math.isinf(value) and name not in NO_END):
            yield f"{path} = {value}"
        if value < 0.0 and "effects" not in path:
            yield f"{path} = {value}"
    geometry, rheology = case.geometry, case.rheology
    if not 0.0 < geometry.height_max <= 1000.0 or not 0.0 < geometry.length_max <= 1000.0:
        yield "a column without size"
    if not 0.0 <= geometry.slope_angle_deg <= 30.0:
        yield "a slope outside of 0 to 30 deg"
    if rheology.mu_2 < rheology.mu_1 or rheology.density_bulk > rheology.density_grain:
        yield "friction that falls with I, or grains lighter than their packing"
    cells = geometry.height_max * geometry.length_max / case.grid.cell_size
    if cells / (case.grid.cell_size_z or case.grid.cell_size) > 1.0e8:
        yield "more cells than any memory"


def impossible_experiment(experiment):
    """Measurements no experiment can leave."""
    height, length = (experiment.stated(f"geometry.{name}_0") for name in ("height", "length"))
    for name, curve in experiment.curves.items():
        arrays = [curve.time, curve.value, curve.sigma, *([] if curve.x is None else [curve.x])]
        if not all(np.isfinite(values).all() for values in arrays):
            yield f"{name} not finite"
        if (curve.sigma < 0.0).any():
            yield f"{name}: negative standard deviation"
        if not (np.diff(curve.time) >= 0.0).all():
            yield f"{name}: times not in order"
        if abs(curve.time).max() > 1.0e5:
            yield f"{name}: time {abs(curve.time).max():g} s"
        low, high = {
            "front": (-length, 1000.0 * (length + height)),
            "volume": (-1.0, 10.0),
            "profiles": (-0.5 * height, 10.0 * height),
            "interface": (-10.0 * height, 10.0 * height),
        }[name]
        if curve.value.min() < low or curve.value.max() > high:
            yield f"{name}: {curve.value.min():g} to {curve.value.max():g}"
        if curve.x is not None and (abs(curve.x) > 1000.0 * (length + height)).any():
            yield f"{name}: x = {abs(curve.x).max():g}"
    for scalar in experiment.scalars:
        if not (math.isfinite(scalar.value) and 0.0 <= scalar.sigma < 1.0e5):
            yield f"{scalar.name} = {scalar.value} +- {scalar.sigma}"
        if not -length <= scalar.value <= 1.0e5:
            yield f"{scalar.name} = {scalar.value}"


def impossible_pairs(pairs):
    """Digitised points that are none."""
    if not np.isfinite(pairs).all() or pairs.ndim != 2 or pairs.shape[1] != 2:
        yield "pairs that are not finite"
    elif not (np.diff(pairs[:, 0]) > 0.0).all():
        yield "abscissae that do not increase"


def impossible_series(series, end):
    """Series of a run that are impossible."""
    count = len(series["time"])
    for name, values in series.items():
        if values.shape != (count,) or values.dtype.kind not in "fiu":
            yield f"series/{name}: {values.dtype} {values.shape}"
        elif not np.isfinite(values).all():
            yield f"series/{name}: not finite"
    if not (np.diff(series["time"]) > 0.0).all() or series["time"][-1] > end + 1.0e-6:
        yield "series/time out of order or beyond the end"
    for name in (*LENGTHS, *POSITIVE):
        if series[name].min() < 0.0:
            yield f"series/{name}: {series[name].min():g}"
    for name in LENGTHS:
        if series[name].max() > LONGEST:
            yield f"series/{name}: {series[name].max():g}"
    for name in FRACTIONS:
        if series[name].min() < 0.0 or series[name].max() > 1.0001:
            yield f"series/{name}: {series[name].min():g} to {series[name].max():g}"
    for name in RUNNING:
        if (np.diff(series[name]) < 0.0).any():
            yield f"series/{name}: a running value that falls"
    if series["relative_volume"].min() < -1.0001 or series["max_speed"].max() > LIGHT:
        yield "volume below nothing, or grains faster than light"


def impossible_result(result):
    """A result of no run."""
    yield from impossible_case(result.case)
    yield from impossible_series(result.series, result.case.time.end)
    time, x, h, static = result.profiles
    if h.shape != (len(time), len(x)) or static.shape != h.shape or h.dtype.kind != "f":
        yield "profiles of a wrong shape"
        return
    if not all(np.isfinite(values).all() for values in (time, x, h, static)):
        yield "profiles not finite"
    if not (np.diff(x) > 0.0).all() or not (np.diff(time) > 0.0).all():
        yield "profiles out of order"
    if min(x.min(), h.min(), static.min()) < 0.0 or max(x.max(), h.max()) > LONGEST:
        yield "profiles below the bed, or longer than any channel"
    if (static > h + 1.0e-4).any():
        yield "grains at rest above the surface"
    steps = result.steps
    for name, values in steps.items():
        if len(values) != len(result.series["time"]) - 1 or not np.isfinite(values).all():
            yield f"steps/{name}"
    if len(steps["dt"]) and min(steps["dt"].min(), steps["sweeps"].min()) < 0:
        yield "steps of negative length"


def impossible_fields(fields):
    """Fields of no state."""
    last = -1.0
    for field in fields:
        if field["pressure"].ndim != 2:
            yield f"pressure: {field['pressure'].shape}"
            return
        nx, nz = field["pressure"].shape
        shapes = {"level_set": (nx + 1, nz + 1), "u": (nx + 1, nz), "w": (nx, nz + 1)}
        for name, values in field.items():
            if name in ("time", "dx", "dz"):
                continue
            if values.shape != shapes.get(name, (nx, nz)) or values.dtype.kind != "f":
                yield f"{name}: {values.dtype} {values.shape}"
            elif not np.isfinite(values).all():
                yield f"{name}: not finite"
        if not (last < field["time"] < 1e6 and 0 < field["dx"] < 1e3 and 0 < field["dz"] < 1e3):
            yield f"time {field['time']}, cells {field['dx']} x {field['dz']}"
        last = field["time"]


def impossible_state(state):
    """A state of no simulation."""
    arrays = {
        name: value for name, value in state.entries().items() if isinstance(value, np.ndarray)
    }
    for name, values in arrays.items():
        if values.dtype != np.float64 or not np.isfinite(values).all():
            yield f"state/{name}: {values.dtype}"
    for name, value in state.entries().items():
        if name not in arrays:
            if isinstance(value, bool) or not isinstance(value, int | float):
                yield f"state/{name}: {value!r}"
            elif not math.isfinite(value):
                yield f"state/{name} = {value}"
    if min(state.time, state.step, state.dt, state.volume_correction) < 0 or state.volume_0 <= 0:
        yield "a state before the start, or without grains"


def impossible_scores(scores):
    """Scores that are no shares."""
    for path, value in numbers(scores):
        if not math.isfinite(value):
            yield f"{path} = {value}"
        if path.endswith((".top_1.value", ".set_holds_truth.value")) and not 0.0 <= value <= 1.0:
            yield f"{path} = {value}"
