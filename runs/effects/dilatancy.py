"""Volume against time with dilatancy, at 22 degrees in channels of 10 and 20 cm, beside the paper's curves.

The part `dilatancy` of the study of the effects. The experiments of Martin et al. (2017) swell by about 3 %
(w = 10 cm) and 10 % (20 cm) and come back to about the volume of the start.
"""

import numpy as np

from fvcollapse.case.case import Case
from runs.study import run_cached
from runs.table import write_table

WIDTHS = (0.10, 0.20)  # m
SETS = {  # K, nu_eq(0), slope, nu_0
    "literature": (4.0, 0.60, 0.15, 0.62),
    "from the critical state": (4.0, 0.60, 0.15, 0.60),
    "strong end of the priors": (5.0, 0.585, 0.20, 0.62),
    "loose": (4.0, 0.60, 0.15, 0.58),
}
KEYS = ("dilatancy_factor", "solid_fraction_critical", "solid_fraction_slope", "solid_fraction_0")


def dilatancy(options):
    """Run all of them and write the table."""
    cases = {
        (name, width): collapse(width, values, options.cell_size)
        for name, values in SETS.items()
        for width in WIDTHS
    }
    results = run_cached(cases, options)
    rows = [row(name, width, results[name, width]) for name, width in cases]
    write_table(options.tables / "dilatancy.csv", rows)
    for each in rows:
        print("  ".join(f"{key} {value}" for key, value in each.items()))


def collapse(width, values, cell_size):
    """The case of one channel and one set of values."""
    return Case().replace(
        **{
            "geometry.slope_angle_deg": 22.0,
            "geometry.channel_width": width,
            "grid.cell_size": cell_size,
            "time.end": 2.5,
            "effects.lateral_friction": {},
            "effects.dilatancy": dict(zip(KEYS, values, strict=True)),
        }
    )


def row(name, width, result):
    """Largest and last change of the volume."""
    time, volume = result.series["time"], result.series["relative_volume"]
    peak = int(np.argmax(np.abs(volume)))
    return {
        "set": name,
        "width_m": width,
        **dict(zip(KEYS, SETS[name], strict=True)),
        "largest_change_percent": round(100.0 * float(volume[peak]), 2),
        "at_s": round(float(time[peak]), 2),
        "final_change_percent": round(100.0 * float(volume[-1]), 2),
        "capped_steps": int(np.sum(result.steps["capped"])),
        "cell_size_m": result.case.grid.cell_size,
    }
