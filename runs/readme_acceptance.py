"""What the collapses of the acceptance study say, for its README."""

import json

import numpy as np

from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, change, pair, rounded, signed, span, table
from runs.table import RUNS, read_table

FOLDER = "acceptance"
READ = {"runout_10mm": "10 mm", "runout": "5 mm", "runout_1mm": "1 mm", "x_99": "x₉₉"}
COLUMN = 0.20  # m, length of the column: the gate stands at its end
GROUPS = {"0 and 10°": ("a0", "a10"), "16 and 19°": ("a16", "a19"), "22°": ("a22",)}
NARROW, MIDDLE, WIDE = "w0.1", "w0.2", "winf"
STEPS = ("dx6mm", "dt1.195ms", "dt0.5975ms")  # the default step, half of it, a quarter
VOLUME, SUM = 0.005, 0.1  # of the random cases: what is told of them


def rows_of(part):
    """{name: row} of a table of the study."""
    return {row["name"]: row for row in read_table(RUNS / FOLDER / f"{part}.csv")}


def made(*parts):
    """The line that names the solver of tables of the study."""
    return solver_line(*(f"{FOLDER}/{part}.csv" for part in parts))


# -- every slope and width -----------------------------------------------------------------------


def runouts():
    """Runout, front velocity and arrest of the collapses at all slopes, w = 10 cm and without walls."""
    rows = rows_of("matrix")
    lines = []
    for slope in sorted({int(name[1:].partition("_")[0]) for name in rows}):
        both = [rows[f"a{slope}_{width}"] for width in (NARROW, WIDE)]
        lines.append(
            (
                f"{slope}°, 10 cm / ∞",
                pair(both, "runout", 3, "m"),
                pair(both, "runout_10mm", 3, "m"),
                pair(both, "peak_front_velocity", 2, "m/s"),
                pair(both, "rest_since", 2, "s"),
            )
        )
    heading = ("α, w", "runout (5 mm)", "runout (10 mm)", "peak front velocity", "at rest since")
    return table(heading, lines) + made("matrix")


def matrix_says():
    """Arrest, lateral friction, volume and the horizontal experiment, read off the table."""
    rows = rows_of("matrix")
    return bullets([arrest(rows), walls(rows), volume(rows), *horizontal(rows)])


def arrest(rows):
    """When the collapses come to rest."""
    resting = [row for row in rows.values() if row["rest_since"]]
    told = ", ".join(
        f"after {span(times, lambda value: rounded(value, 2))} s at {words}"
        for words, slopes in GROUPS.items()
        for times in [[float(row["rest_since"]) for row in resting if slope_of(row) in slopes]]
    )
    return f"{len(resting)} of {len(rows)} collapses come to rest (nothing faster than 1 mm/s): {told}."


def slope_of(row):
    """The slope of a row, as its name has it."""
    return row["name"].partition("_")[0]


def walls(rows):
    """How much shorter lateral friction makes the runout."""

    def runout(slope, width):
        return float(rows[f"{slope}_{width}"]["runout_1.76s"])

    slopes = [slope for group in GROUPS.values() for slope in group]
    shorter = ", ".join(
        f"{rounded(1.0 - runout(slope, NARROW) / runout(slope, WIDE), 0, 100)} % at {slope[1:]}°"
        for slope in slopes
    )
    between = sum(
        runout(slope, NARROW) < runout(slope, MIDDLE) < runout(slope, WIDE) for slope in slopes
    )
    return (
        f"Lateral friction at w = 10 cm shortens the 5 mm runout at 1.76 s by {shorter}, against none. "
        f"w = 20 cm lies between at {between} of {len(slopes)} slopes."
    )


def volume(rows):
    """Error of the volume, its corrections, and what detaches."""

    def largest(column):
        return max(float(row[column]) for row in rows.values())

    sums = [float(row["volume_correction"]) for row in rows.values()]
    return (
        f"The volume is right to {largest('relative_volume_max'):.0e} at all times. Its corrections sum to "
        f"{span(sums, lambda value: rounded(value, 1, 100))} %; no single one exceeds "
        f"{rounded(largest('correction_step_max'), 3, 100)} %. At most {rounded(largest('detached_max'), 3, 100)} % "
        "of the volume is detached from the pile."
    )


