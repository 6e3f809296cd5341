"""Columns of glass beads between walls: the gap of the model on real grains, and how far one friction closes it.

The part `columns` of the study. Each of the 28 columns of `lajeunesse2005` runs with the constants that its folder
states, with and without the measured friction of the lateral walls; with it also with the friction of the grains
at rest multiplied by `FACTORS` (mu_2 - mu_1 stays). One factor for all is fitted to run-outs and final heights.
Every third column, in the order of aspect ratio, is held out.

Writes columns.csv (each measured number beside the computed ones) and columns_fit.csv.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from fvcollapse import load_experiment, observe
from fvcollapse.diagnosis.baseline import baseline_cases
from runs.study import run_cached
from runs.table import write_table

FOLDER = "lajeunesse2005"
FACTORS = (0.5, 0.75, 1.0)  # of mu_1
WALLS = {
    "absent": (1.0,),
    "measured": FACTORS,
}  # friction of the lateral walls: factors that are run
QUANTITIES = ("runout", "final_height")
EVERY, FIRST = 3, 1  # columns that are held out: every third, from the second on


class Column(NamedTuple):
    """A column: its name, its `Experiment`, and its aspect ratio."""

    name: str
    experiment: object
    aspect: float


def columns(options):
    """Run all columns, fit the one factor, and write both tables."""
    found = read_columns(options.experiments / FOLDER)
    results = run_cached(cases_of(found, options.cell_size), options)
    rows = [row for column in found for row in rows_of(column, results)]
    fits = [fit(rows, walls) for walls in WALLS]
    factors = {one["walls"]: one["factor"] for one in fits}
    for row in rows:
        row["computed_fitted"] = round(computed(row, factors[row["walls"]]), 6)
    write_table(options.tables / "columns.csv", rows)
    write_table(options.tables / "columns_fit.csv", fits)
    for one in fits:
        print("  ".join(f"{key} {value}" for key, value in one.items()))


def read_columns(folder):
    """The columns of a folder of experiments, by aspect ratio."""
    read = [load_experiment(path.parent) for path in sorted(folder.glob("*/experiment.toml"))]
    shapes = [one.settings.geometry for one in read]
    found = [
        Column(one.name, one, shape.height_0 / shape.length_0)
        for one, shape in zip(read, shapes, strict=True)
    ]
    return sorted(found, key=lambda column: column.aspect)


def cases_of(found, cell_size):
    """{(column, walls, factor): Case}."""
    given = baseline_cases([column.experiment for column in found], None, cell_size)
    return {
        (column.name, walls, factor): changed(given[column.name], column.experiment, walls, factor)
        for column in found
        for walls in WALLS
        for factor in WALLS[walls]
    }


def changed(case, experiment, walls, factor):
    """A case with other friction of the grains, and with that of the walls if it acts."""
    mu_1, mu_2 = case.rheology.mu_1, case.rheology.mu_2
    changes = {"rheology.mu_1": factor * mu_1, "rheology.mu_2": mu_2 - (1.0 - factor) * mu_1}
    if walls == "measured":
        changes["effects.lateral_friction.mu_wall"] = experiment.settings.material.mu_wall
    return case.replace(**changes)


def rows_of(column, results):
    """A row for each measured number of a column and for each state of the walls."""
    for number in column.experiment.scalars:
        if number.name not in QUANTITIES:
            continue
        for walls in WALLS:
            seen = [
                observe(results[column.name, walls, factor], column.experiment).scalars[number.name]
                for factor in WALLS[walls]
            ]
            yield {
                "column": column.name,
                "aspect": round(column.aspect, 4),
                "length_0": round(column.experiment.settings.geometry.length_0, 6),
                "quantity": number.name,
                "walls": walls,
                "measured": round(number.value, 6),
                "sigma": round(number.sigma, 6),
                **{f"computed_{f:g}": "" for f in FACTORS},
                **{
                    f"computed_{f:g}": round(float(value), 6)
                    for f, value in zip(WALLS[walls], seen, strict=True)
                },
            }


# -- one friction for all --------------------------------------------------------------------------


def fit(rows, walls):
    """The gap before and after a fit of the factor to the columns that are not held out; 1 where no other was run."""
    own = [row for row in rows if row["walls"] == walls]
    names = sorted({(row["aspect"], row["column"]) for row in own})
    held_out = {name for _, name in names[FIRST::EVERY]}
    parts = {
        "fitted": [row for row in own if row["column"] not in held_out],
        "held_out": [row for row in own if row["column"] in held_out],
    }
    factor = best_factor(parts["fitted"]) if len(WALLS[walls]) > 1 else 1.0
    row = {"walls": walls, "factor": round(factor, 3), "columns": len(names)}
    for part, of in parts.items():
        before, after = rms(of, 1.0), rms(of, factor)
        row |= {f"rms_{part}": round(before, 2), f"rms_{part}_after": round(after, 2)}
        row[f"closed_{part}"] = round(1.0 - after / before, 3)
    for quantity in QUANTITIES:
        of = [each for each in own if each["quantity"] == quantity]
        for label, at in (("", 1.0), ("_after", factor)):
            row[f"{quantity}_mean_percent{label}"] = round(100.0 * relative(of, at), 1)
    return row


def best_factor(rows):
    """The factor with the least gap."""
    between = (min(FACTORS), max(FACTORS))
    return float(
        minimize_scalar(lambda factor: rms(rows, factor), bounds=between, method="bounded").x
    )


def computed(row, factor):
    """The computed number of a row at a factor that was run, or between those that were."""
    if factor == 1.0:
        return float(row["computed_1"])
    values = [float(row[f"computed_{each:g}"]) for each in FACTORS]
    return float(CubicSpline(FACTORS, values)(factor))


def rms(rows, factor):
    """Root mean square of the gap over its uncertainty."""
    gaps = [(computed(row, factor) - float(row["measured"])) / float(row["sigma"]) for row in rows]
    return float(np.sqrt(np.mean(np.square(gaps))))


def relative(rows, factor):
    """Mean of the relative gap."""
    return float(np.mean([computed(row, factor) / float(row["measured"]) - 1.0 for row in rows]))
