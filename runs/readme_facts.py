"""Tables of the printed facts, the beds and the grids of the paper's channel, for the README of that study."""

import math
from itertools import pairwise

from runs.paper_facts.sets import LENGTHS, NEAREST_SETS, WIDTH
from runs.paper_facts.study import BED_SLOPES, GRIDS, WAY_GRIDS, WAYS
from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, change, rounded, signed, table
from runs.table import RUNS, read_table

FOLDER = "paper_facts"
FRONTS = ("runout_10mm", "runout_5mm", "runout_1mm")
LENGTH = f"{LENGTHS[1]:g}"
ROUGH = f"no slip; L = {LENGTH} d"
SHOWN = (  # sets of facts_sets.csv that the README has: friction, the rest of the name
    ("0.38, 0.64", "slip; sink"),
    ("0.38, 0.64", f"slip; L = {LENGTH} d; sink"),
    ("0.38, 0.64", "no slip; sink"),
    ("0.38, 0.64", f"{ROUGH}; sink"),
    ("0.38, 0.64", "no slip; L = 2.31 d; sink"),
    ("0.38, 0.64", f"{ROUGH}; dilatancy from 0.62"),
    ("0.38, 0.64", f"{ROUGH}; gate 0.8 m/s, rubs"),
    ("0.38, 0.64", f"{ROUGH}; dilatancy from 0.62, gate 0.8 m/s"),
    ("0.38, 0.64", f"{ROUGH}; sink of 0.25"),
    ("0.38, 0.64", f"{ROUGH}; dilatancy from 0.62, sink of 0.25"),
    ("0.40, 0.66", f"{ROUGH}; dilatancy from 0.62"),
    ("0.44, 0.69", "no slip; sink"),
    ("0.44, 0.69", f"{ROUGH}; sink"),
    ("0.44, 0.69", f"{ROUGH}; dilatancy from 0.62"),
    ("0.44, 0.69", "slip; L = 4 d; sink"),
    ("0.48, 0.73", "slip; sink"),
    ("0.48, 0.73", f"slip; L = {LENGTH} d; sink"),
    ("0.48, 0.73", f"{ROUGH}; sink"),
)
FACTS = {  # name in the table: words
    "runout0": "runout 0°",
    "height0": "height 0°",
    "10": "10°",
    "22": "22°",
    "still22": "gain",
    "rest22": "rest",
}
BEDS = {  # words in the table: words here
    "Coulomb": "Coulomb",
    "Coulomb, thin_layer": "Coulomb, `thin_layer`",
    "no slip": "no slip",
    "rough: no slip, thin_layer": "rough: no slip, `thin_layer`",
}
WAY_WORDS = {  # of `WAYS`: words here
    "tolerance 1e-4": "sweeps to 1e-4 in place of 1e-3",
    "no film rule": "without the film rule",
    "0.44, 0.69": "0.44, 0.69, which comes to rest",
}
ASKED = (((6, 3), 2.5), ((3, 2), 0.7))  # cells in mm from, to: change of a runout, %
READ = {"runout_10mm": "10 mm", "runout_5mm": "5 mm", "runout_1mm": "1 mm", "x_99": "x₉₉"}


def rows_by_name(name, column="name"):
    """{name: row} of a table of the study."""
    return {row[column]: row for row in read_table(RUNS / FOLDER / name)}


def made(*names):
    """The line that names the solver of tables of the study."""
    return solver_line(*(f"{FOLDER}/{name}" for name in names))


# -- facts ---------------------------------------------------------------------------------------


def facts():
    """Some of the sets against the printed facts."""
    found = rows_by_name("facts_sets.csv", "set")
    names = [f"{friction}; {rest}" for friction, rest in SHOWN]
    return table(FACTS_HEADING, [fact_cells(found[name]) for name in names]) + made(
        "facts_sets.csv"
    )


def finer():
    """The nearest sets on finer cells."""
    found = rows_by_name("finer_sets.csv", "set")
    return table(FACTS_HEADING, [fact_cells(found[name]) for name in NEAREST_SETS]) + made(
        "finer_sets.csv"
    )


FACTS_HEADING = (
    "µ1, µ2; bed; additions",
    "0°: 1, 5 mm",
    "height 0°",
    "10°: 1 mm",
    "22°: 1, 5 mm",
    "in motion at 1.76 s",
    "gain after",
    "missed, front at 1 mm",
)


def fact_cells(row):
    """Cells of a set."""
    met = row["met_1mm"].split()
    return (
        row["set"].removesuffix("; sink"),
        f"{rounded(row['runout_1mm_0'], 3)}, {rounded(row['runout_5mm_0'], 3)}",
        rounded(row["height_0"], 3),
        rounded(row["runout_1mm_10"], 3),
        f"{rounded(row['runout_1mm_22'], 2)}, {rounded(row['runout_5mm_22'], 2)}",
        rounded(row["flowing_22"], 2),
        f"{rounded(row['gain_22'], 1, 100)} %",
        ", ".join(words for name, words in FACTS.items() if name not in met) or "none",
    )


# -- beds ----------------------------------------------------------------------------------------


def beds():
    """The beds side by side at all slopes."""
    rows = rows_by_name("beds.csv")
    lines = []
    for friction in ("0.48, 0.73", "0.38, 0.64"):
        for width, wide in ((WIDTH, "10 cm"), (math.inf, "∞")):
            for of, words in BEDS.items():
                name = f"{friction}; {of}; w = {width:g} m"
                cells = (bed_cell(rows[f"{name}; {slope:g} deg"]) for slope in BED_SLOPES)
                lines.append((friction, wide, words, *cells))
    heading = ("µ1, µ2", "w", "bed", *(f"{slope:g}°" for slope in BED_SLOPES))
    return table(heading, lines) + made("beds.csv")