def horizontal(rows):
    """The runout from the gate and the height of the deposit at 0 deg."""
    for width, words in ((WIDE, "without walls"), (NARROW, "with lateral friction, w = 10 cm")):
        row = rows[f"a0_{width}"]
        fronts = ", ".join(
            f"{rounded(float(row[name]) - COLUMN, 3)} m ({label})"
            for name, label in READ.items()
            if name != "x_99"
        )
        yield (
            f"At 0° {words} the front stops at these distances from the gate: {fronts}. "
            f"The deposit is {rounded(row['max_thickness'], 3)} m high."
        )


# -- grid and time step --------------------------------------------------------------------------


def refinement():
    """The reference collapse on finer cells and in shorter steps."""
    grid, steps = rows_of("grid"), rows_of("grid") | rows_of("time_step")
    lines = [cells_of(row, f"{name[2:-2]} mm") for name, row in grid.items()]
    lines += [cells_of(steps[name], f"6 mm, steps of {name[2:-2]} ms") for name in STEPS[1:]]
    heading = ("cells", *READ.values(), "peak front velocity", "at rest since", "corrections")
    return table(heading, lines) + made("grid", "time_step")


def cells_of(row, words):
    """Cells of a row of the reference collapse."""
    return (
        words,
        *(f"{rounded(row[name], 3)} m" for name in READ),
        f"{rounded(row['peak_front_velocity'], 2)} m/s",
        f"{rounded(row['rest_since'], 2)} s" if row["rest_since"] else "not at the end",
        f"{rounded(row['volume_correction'], 1, 100)} %",
    )


def refinement_says():
    """Changes between grids and between time steps."""
    grid, steps = rows_of("grid"), rows_of("grid") | rows_of("time_step")
    whole, half, quarter = (steps[name] for name in STEPS)
    curves = [np.array(json.loads(row["front_curve"])) for row in (whole, half)]
    furthest = float(np.max(np.abs(curves[1] - curves[0])))
    return bullets(
        [
            f"From 6 to 3 mm cells: {between(grid['dx6mm'], grid['dx3mm'])}.",
            f"From 4 to 3 mm cells: {between(grid['dx4mm'], grid['dx3mm'])}.",
            f"With half the time step: {between(whole, half)}. The 5 mm front is nowhere further off than "
            f"{rounded(furthest, 1, 1000)} mm.",
            f"With half of that again: {between(half, quarter)}.",
        ]
    )


def between(old, new):
    """Change of the runouts of a row in %, each named."""
    return ", ".join(
        f"{words} {signed(change(old[name], new[name]), 1)} %" for name, words in READ.items()
    )


# -- random cases --------------------------------------------------------------------------------


def random_cases():
    """How many of the random cases end, keep their volume, and are corrected much."""
    rows = list(rows_of("random").values())
    errors = [float(row["relative_volume_max"]) for row in rows]
    sums = [float(row["volume_correction"]) for row in rows]
    ended = sum(not row["failure"] and row["finite"] == "True" for row in rows)
    resting = sum(row["rest_since"] not in ("", "nan") for row in rows)
    return bullets(
        [
            f"{ended} of {len(rows)} random cases end by themselves with finite fields; {resting} are at rest by "
            "1.5 s.",
            f"The volume is right to {rounded(VOLUME, 1, 100)} % in {sum(error <= VOLUME for error in errors)} of "
            f"them, to {rounded(max(errors), 1, 100)} % in all.",
            f"The corrections of the volume sum to {rounded(float(np.median(sums)), 1, 100)} % (median), to more "
            f"than {rounded(SUM, 0, 100)} % in {sum(total > SUM for total in sums)}.",
        ]
    ) + made("random")
