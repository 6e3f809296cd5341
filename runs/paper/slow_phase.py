"""The search for a slow phase of the front at 22 deg: combinations, tables, fronts for the figure.

Every combination is run on the cells asked for, and some of each kind on cells two thirds and half as large.
"""

import math

import numpy as np

from fvcollapse.case.case import Case
from runs.paper.slow_front import STEP, least_ratio, motion, slow_phase
from runs.paper.slow_sets import FINER_SETS, SHOWN, all_sets
from runs.study import add_rows, cost, finished_run, run_in_folders, run_settings
from runs.table import CURVE, RUN, Curve, curve_row, write_table

FRONTS = {"1mm": "runout_1mm", "5mm": "runout", "10mm": "runout_10mm"}  # series of a result
FINER = (1.0, 1.5, 2.0)  # cells of 6, 4, 3 mm
LATE = 1.76  # s, the last time that the paper shows


def search(options):
    """Run all combinations, some on finer grids; return what is missing."""
    path, sets, settings = options.tables / "slow_phase" / "phases.csv", all_sets(), {}
    for finer in FINER:
        size = options.cell_size / finer
        for name in sets if finer == FINER[0] else FINER_SETS:
            settings[grid_name(name, size)] = sets[name] | {"grid.cell_size": size}
    return add_phases(path, settings, options) + write_speeds(options)


def grid_name(name, size):
    """Name of a run of a combination on cells of one size [m]."""
    return f"{name}; {1e3 * size:g} mm"


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


def write_speeds(options):
    """Write how fast the fronts of the combinations of the figure are, on each grid; return what is missing.

    What was run before is not run again.
    """
    rows, missing, sets, cases = [], [], all_sets(), {}
    for name in SHOWN:
        for finer in FINER:
            size = options.cell_size / finer
            at = options.out / "slow_phase" / grid_name(name, size)
            cases[at] = Case().replace(**sets[name], **{"grid.cell_size": size})
    run_in_folders(cases, options.workers)
    for at in cases:
        result, problem = finished_run(at)
        if result is None:
            missing.append(problem)
            continue
        size = result.case.grid.cell_size
        name = at.name.rpartition("; ")[0]
        first = {"case": name, "refinement": options.cell_size / size, "cell_size_mm": 1e3 * size}
        rows += [curve_row(first, curve) for curve in speeds(result)]
    write_table(options.tables / "slow_phase" / "speeds.csv", rows, (*RUN, *CURVE))
    return missing


def speeds(result):
    """The `Curve`s of the speed of the fronts of a result [m/s]."""
    for mm, series in FRONTS.items():
        of = motion(result.time, result.series[series], result.case.grid.cell_size)
        yield Curve(f"speed_{mm}_m_s", math.nan, math.nan, "t_s", 0.0, STEP, of.speed, 3)
