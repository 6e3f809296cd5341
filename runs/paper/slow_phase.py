"""The search for a slow phase of the front at 22 deg: combinations, tables, fronts for the figure."""

import numpy as np

from runs.paper.slow_front import least_ratio, motion, slow_phase
from runs.paper.slow_sets import all_sets
from runs.study import add_rows, cost, run_settings

FRONTS = {"1mm": "runout_1mm", "5mm": "runout", "10mm": "runout_10mm"}  # series of a result
LATE = 1.76  # s, the last time that the paper shows


def search(options):
    """Run all combinations on the cells asked for; return what is missing."""
    folder = options.tables / "slow_phase"
    settings = {
        f"{name}; {1e3 * options.cell_size:g} mm": of | {"grid.cell_size": options.cell_size}
        for name, of in all_sets().items()
    }
    return add_phases(folder / "phases.csv", settings, options)


def add_phases(path, settings, options):
    """Run what a table lacks, and add its rows; return a line for each run that failed."""
    missing, rows = [], []
    out = options.out / "slow_phase"
    for name, first, result, problem in run_settings(path, settings, out, options.workers):
        if result is None:
            missing.append(problem)
        else:
            rows.append(first | phases(result) | {"cpu_s": round(cost(out / name), 1)})
    add_rows(path, rows)
    return missing


def phases(result):
    """Slow phase, peak and runout of the fronts of a result: columns by the thickness at which they are read."""
    row = {}
    for mm, series in FRONTS.items():
        of = motion(result.time, result.series[series], result.case.grid.cell_size)
        found, peak = slow_phase(of), of.speed[of.peak]
        row |= {
            f"phase_{mm}_s": found.duration,
            f"speed_{mm}_m_s": found.speed,
            f"start_{mm}_s": found.start,
            f"share_{mm}": found.speed / peak,
            f"ratio_{mm}": least_ratio(of),
            f"peak_{mm}_m_s": peak,
            f"late_speed_{mm}_m_s": float(np.interp(LATE, of.time, of.speed)),
            f"runout_{mm}_m": float(result.series[series][-1]),
        }
    return row | {"arrest_s": result.summary()["arrest_time"]}
