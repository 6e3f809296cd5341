"""From a result to one row of numbers of a table; units are in the names of the columns."""

import math

import numpy as np

from fvcollapse.measure.pile import SPEED_STATIC
from runs.paper import measures, pressure
from runs.paper.readings import at_peak, eta_I, field_at, front_curve, profile_at

INTERFACE_TIMES = (0.30, 0.48, 0.96)  # s
FLOWING_TIMES = (0.48, 1.0, 1.76)  # s
ROUGHNESS_TIMES = (0.96, 1.5)  # s
PRESSURE_TIMES = (0.96, 1.5)  # s
SHEAR_TIME = 0.48  # s
REAR = 0.10  # m; "near the back wall"
THICK = 0.010  # m
BAND_THICKNESS, BAND_CELLS = 0.025, 4  # columns whose flowing part is at least that thick
BAND_LENGTH = 0.012  # m
FRONT_LENGTH = 0.05  # m; "at the front"


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


def front_scalars(result):
    """Peak, plateau and tail of the front velocity at the thickness of the case."""
    time, front = front_curve(result)
    velocity = measures.front_velocity(front)
    peak = measures.peak_index(velocity)
    stopped = velocity[peak:] < measures.STOPPED
    found = measures.plateau(velocity)
    return {
        "peak_velocity_m_s": velocity[peak],
        "peak_time_s": measures.peak_time(velocity),
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


def flowing_thickness(result):
    """Thickness of the flowing layer, mean over the flowing grains and times after 0.1 s, m."""
    profiles = result.profiles
    layer = (profiles.thickness - profiles.static_height)[profiles.time >= 0.1]
    layer = np.where(layer > measures.FLOW_LEAST, layer, 0.0)
    return float((layer**2).sum() / layer.sum()) if layer.any() else math.nan


def flow_scalars(result):
    """Viscosity eta_I and inertial number in the flowing part when the front is fastest, and in all."""
    mean, total = 0.0, 0.0
    for index in np.flatnonzero(result.field_times >= 0.1)[::2]:  # every 0.1 s says enough
        eta_now, _, weight_now = flowing_cells(result, result.field(int(index)))
        mean, total = mean + (eta_now * weight_now).sum(), total + weight_now.sum()
    found = at_peak(result, lambda field: flowing_numbers(result, field))
    return found | {"eta_mean_all_Pa_s": float(mean / max(total, 1e-30))}


def flowing_numbers(result, field):
    """Viscosity eta_I and inertial number in the flowing part of one field."""
    eta, inertial, weight = flowing_cells(result, field)
    low, high = measures.weighted_quantiles(eta, weight, (0.05, 0.95))
    least, median, most = measures.weighted_quantiles(inertial, weight, (0.01, 0.5, 0.99))
    return {
        "eta_mean_Pa_s": float((eta * weight).sum() / max(weight.sum(), 1e-30)),
        "eta_p05_Pa_s": low,
        "eta_p95_Pa_s": high,
        "I_p01": least,
        "I_p50": median,
        "I_p99": most,
        **inertial_at_edges(result, field),
    }


def inertial_at_edges(result, field):
    """Inertial number at the static–flowing interface, the surface and the front: medians over cells full of grains."""
    cells = pressure.columns(field, result.case)
    full = cells.weight > 0.99 * field["dx"] * field["dz"]
    flowing = full & (cells.speed > SPEED_STATIC) & (field["pressure"] > 0.0)
    inertial, place = field["inertial_number"], np.flatnonzero(flowing.any(axis=1))
    if place.size == 0:
        return dict.fromkeys(("I_interface", "I_surface", "I_front"), math.nan)
    lowest = flowing[place].argmax(axis=1)
    uppermost = flowing.shape[1] - 1 - flowing[place, ::-1].argmax(axis=1)
    above_static = lowest > 0  # elsewhere the grains flow on the bed
    front = cells.x[place] > cells.x[place[-1]] - FRONT_LENGTH
    values = {
        "I_interface": inertial[place, lowest][above_static],
        "I_surface": inertial[place, uppermost],
        "I_front": inertial[place[front]][flowing[place[front]]],
    }
    return {name: float(np.median(of)) if of.size else math.nan for name, of in values.items()}


def flowing_cells(result, field):
    """eta_I [Pa s], I and volume of grains of the flowing cells that bear pressure, (n,) each."""
    cells = pressure.columns(field, result.case)
    flowing = (cells.speed > SPEED_STATIC) & (cells.weight > 0.0) & (field["pressure"] > 0.0)
    eta = eta_I(field, result.case)
    return eta[flowing], field["inertial_number"][flowing], cells.weight[flowing]


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
