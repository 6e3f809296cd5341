"""From a result to the numbers and curves that the tables keep; nothing else reads the results.

`scalars(result, cost)` is one row of a table, `curves(result, member, refinement)` the rows of
another. Units are in the names of the columns.
"""

import math

import numpy as np

from fvcollapse.measure.pile import SPEED_STATIC, thickness
from fvcollapse.step.rheology import material
from runs.paper import measures, pressure
from runs.table import FINE, Curve

COARSE_STEP = 0.05  # s, of the curves that no figure shows in detail
PROFILE_STEP = 0.010  # m
MESH_TIMES = (0.48, 0.96)  # s; of the profiles on the finest grids
INTERFACE_TIMES = (0.30, 0.48, 0.96)  # s
FLOWING_TIMES = (0.48, 1.0, 1.76)  # s
ROUGHNESS_TIMES = (0.96, 1.5)  # s
PRESSURE_TIMES = (0.96, 1.5)  # s
SHEAR_TIME = 0.48  # s
STATIONS = {"velocity": (0.15, 0.25, 0.35), "pressure": (0.1, 0.25, 0.4, 0.6)}  # m
REAR = 0.10  # m; "near the back wall"
THICK = 0.010  # m
BAND_THICKNESS, BAND_CELLS = 0.025, 4  # columns whose flowing part is at least that thick
BAND_LENGTH = 0.012  # m
WINDOW = (0.25, 0.55, 0.08)  # m; part of the shear-rate field that is kept: x from, x to, z to


# -- numbers -------------------------------------------------------------------------------------


def scalars(result, cpu_s):
    """One row of numbers of a result.

    Parameters
    ----------
    result : Result
    cpu_s : float
        CPU time of the run [s].

    Returns
    -------
    dict of str: float
        NaN (None in `arrest_s`) where something does not exist.
    """
    summary, series = result.summary(), result.series
    return {
        "complete": int(result.complete),
        "end_s": summary["time"],
        "runout_1mm_m": summary["runout_1mm"],
        "runout_5mm_m": summary["runout"],
        "runout_10mm_m": summary["runout_10mm"],
        "x_99_m": summary["x_99"],
        "final_height_m": summary["final_thickness"],
        "max_speed_m_s": float(series["max_speed"].max()),
        "arrest_s": summary["arrest_time"],
        **front_scalars(result),
        **profile_scalars(result),
        **flow_scalars(result),
        **pressure_scalars(result),
        **shear_scalars(result),
        "volume_error_max": summary["volume_error_max"],
        "volume_correction": summary["volume_correction"],
        "capped_steps": summary["capped_steps"],
        "steps": summary["steps"],
        "sweeps": summary["sweeps"],
        "cpu_s": cpu_s,
    }


def front_curve(result, name="runout", step=measures.STEP):
    """Times and running maximum of a front position, equidistant [s, m]."""
    time = step * np.arange(int(result.time[-1] / step + 1e-6) + 1)
    return time, np.interp(time, result.time, result.series[name])


def front_scalars(result):
    """Peak, plateau and tail of the front velocity at the thickness of the case."""
    time, front = front_curve(result)
    velocity = measures.front_velocity(front)
    peak = measures.peak_index(velocity)
    stopped = velocity[peak:] < measures.STOPPED
    found = measures.plateau(velocity)
    return {
        "peak_velocity_m_s": velocity[peak],
        "peak_time_s": time[peak],
        "stop_time_s": time[peak + int(np.argmax(stopped))] if stopped.any() else math.nan,
        "plateau_start_s": found.start,
        "plateau_duration_s": found.duration,
        "plateau_velocity_m_s": found.velocity,
        "tail_ratio": measures.tail_ratio(velocity),
        "acceleration_m_s2": measures.early_acceleration(time, velocity, 0.3, 0.6),
    }


