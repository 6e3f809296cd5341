"""Sets of constants and effects against what the paper prints of its experiments (w = 10 cm).

    python -m runs.paper_facts.study facts finer beds grid [--cell-size 0.006]

    facts   sets of friction, bed, thin layers, dilatancy, gate and walls at 0, 10, 22 deg: facts.csv, facts_sets.csv
    finer   those that come nearest, on cells two thirds as large: finer.csv, finer_sets.csv
    beds    the bed with Coulomb friction, without slip, and rough with thin_layer, at 0, 10, 16, 22 deg: beds.csv
    grid    22 deg on a rough bed on finer grids and in shorter steps, with and without thin_layer: grid.csv

A case that is already in its table is not run again; delete the table to remake it. Runs are kept below --out: an
interrupted part continues with the same command.
"""

import math
import sys
from functools import partial

import numpy as np

from fvcollapse.case.case import Case
from runs.paper_facts.sets import NEAREST_SETS, SINK, WIDTH, bed, collapse, fact_sets
from runs.study import Study, add_rows, cost, finished_run, run_in_folders
from runs.study import main as call
from runs.table import read_table, write_table

SLOPES = (0.0, 10.0, 22.0)  # deg, of the printed facts
BED_SLOPES = (0.0, 10.0, 16.0, 22.0)
GRIDS = (0.01, 0.008, 0.006, 0.004, 0.003, 0.002)  # m
STEPS = (1.2e-3, 6e-4)  # s, on cells of 6 mm; the default is 2.4 ms
WAYS = {  # words: friction, changes; what else could limit the convergence
    "tolerance 1e-4": ("0.38, 0.64", {"numerics.tolerance": 1e-4}),
    "no film rule": ("0.38, 0.64", {"numerics.film_thickness": 0.0}),
    "0.44, 0.69": ("0.44, 0.69", {}),  # comes to rest
}
WAY_GRIDS = (0.006, 0.003, 0.002)  # m
AT_22 = 1.76  # s, the last time that the paper shows at 22 deg
RUNOUT_0, SLACK = 0.475, 0.025  # m from the back wall, measured at 0 deg; saltation and reading
HEIGHT_0, HEIGHT_SLACK = 0.14, 0.005  # m
LIMIT_10, LIMIT_22 = 0.7, 1.6  # m; the deposit ends before
FLOWING = 0.02  # share of the volume in motion; less is at rest
GAIN = 0.005  # of the runout, by which the paper lets a front still advance after 1.76 s
SWEEPS = {  # 30 sweeps do not converge while the gate leaves the dilating grains at 0.05 s; see README.md
    ("0.48, 0.73; no slip; L = 1.65 d; dilatancy from 0.62, gate 0.8 m/s", 0.0, 0.006): {
        "numerics.max_sweeps": 100
    }
}
FRONTS = ("runout_1mm", "runout_5mm", "runout_10mm")


def facts(options):
    """Run every set at the slopes of the printed facts, and hold it against them."""
    return hold(fact_sets(), "facts", options.cell_size, options)


def finer(options):
    """The sets that meet four of the facts on cells two thirds as large."""
    sets = {name: settings for name, settings in fact_sets().items() if name in NEAREST_SETS}
    return hold(sets, "finer", options.cell_size / 1.5, options)


def hold(sets, stem, cell_size, options):
    """Run sets into <stem>.csv, hold them against the facts in <stem>_sets.csv; return what is missing."""
    path = options.tables / f"{stem}.csv"
    cases = {
        f"{name}; {slope:g} deg": collapse(slope, WIDTH, cell_size)
        | settings
        | SWEEPS.get((name, slope, cell_size), {})
        for name, settings in sets.items()
        for slope in SLOPES
    }
    missing = run_table(path, cases, options)
    rows = {row["name"]: row for row in read_table(path)}
    held = []
    for name in sets:
        of_set = [rows.get(f"{name}; {slope:g} deg") for slope in SLOPES]
        if None not in of_set:
            held.append({"set": name} | held_against_facts(*of_set))
    write_table(options.tables / f"{stem}_sets.csv", held)
    return missing


def held_against_facts(flat, middle, steep):
    """What the rows of one set at 0, 10, 22 deg say of the facts: values in m, and which facts are met."""
    height, flowing = float(flat["height"]), float(steep["flowing_1.76s"])
    gain = float(steep["gain_1mm_after_1.76s"]) / float(steep["runout_1mm"])
    row = {}
    for front in FRONTS:
        x = [float(of[front]) for of in (flat, middle, steep)]
        row |= dict(zip((f"{front}_0", f"{front}_10", f"{front}_22"), x, strict=True))
    row |= {"height_0": height, "flowing_22": flowing, "gain_22": gain}
    for front in FRONTS:
        row[f"met_{front.removeprefix('runout_')}"] = " ".join(
            name
            for name, met in (
                ("runout0", abs(row[f"{front}_0"] - RUNOUT_0) <= SLACK),
                ("height0", abs(height - HEIGHT_0) <= HEIGHT_SLACK),
                ("10", row[f"{front}_10"] < LIMIT_10),
                ("22", row[f"{front}_22"] < LIMIT_22),
                ("still22", gain < GAIN),
                ("rest22", flowing < FLOWING),
            )
            if met
        )
    return row


