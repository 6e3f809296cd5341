"""What several numbers and curves read off a result: fronts, profiles, fields, viscosity."""

import numpy as np

from fvcollapse.step.rheology import material
from runs.paper import measures


def front_curve(result, name="runout", step=measures.STEP):
    """Times and running maximum of a front position, equidistant [s, m]."""
    time = step * np.arange(int(result.time[-1] / step + 1e-6) + 1)
    return time, np.interp(time, result.time, result.series[name])


def profile_at(profiles, time):
    """Thickness and static height of the profile nearest to a time; the last, if it is later."""
    nearest = int(np.argmin(np.abs(profiles.time - time)))
    return profiles.thickness[nearest], profiles.static_height[nearest]


def field_at(result, time):
    """The stored field nearest to a time."""
    return result.field(int(np.argmin(np.abs(result.field_times - time))))


def peak_time(result):
    """Time of the fastest front, s."""
    _, front = front_curve(result)
    return measures.peak_time(measures.front_velocity(front))


def peak_field(result):
    """The stored field nearest to the time of the fastest front."""
    return field_at(result, peak_time(result))


def at_peak(result, numbers_of):
    """{name: number} that a function gives of a field, linear in time between the fields about the fastest front."""
    times, when = result.field_times, peak_time(result)
    after = min(max(int(np.searchsorted(times, when)), 1), len(times) - 1)
    share = float(np.clip((when - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0))
    first, second = (numbers_of(result.field(index)) for index in (after - 1, after))
    return {name: (1.0 - share) * first[name] + share * second[name] for name in first}


def peak_thickness(result):
    """Thickness, linear in time between the profiles about the fastest front, m."""
    profiles, when = result.profiles, peak_time(result)
    after = min(max(int(np.searchsorted(profiles.time, when)), 1), len(profiles.time) - 1)
    first, second = profiles.time[after - 1], profiles.time[after]
    share = float(np.clip((when - first) / (second - first), 0.0, 1.0))
    return (1.0 - share) * profiles.thickness[after - 1] + share * profiles.thickness[after]


def eta_I(field, case):
    """Equation 6, (mu_2 - mu_1) p / (2|D| + (I_0/k) sqrt p), whatever the law of the run, Pa s."""
    law, p = material(case), np.maximum(field["pressure"], 0.0)
    rate = field["shear_rate"] + law.I_0 / law.grain_scale * np.sqrt(p)
    return (law.mu_2 - law.mu_1) * p / np.maximum(rate, 1e-30)