def profile_scalars(result):
    """Heights, slope, interface, flowing part and roughness, off the profiles."""
    profiles = result.profiles
    row = {}
    h, _ = profile_at(profiles, 1.76)
    row["rear_height_m"] = float(h[profiles.x <= REAR].max())
    row["surface_slope_deg"] = measures.surface_slope(profiles.x, h, THICK)
    for time in INTERFACE_TIMES:
        h, static = profile_at(profiles, time)
        angle, curvature = measures.interface(profiles.x, static, h)
        row[f"interface_angle_{time:g}_deg"] = angle
        row[f"interface_curvature_{time:g}_per_m"] = curvature
    for time in FLOWING_TIMES:
        h, static = profile_at(profiles, time)
        row[f"flowing_share_{time:g}"] = float((h - static).sum() / h.sum())
    row["flowing_thickness_m"] = flowing_thickness(result)
    for time in ROUGHNESS_TIMES:
        h, _ = profile_at(profiles, time)
        end = profiles.x[h >= THICK].max(initial=0.0)
        rough = measures.roughness(profiles.x, h, 0.05, end - 0.05)
        row[f"roughness_{time:g}_mm"] = 1e3 * rough
    return row


def profile_at(profiles, time):
    """Thickness and static height of the profile nearest to a time; the last, if it is later."""
    nearest = int(np.argmin(np.abs(profiles.time - time)))
    return profiles.thickness[nearest], profiles.static_height[nearest]


def flowing_thickness(result):
    """Thickness of the flowing layer, mean over the flowing grains and times after 0.1 s, m."""
    profiles = result.profiles
    layer = (profiles.thickness - profiles.static_height)[profiles.time >= 0.1]
    layer = np.where(layer > measures.FLOW_LEAST, layer, 0.0)
    return float((layer**2).sum() / layer.sum()) if layer.any() else math.nan


def field_at(result, time):
    """The stored field nearest to a time."""
    return result.field(int(np.argmin(np.abs(result.field_times - time))))


def flow_scalars(result):
    """Viscosity eta_I and inertial number in the flowing part when the front is fastest, and in all."""
    eta, inertial, weight = flowing_cells(result, peak_field(result))
    low, high = measures.weighted_quantiles(eta, weight, (0.05, 0.95))
    least, median, most = measures.weighted_quantiles(inertial, weight, (0.01, 0.5, 0.99))
    mean, total = 0.0, 0.0
    for index in np.flatnonzero(result.field_times >= 0.1)[::2]:  # every 0.1 s says enough
        eta_now, _, weight_now = flowing_cells(result, result.field(int(index)))
        mean, total = mean + (eta_now * weight_now).sum(), total + weight_now.sum()
    return {
        "eta_mean_Pa_s": float((eta * weight).sum() / max(weight.sum(), 1e-30)),
        "eta_p05_Pa_s": low,
        "eta_p95_Pa_s": high,
        "eta_mean_all_Pa_s": float(mean / max(total, 1e-30)),
        "I_p01": least,
        "I_p50": median,
        "I_p99": most,
    }


def flowing_cells(result, field):
    """eta_I [Pa s], I and volume of grains of the flowing cells that bear pressure, (n,) each."""
    cells = pressure.columns(field, result.case)
    flowing = (cells.speed > SPEED_STATIC) & (cells.weight > 0.0) & (field["pressure"] > 0.0)
    eta = eta_I(field, result.case)
    return eta[flowing], field["inertial_number"][flowing], cells.weight[flowing]


def eta_I(field, case):
    """Equation 6, (mu_2 - mu_1) p / (2|D| + (I_0/k) sqrt p), whatever the law of the run, Pa s."""
    law, p = material(case), np.maximum(field["pressure"], 0.0)
    rate = field["shear_rate"] + law.I_0 / law.grain_scale * np.sqrt(p)
    return (law.mu_2 - law.mu_1) * p / np.maximum(rate, 1e-30)