def beds(options):
    """Run the beds side by side."""
    kinds = {
        "Coulomb": (True, None),
        "Coulomb, thin_layer": (True, 1.65),
        "no slip": (False, None),
        "rough: no slip, thin_layer": (False, 1.65),
    }
    cases = {}
    for friction in ("0.48, 0.73", "0.38, 0.64"):
        for words, (slips, length) in kinds.items():
            for width, walls in ((WIDTH, SINK), (math.inf, None)):
                for slope in BED_SLOPES:
                    set_up = collapse(slope, width, options.cell_size)
                    grains = bed(friction, slips, length) | {"effects.lateral_friction": walls}
                    name = f"{friction}; {words}; w = {width:g} m; {slope:g} deg"
                    cases[name] = set_up | grains
    return run_table(options.tables / "beds.csv", cases, options)


def grid(options):
    """Run 22 deg, w = 10 cm, 0.38, 0.64, no slip on finer and finer grids, in shorter steps, and in other ways."""
    cases = {
        f"{words}; {1e3 * size:g} mm": collapse(22.0, WIDTH, size)
        | bed("0.38, 0.64", slips, length)
        | {"effects.lateral_friction": SINK}
        for size in GRIDS
        for words, slips, length in (
            ("no slip; L = 1.65 d", False, 1.65),
            ("no slip", False, None),
        )
    }
    for step in STEPS:
        words = f"no slip; L = 1.65 d; {1e3 * options.cell_size:g} mm; {1e3 * step:g} ms"
        cases[words] = (
            collapse(22.0, WIDTH, options.cell_size)
            | bed("0.38, 0.64", False, 1.65)
            | {"effects.lateral_friction": SINK, "time.step_max": step}
        )
    for words, (friction, changes) in WAYS.items():
        for size in WAY_GRIDS:
            cases[f"no slip; L = 1.65 d; {1e3 * size:g} mm; {words}"] = (
                collapse(22.0, WIDTH, size)
                | bed(friction, False, 1.65)
                | {"effects.lateral_friction": SINK}
                | changes
            )
    return run_table(options.tables / "grid.csv", cases, options)


def run_table(path, cases, options):
    """Run what is missing in a table and add its rows; return a line for every run that failed."""
    missing, rows, done = [], [], {row["name"] for row in read_table(path)}
    wanted = {name: settings for name, settings in cases.items() if name not in done}
    folders = {name: options.out / path.stem / folder_name(name, wanted[name]) for name in wanted}
    run_in_folders(
        {folders[name]: Case().replace(**settings) for name, settings in wanted.items()},
        options.workers,
    )
    for name, settings in wanted.items():
        result, problem = finished_run(folders[name])
        if result is None:
            missing.append(problem)
        else:
            first = {"name": name, "cell_size": settings["grid.cell_size"]}
            rows.append(first | measured(result, cost(folders[name])))
    add_rows(path, rows)
    for row in rows:
        print(row)
    return missing


def folder_name(name, settings):
    """A name that every file system takes, with the size of the cells."""
    short = "".join(letter if letter.isalnum() or letter in "._" else "_" for letter in name)
    return f"{short}_{1e3 * settings['grid.cell_size']:g}mm"


def measured(result, cpu_s):
    """Numbers of one finished run, lengths in m, times in s."""
    summary, profiles = result.summary(), result.profiles
    now = int(np.argmin(np.abs(profiles.time - AT_22)))
    h, static = profiles.thickness[now], profiles.static_height[now]
    late = np.interp(AT_22, result.time, result.series["runout_1mm"])
    return {
        "runout_1mm": summary["runout_1mm"],
        "runout_5mm": summary["runout"],
        "runout_10mm": summary["runout_10mm"],
        "x_99": summary["x_99"],
        "height": summary["final_thickness"],
        "arrest": summary["arrest_time"],
        "flowing_1.76s": float((h - static).sum() / h.sum()),
        "gain_1mm_after_1.76s": float(summary["runout_1mm"] - late),
        "peak_front_velocity": float(result.series["front_velocity"].max()),
        "largest_relative_volume": float(np.max(result.series["relative_volume"])),
        "steps": summary["steps"],
        "capped_steps": summary["capped_steps"],
        "cpu_s": round(cpu_s, 1),
    }


STUDY = Study(
    "paper_facts",
    __doc__,
    {"facts": facts, "finer": finer, "beds": beds, "grid": grid},
    uses=("cell_size",),
    cell_size=0.006,
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
