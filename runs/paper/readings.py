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


def peak_field(result):
    """The stored field nearest to the time of the fastest front."""
    time, front = front_curve(result)
    return field_at(result, time[measures.peak_index(measures.front_velocity(front))])


def eta_I(field, case):
    """Equation 6, (mu_2 - mu_1) p / (2|D| + (I_0/k) sqrt p), whatever the law of the run, Pa s."""
    law, p = material(case), np.maximum(field["pressure"], 0.0)
    rate = field["shear_rate"] + law.I_0 / law.grain_scale * np.sqrt(p)
    return (law.mu_2 - law.mu_1) * p / np.maximum(rate, 1e-30)
