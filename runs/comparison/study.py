"""Collapses that other people computed or measured, recomputed with their constants; nothing is tuned.

    python -m runs.comparison.study columns volume_of_fluid channel plane differences bars steady_front --data FOLDER

FOLDER holds the published data (particles, continuum, lab), which only the last three parts read. Each other part runs
its cases and writes runs/comparison/<part>.csv and <part>_profiles.csv; cases already in the table are not run
again. `differences` compares the tables with the data, writes differences.csv and the reference curves of
the figures, and prints the differences in units of the uncertainty of the data. `bars` runs the aluminium bars
through the cache of runs and compares them with the experiment: bars.csv. `steady_front` does so with a front of
beads on a rough plane: steady_front.csv.
"""

import json
import math
import sys
from functools import partial

import numpy as np

from runs.comparison.bars import bars
from runs.comparison.differences import compare
from runs.comparison.steady_front import steady_front
from runs.comparison.tables import Folders
from runs.study import Study, add_rows, cost, run_settings
from runs.study import main as call
from runs.table import read_table, write_table

GRAVITY = 9.81
# mu(I) of the discs, with the bulk density in I as the other solver has it
DISCS = {
    "rheology.mu_1": 0.32,
    "rheology.mu_2": 0.60,
    "rheology.I_0": 0.40,
    "rheology.density_grain": 1550.0,
    "rheology.density_bulk": 1550.0,
}
# symmetry plane without friction, rough bed, instant release, no lateral walls
TWO_SIDED = {
    "geometry.slope_angle_deg": 0.0,
    "geometry.channel_width": math.inf,
    "boundary.mu_bed": math.inf,
    "boundary.mu_back_wall": 0.0,
    "gate.speed": math.inf,
}
DISC = 0.005  # m, diameter of the discs
DATED = (0.66, 0.95, 1.24, 1.52, 2.28)  # times of the dated discs, in sqrt(height / g)
FINAL_ONLY = ("channel", "plane")  # parts of which only the deposit is kept
BEAD = 0.00115  # m
MU_WALL = math.tan(math.radians(24.8))  # measured friction of the beads on the walls
CHANNEL_AREA = 0.0064  # m2 of column; the data give ratios only, so the size is an assumption
ASPECTS = (0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 4.5, 7.0)


def columns():
    """The columns of the contact-dynamics discs, to the end of the motion."""
    return {
        "a0.5": two_sided(0.149, 0.5, 1 / 30, cells=26, end=8),
        "a6.26": two_sided(0.67, 6.26, DISC / 0.67, 64, 8, DATED),
        "a6.26_fine": two_sided(0.67, 6.26, DISC / 0.67, 100, 8, DATED),
    }


def volume_of_fluid():
    """The column 1 x 2 of the volume-of-fluid solution; its cell is 1/25.6 of the height."""
    return {
        f"cells{cells}": two_sided(0.14, 0.5, 1 / 30, cells=cells, end=4) for cells in (13, 26, 52)
    }


def plane():
    """Columns of other aspect ratios in the same set-up, for the scaling laws of two-dimensional flow."""
    return {
        f"a{aspect:g}": two_sided(0.149 * aspect**0.5, aspect, 1 / 60, cells=cells, end=8)
        for aspect, cells in ((1.0, 26), (2.0, 32), (4.0, 64))
    }


def channel():
    """Beads in a channel 45 mm wide, whose walls have the measured friction; then its sensitivities."""
    cases = {f"a{aspect:g}": beads(aspect) for aspect in ASPECTS}
    for aspect in (0.5, 2.0):
        cases[f"a{aspect:g}_smooth_sides"] = beads(aspect, mu_wall=0.0)
        cases[f"a{aspect:g}_half_size"] = beads(aspect, area=0.25 * CHANNEL_AREA)
        cases[f"a{aspect:g}_rough_bed"] = beads(aspect, **{"boundary.mu_bed": math.inf})
    return cases


def two_sided(height, aspect, grain, cells, end, dated=()):
    """Settings of a two-sided column of discs.

    Parameters
    ----------
    height : float
        Height [m].
    aspect : float
        Height over half width.
    grain : float
        Grain diameter over height.
    cells : int
        Cells per height.
    end : int
        Last time, in sqrt(height / g); profiles are kept at the whole numbers.
    dated : tuple
        Further times of profiles.
    """
    return (
        TWO_SIDED
        | DISCS
        | {"geometry.height_0": height, "geometry.length_0": height / aspect}
        | {"rheology.grain_diameter": grain * height, "grid.cell_size": height / cells}
        | times(height, end, dated)
    )