def bed_cell(row):
    """Runouts and the share in motion."""
    runouts = " / ".join(rounded(row[front], 2) for front in FRONTS)
    return f"{runouts} ({rounded(row['flowing_1.76s'], 2)})"


# -- grid ----------------------------------------------------------------------------------------


def grid():
    """22 deg on a rough bed on finer and finer grids, with and without thin_layer, and in shorter steps."""
    rows = rows_by_name("grid.csv")
    lines = []
    for size in GRIDS:
        cells = f"{1e3 * size:g} mm"
        thin, plain = rows[f"{ROUGH}; {cells}"], rows[f"no slip; {cells}"]
        both = (f"{rounded(thin[name], 3)} ({rounded(plain[name], 3)})" for name in READ)
        lines.append((cells, *both, f"{rounded(thin['peak_front_velocity'], 2)} m/s"))
    for name, row in rows.items():
        if name.endswith(" ms"):
            cells, step = name.split("; ")[-2:]
            values = (rounded(row[of], 3) for of in READ)
            lines.append(
                (
                    f"{cells}, steps of {step}",
                    *values,
                    f"{rounded(row['peak_front_velocity'], 2)} m/s",
                )
            )
    heading = ("cells", *READ.values(), "peak velocity of the front")
    return table(heading, lines) + made("grid.csv")


def grid_says():
    """How far the numbers move between grids and in shorter steps, and whether that is what was asked."""
    rows = rows_by_name("grid.csv")
    by_cells = {size: rows[f"{ROUGH}; {size} mm"] for size in (10, 8, 6, 4, 3, 2)}
    lines = []
    for (coarse, fine), asked in ASKED:
        told = between(by_cells[coarse], by_cells[fine], READ)
        missed = [
            READ[name]
            for name in READ
            if abs(change(by_cells[coarse][name], by_cells[fine][name])) > asked
        ]
        verdict = f"not met at {', '.join(missed)}" if missed else "met by all four"
        lines.append(
            f"From {coarse} to {fine} mm cells: {told}. At most {asked:g} % was asked for: {verdict}."
        )
    steps = [row for name, row in rows.items() if name.endswith(" ms")]
    of_steps = [change(by_cells[6][name], row[name]) for row in steps for name in READ]
    lines.append(
        f"Shorter time steps change no number by more than {rounded(max(map(abs, of_steps)), 2)} %."
    )
    apart = {
        size: max(abs(float(row[name]) - float(rows[f"no slip; {size} mm"][name])) for name in READ)
        for size, row in by_cells.items()
    }
    coarse = {size: rounded(apart.pop(size), 1, 1000) for size in (10, 8)}
    lines.append(
        f"Without `thin_layer` the numbers are the same to {rounded(max(apart.values()), 1, 1000)} mm on cells of 6 to "
        f"2 mm, to {coarse[8]} mm on 8 mm and to {coarse[10]} mm on 10 mm."
    )
    reference = {row["name"]: row for row in read_table(RUNS / "acceptance" / "grid.csv")}
    named = {"runout_10mm": "10 mm", "runout": "5 mm", "runout_1mm": "1 mm", "x_99": "x₉₉"}
    lines.append(
        "The tongue that slides on a bed with Coulomb friction (0.48, 0.73), from 6 to 3 mm cells: "
        f"{between(reference['dx6mm'], reference['dx3mm'], named)}."
    )
    return bullets(lines)


def grid_ways():
    """The same runs in other ways, and how far each moves from 3 to 2 mm cells."""
    rows = rows_by_name("grid.csv")
    ways = {"as above": "", **{words: f"; {words}" for words in WAYS}}
    lines = []
    for words, end in ways.items():
        of = [rows[f"{ROUGH}; {1e3 * size:g} mm{end}"] for size in WAY_GRIDS]
        values = (", ".join(rounded(row[name], 3) for row in of) for name in READ)
        moved = ", ".join(signed(change(of[-2][name], of[-1][name]), 2) for name in READ)
        still = ", ".join(rounded(row["gain_1mm_after_1.76s"], 0, 1000) for row in of)
        lines.append((WAY_WORDS.get(words, words), *values, f"{moved} %", f"{still} mm"))
    heading = ("way", *READ.values(), "from 3 to 2 mm", "gain of the 1 mm front after 1.76 s")
    return table(heading, lines) + made("grid.csv")


def grid_rises():
    """How the 1 mm front moves from grid to grid: no order, and the change over the whole range."""
    rows = rows_by_name("grid.csv")
    of = [rows[f"{ROUGH}; {size} mm"] for size in (6, 4, 3, 2)]
    steps = [1000.0 * (float(b["runout_1mm"]) - float(a["runout_1mm"])) for a, b in pairwise(of)]
    told = ", ".join(signed(step, 1) for step in steps)
    return bullets(
        [
            f"The 1 mm front moves by {told} mm from 6 to 4, 4 to 3, 3 to 2 mm. "
            "It has no order on these grids, and it turns at 6 mm, which makes the change from 6 to 3 mm small.",
            f"From 6 to 2 mm cells: {between(of[0], of[-1], READ)}.",
        ]
    )


def between(coarse, fine, names):
    """Change of the numbers of a row in %, each named."""
    return ", ".join(
        f"{words} {signed(change(coarse[name], fine[name]), 2)} %" for name, words in names.items()
    )