def pressure_scalars(result):
    """Misfits of the hydrostatic pressure and of equation 22 in the flowing part."""
    row = {}
    for time in PRESSURE_TIMES:
        cells = pressure.columns(field_at(result, time), result.case)
        row[f"misfit_hydrostatic_{time:g}"] = pressure.misfit(cells, "hydrostatic")
        row[f"misfit_22_{time:g}"] = pressure.misfit(cells, "equation_22")
        row[f"misfit_share_{time:g}"] = pressure.flowing_share_valid(cells)
    return row


def shear_scalars(result):
    """Shear bands at 0.48 s, and the ill-posed part of the flow from 0.1 to 1 s."""
    field = field_at(result, SHEAR_TIME)
    cells = pressure.columns(field, result.case)
    full = cells.weight > 0.5 * field["dx"] * field["dz"]
    flowing = full & (cells.speed > SPEED_STATIC)
    deep = flowing.sum(axis=1) >= max(BAND_CELLS, BAND_THICKNESS / field["dz"] - 0.5)
    rate = field["shear_rate"]
    early = (result.time > 0.1) & (result.time < 1.0)
    return {
        "bands_0.48": measures.bands(rate[deep], flowing[deep]),
        "unevenness_0.48": measures.unevenness(rate, flowing, field["dz"], BAND_LENGTH),
        "shear_rate_p999_0.48_per_s": float(np.quantile(rate[flowing], 0.999))
        if flowing.any()
        else math.nan,
        "ill_posed_share": float(result.series["ill_posed_fraction"][early].mean()),
    }


# -- curves --------------------------------------------------------------------------------------


def curves(result, member, refinement):
    """All `Curve`s of a result that the tables keep."""
    step = measures.STEP if "fronts" in member.keep else COARSE_STEP
    # beyond the pair of grids only the study of the mesh needs profiles
    times = member.profiles if refinement <= FINE else set(member.profiles) & set(MESH_TIMES)
    found = [front(result, "runout", "front_m", step), deposit(result)]
    found += profile_curves(result, sorted(times))
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


def deposit(result):
    """The last thickness [mm]."""
    profiles = result.profiles
    return profile("deposit_mm", profiles.time[-1], profiles.x, profiles.thickness[-1], 0.02)


def profile_curves(result, times):
    """Thickness and interface at some times [mm]; the interface where there is a static part."""
    x = result.profiles.x
    for time in times:
        h, static = profile_at(result.profiles, time)
        yield profile("thickness_mm", time, x, h)
        if result.case.rheology.law != "drucker_prager":  # no figure shows those
            yield profile("static_mm", time, x, static)


def profile(name, time, x, h, step=PROFILE_STEP):
    """A profile on equidistant abscissae, to the first bare one [mm]."""
    count = int(np.ceil(x[bare_from(h) - 1] / step)) + 1
    values = 1e3 * np.interp(step * np.arange(count), x, h, right=0.0)
    return Curve(name, time, math.nan, "x_m", 0.0, step, values, 1)


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
    field = peak_field(result)
    h = thickness(field["level_set"], field["dz"])
    yield profile("peak_thickness_mm", field["time"], field["dx"] * np.arange(len(h)), h)


def viscosity(result):
    """eta_I of the flowing part, by columns of cells, when the front is fastest."""
    field = peak_field(result)
    cells = pressure.columns(field, result.case)
    eta = np.where(cells.speed > SPEED_STATIC, eta_I(field, result.case), math.nan)
    yield from by_column("peak_eta_Pa_s", field["time"], field, eta, cells.weight > 0.0)


def peak_field(result):
    """The stored field nearest to the time of the fastest front."""
    time, front = front_curve(result)
    return field_at(result, time[measures.peak_index(measures.front_velocity(front))])


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


BASE, PAIR, ALL = (1.0,), (1.0, FINE), (1.0, FINE, 2.0, 3.0)
KEPT = {  # name: (refinements it is kept of, function)
    "fronts": (PAIR, fronts),
    "volume": (BASE, volume),
    "peak": (PAIR, peak),
    "viscosity": (BASE, viscosity),
    "velocity": (BASE, velocity),
    "pressure": (BASE, pressures),
    "shear": (ALL, shear),
}
