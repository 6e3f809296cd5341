"""From a result to the curves that a table holds; units are in the names of the columns."""

import math

import numpy as np

from fvcollapse.measure.pile import SPEED_STATIC
from runs.paper import measures, pressure
from runs.paper.readings import (
    eta_I,
    field_at,
    front_curve,
    peak_field,
    peak_thickness,
    peak_time,
    profile_at,
)
from runs.paper.scalars import PRESSURE_TIMES, SHEAR_TIME
from runs.table import REFINEMENTS, Curve

COARSE_STEP = 0.05  # s, of the curves that no figure shows in detail
PROFILE_STEP = 0.010  # m
STATIONS = {"velocity": (0.15, 0.25, 0.35), "pressure": (0.1, 0.25, 0.4, 0.6)}  # m
WINDOW = (0.25, 0.55, 0.08)  # m; part of the shear-rate field that is kept: x from, x to, z to


def curves(result, member, refinement):
    """All `Curve`s of a result that the tables keep."""
    step = measures.STEP if "fronts" in member.keep else COARSE_STEP
    found = [front(result, "runout", "front_m", step)]
    found += profile_curves(result, sorted(member.profiles))
    for name in member.keep:
        grids, function = KEPT[name]
        if refinement in grids:
            found += function(result)
    return found


def front(result, name, quantity, step, digits=4):
    """A front position until it stops."""
    _, position = front_curve(result, name, step)
    last = int(np.argmax(position >= position[-1] - 1e-4)) + 2
    return Curve(quantity, math.nan, math.nan, "t_s", 0.0, step, position[:last], digits)


def fronts(result):
    """The fronts at 1 and 10 mm thickness."""
    for millimetres in (1, 10):
        series, name = f"runout_{millimetres}mm", f"front_{millimetres}mm_m"
        yield front(result, series, name, COARSE_STEP, 3)


def profile_curves(result, times):
    """Thickness and interface at some times [mm]; the interface where there is a static part."""
    x = result.profiles.x
    for time in times:
        h, static = profile_at(result.profiles, time)
        yield profile("thickness_mm", time, x, h)
        if result.case.rheology.law != "drucker_prager":  # no figure shows those
            yield profile("static_mm", time, x, static)


def profile(name, time, x, h):
    """A profile on equidistant abscissae, to the first bare one [mm]."""
    count = int(np.ceil(x[bare_from(h) - 1] / PROFILE_STEP)) + 1
    values = 1e3 * np.interp(PROFILE_STEP * np.arange(count), x, h, right=0.0)
    return Curve(name, time, math.nan, "x_m", 0.0, PROFILE_STEP, values, 1)


def bare_from(h):
    """Number of nodes up to the first bare one behind the last grains."""
    filled = np.flatnonzero(h > 0.0)
    return min(int(filled[-1]) + 2, len(h)) if filled.size else 1


def volume(result):
    """Relative volume change in per cent."""
    _, change = front_curve(result, "relative_volume", COARSE_STEP)
    _, moved = front_curve(result, "volume_correction", COARSE_STEP)
    yield Curve("volume_percent", math.nan, math.nan, "t_s", 0.0, COARSE_STEP, 100.0 * change, 4)
    yield Curve("correction_percent", math.nan, math.nan, "t_s", 0.0, COARSE_STEP, 100.0 * moved, 3)


def peak(result):
    """Thickness when the front is fastest."""
    yield profile("peak_thickness_mm", peak_time(result), result.profiles.x, peak_thickness(result))


def viscosity(result):
    """eta_I of the flowing part, by columns of cells, when the front is fastest."""
    field = peak_field(result)
    cells = pressure.columns(field, result.case)
    eta = np.where(cells.speed > SPEED_STATIC, eta_I(field, result.case), math.nan)
    yield from by_column("peak_eta_Pa_s", field["time"], field, eta, cells.weight > 0.0)


def by_column(name, when, field, values, inside, window=(0.0, math.inf, math.inf)):
    """A cell-centred field as one `Curve` along z per column of cells, three digits, NaN outside."""
    left, right, top = window
    dx, dz = field["dx"], field["dz"]
    for i in range(values.shape[0]):
        x, filled = dx * (i + 0.5), np.flatnonzero(inside[i] & np.isfinite(values[i]))
        if left <= x <= right and filled.size:
            last = min(int(filled[-1]) + 1, int(top / dz) if math.isfinite(top) else len(values[i]))
            column = np.where(inside[i], values[i], math.nan)[:last]
            yield Curve(name, when, x, "z_m", 0.5 * dz, dz, column, -2)


def shear(result):
    """Shear rate in a window of the flow, by columns of cells."""
    field = field_at(result, SHEAR_TIME)
    inside = pressure.columns(field, result.case).weight > 0.5 * field["dx"] * field["dz"]
    yield from by_column("shear_per_s", SHEAR_TIME, field, field["shear_rate"], inside, WINDOW)


def velocity(result):
    """Velocity along the bed in three columns at 0.48 s."""
    field = field_at(result, SHEAR_TIME)
    cells = pressure.columns(field, result.case)
    u = 0.5 * (field["u"][:-1] + field["u"][1:])
    for x in STATIONS["velocity"]:
        column = u[nearest_column(field, x)][: filled_cells(field, cells, x)]
        yield Curve("u_m_s", SHEAR_TIME, x, "z_m", 0.5 * field["dz"], field["dz"], column, 3)


def pressures(result):
    """Pressure against depth at 1.5 s in four columns: computed, hydrostatic, equation 22 [Pa]."""
    time = PRESSURE_TIMES[-1]
    field = field_at(result, time)
    cells = pressure.columns(field, result.case)
    for x in STATIONS["pressure"]:
        i, n = nearest_column(field, x), filled_cells(field, cells, x)
        named = {"computed": cells.computed, "hydrostatic": cells.hydrostatic}
        named |= {"equation_22": cells.equation_22, "speed": cells.speed, "depth": cells.depth}
        for name, values in named.items():
            unit = {"speed": "m_s", "depth": "m"}.get(name, "Pa")
            digits = 4 if unit != "Pa" else 1
            label = f"pressure_{name}_{unit}"
            yield Curve(
                label, time, x, "z_m", 0.5 * field["dz"], field["dz"], values[i][:n], digits
            )


def nearest_column(field, x):
    """Index of the column of cells that holds x; the last, if the domain ends before."""
    return min(int(x / field["dx"]), field["pressure"].shape[0] - 1)


def filled_cells(field, cells, x):
    """Number of cells of the column at x that hold grains."""
    return int((cells.weight[nearest_column(field, x)] > 0.0).sum())


BASE, ALL = (1.0,), REFINEMENTS
DRAWN = REFINEMENTS[:4]  # a column for each cell: the finest would be as large as all others
KEPT = {  # name: (refinements it is kept of, function)
    "fronts": (ALL, fronts),
    "volume": (BASE, volume),
    "peak": (ALL, peak),
    "viscosity": (BASE, viscosity),
    "velocity": (ALL, velocity),
    "pressure": (BASE, pressures),
    "shear": (DRAWN, shear),
}