def beads(aspect, mu_wall=MU_WALL, area=CHANNEL_AREA, **changes):
    """Settings of a column of glass beads; 16 cells in its smaller dimension.

    mu_1 is the measured repose angle, mu_2 and I_0 those of glass beads (Jop et al.); bed and back
    wall have the measured friction of the walls, for want of their own.
    """
    height = math.sqrt(area * aspect)
    return {
        "geometry.slope_angle_deg": 0.0,
        "geometry.channel_width": 0.045,
        "geometry.height_0": height,
        "geometry.length_0": height / aspect,
        "rheology.mu_1": math.tan(math.radians(22.0)),
        "rheology.mu_2": 0.6435,
        "rheology.I_0": 0.279,
        "rheology.grain_diameter": BEAD,
        "boundary.mu_bed": MU_WALL,
        "boundary.mu_back_wall": MU_WALL,
        "gate.speed": math.inf,
        "front.thickness": 2.0 * BEAD,
        "grid.cell_size": min(height, height / aspect) / 16,
        "effects.lateral_friction": {"mu_wall": mu_wall},
        **times(height, 8),
        **changes,
    }


def times(height, end, dated=()):
    """Settings of the output: profiles at whole multiples of sqrt(height / g), and at `dated` ones."""
    unit = math.sqrt(height / GRAVITY)
    return {
        "time.end": end * unit,
        "time.output_interval": end * unit,
        "time.field_interval": end * unit,
        "time.output_times": [n * unit for n in sorted((*range(1, end), *dated))],
    }


# -- runs --------------------------------------------------------------------------------------


def row_of(first, result, cpu_s):
    """A finished run as a row."""
    series, height = result.series, result.case.geometry.height_0
    length, summary = result.case.geometry.length_0, result.summary()
    return first | {
        "aspect": round(height / length, 4),
        "runout_over_l0": round(summary["runout"] / length - 1.0, 4),
        "runout_1mm_over_l0": round(summary["runout_1mm"] / length - 1.0, 4),
        "final_height_over_l0": round(summary["final_thickness"] / length, 4),
        "max_speed_end": float(f"{summary['final_max_speed']:.3g}"),
        "volume_error_max": float(f"{summary['volume_error_max']:.3g}"),
        "volume_correction": float(f"{summary['volume_correction']:.3g}"),
        "steps": summary["steps"],
        "capped_steps": summary["capped_steps"],
        "x_99_curve": json.dumps(
            curve(series["time"], series["x_99"], height, np.arange(0.0, 8.01, 0.1))
        ),
        "cpu_s": round(cpu_s, 1),
    }


def curve(t, value, height, at):
    """A series in column heights at the times `at` in sqrt(height / g), as far as it goes."""
    t_star = np.asarray(t) * math.sqrt(GRAVITY / height)
    at = at[at <= t_star[-1] + 1e-6]
    return (np.interp(at, t_star, value) / height).round(4).tolist()


def profile_rows(name, result, deposit_only):
    """Profiles in column heights, from the back wall to the first bare node beyond the grains."""
    profiles, height, rows = result.profiles, result.case.geometry.height_0, []
    pairs = list(zip(profiles.time, profiles.thickness, strict=True))
    for t, h in pairs[-1:] if deposit_only else pairs:
        t_star = round(float(t) * math.sqrt(GRAVITY / height), 3)
        last = min(np.flatnonzero(h > 0.0)[-1] + 2, h.size)
        rows += [
            {
                "name": name,
                "t_star": t_star,
                "x_over_h0": round(x / height, 4),
                "h_over_h0": round(value / height, 4),
            }
            for x, value in zip(profiles.x[:last].tolist(), h[:last].tolist(), strict=True)
        ]
    return rows


def do_part(part, options):
    """Run what is missing of one part, and add it to its tables; return a line for each run that failed."""
    path, folder = options.tables / f"{part}.csv", options.out / part
    rows, profiles, missing = [], [], []
    for name, first, result, problem in run_settings(path, PARTS[part](), folder, options.workers):
        if result is None:
            missing.append(problem)
            continue
        rows.append(row_of(first, result, cost(folder / name)))
        profiles += profile_rows(name, result, part in FINAL_ONLY)
    if rows:
        of_profiles = options.tables / f"{part}_profiles.csv"
        write_table(of_profiles, [*read_table(of_profiles), *profiles])
        add_rows(path, rows)
    hidden = ("settings", "x_99_curve")
    for row in rows:
        print({key: value for key, value in row.items() if key not in hidden})
    return missing


def differences(options):
    """Compare the tables with the data."""
    compare(Folders(options.data, options.tables))


PARTS = {part.__name__: part for part in (columns, volume_of_fluid, channel, plane)}
STUDY = Study(
    "comparison",
    __doc__,
    {part: partial(do_part, part) for part in PARTS}
    | {"differences": differences, "bars": bars, "steady_front": steady_front},
    need_data=("differences", "bars", "steady_front"),
    uses=("cache",),
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
