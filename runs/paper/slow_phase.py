"""The search for a slow phase of the front at 22 deg: combinations and their table.

Every combination is run on the cells asked for, and some of each kind on cells two thirds as large. What has a phase
there, read at any thickness, is run on cells half as large.
"""

import numpy as np

from runs.paper.slow_front import LEAST_TIME, least_ratio, motion, slow_phase
from runs.paper.slow_sets import FINER_SETS, all_sets
from runs.study import add_rows, cost, run_settings
from runs.table import read_table, to_float

FRONTS = {"1mm": "runout_1mm", "5mm": "runout", "10mm": "runout_10mm"}  # series of a result
FINER = (1.0, 1.5, 2.0)  # cells of 6, 4, 3 mm
LATE = 1.76  # s, the last time that the paper shows


def search(options):
    """Run all combinations, some on finer grids; return what is missing."""
    path, sets = options.tables / "slow_phase" / "phases.csv", all_sets()
    missing, wanted = [], list(sets)
    for finer in FINER:
        size = options.cell_size / finer
        settings = {grid_name(name, size): sets[name] | {"grid.cell_size": size} for name in wanted}
        missing += add_phases(path, settings, options)
        rows = {row["name"]: row for row in read_table(path)}
        wanted = [
            name
            for name in FINER_SETS
            if finer == FINER[0] or has_phase(rows.get(grid_name(name, size)))
        ]
    return missing


def grid_name(name, size):
    """Name of a run of a combination on cells of one size [m]."""
    return f"{name}; {1e3 * size:g} mm"


def has_phase(row):
    """Whether a front of a row of the table has a phase, read at any thickness."""
    return bool(row) and any(to_float(row[f"phase_{mm}_s"]) >= LEAST_TIME for mm in FRONTS)


def add_phases(path, settings, options):
    """Run what a table lacks, and add its rows; return a line for each run that failed."""
    missing, rows = [], []
    out = options.out / "slow_phase"
    for name, _, result, problem in run_settings(path, settings, out, options.workers):
        if result is None:
            missing.append(problem)
        else:
            rows.append({"name": name} | phases(result) | {"cpu_s": round(cost(out / name), 1)})
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
