"""Tables of the particle laboratory for its README: the baseline, thin layers, shape and volume, closures."""

from runs.particle_laboratory.thin_layers import (
    FROM_CHUTE,
    FRONT_ASKED,
    FRONT_LIMIT,
    LENGTHS,
    TEACHER,
    THICKNESS_ASKED,
    THICKNESS_LIMIT,
    VARIANTS,
)
from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, rounded, signed, span, table
from runs.table import RUNS, read_table

FOLDER = "particle_laboratory"
MM = 1000
MISSING = "–"
MORE = {"b03": ", frictionless walls"}  # what a reference has beside its slope
NOTES = {f"thickness, L = {FROM_CHUTE:g} d": ", of the chute"}
SYMBOLS = {"kappa_0": "κ₀", ", looser": " and 0.044 looser"}
SHAPES = (  # variants of shape.csv that are shown
    "without",
    "thin_layer 2.31 d",
    "dilatancy, K = 2",
    "dilatancy, K = 4",
    "hysteresis 0.06",
    "back wall: no slip",
    "thin_layer, dilatancy K = 4",
    "thin_layer, dilatancy K = 4, hysteresis 0.06",
)
SHAPED = {"control_10deg": "10°", "control_16deg": "16°", "b09": "16°, `b09`"}
COHESIVE = {"b10": "16°, cohesive, `b10`"}
PACKED = {
    "b11": "16°, dense, `b11`",
    "b05": "22°, dense, slow gate, `b05`",
    "b08": "16°, loose, `b08`",
}
COLUMNS = {  # of shape.csv and closures.csv: heading
    "front": "front",
    "thickness_rms": "thickness, rms",
    "at_back_wall": "at the back wall",
    "before_middle": "in front of the middle",
}


def rows_of(name):
    """The rows of a table of the study."""
    return read_table(RUNS / FOLDER / name)


def made(name):
    """The line that names the solver of a table of the study."""
    return solver_line(f"{FOLDER}/{name}")


# -- the baseline --------------------------------------------------------------------------------


def validation():
    """The controls beside the untuned baseline."""
    lines = [
        (
            f"`{row['experiment']}`",
            f"{rounded(row['cell_size'], scale=MM)} mm",
            f"{rounded(row['front_measured'], 3)} m",
            f"{rounded(row['front_simulated'], 3)} m",
            f"{signed(row['front_difference'], 1, MM)} mm",
            f"{rounded(row['final_thickness_rms'], 1, MM)} mm",
        )
        for row in rows_of("validation.csv")
    ]
    heading = ("control", "cells", "front at rest, grains", "model", "model less grains")
    return table((*heading, "final thickness, rms"), lines) + made("validation.csv")


# -- thin layers ---------------------------------------------------------------------------------


def by_size(rows):
    """{cell size: its rows}, the coarser first."""
    found = {}
    for row in rows:
        found.setdefault(row["cell_size"], []).append(row)
    return found


def thin_layers():
    """Every reference with every length of thin layers, a table for each cell size."""
    text = ""
    for size, rows in by_size(rows_of("thin_layers.csv")).items():
        cells = {(row["experiment"], row["variant"]): both(row) for row in rows}
        slopes = {row["experiment"]: row["slope_deg"] for row in rows}
        lines = [
            (f"`{name}`, {slope}°{MORE.get(name, '')}", *(cells[name, of] for of in VARIANTS))
            for name, slope in slopes.items()
        ]
        heading = ("reference", *(of.removeprefix("thickness, ") for of in VARIANTS))
        text += f"{rounded(size, scale=MM)} mm cells:\n\n{table(heading, lines)}\n"
    return text.removesuffix("\n") + made("thin_layers.csv")


def both(row, digits=0):
    """Front at rest less measured and final thickness of a row, mm."""
    front = signed(row["front_difference"], digits, MM)
    return f"{front}, {rounded(row['final_thickness_rms'], 1, MM)}"


def chosen(rows):
    """The variant that the rule chooses, None if no length passes."""
    teaching = {row["variant"]: row for row in rows if row["experiment"] == TEACHER}
    for length in LENGTHS:
        variant = f"thickness, L = {length:g} d"
        if within(teaching[variant], FRONT_LIMIT, THICKNESS_LIMIT):
            return variant
    return None


def within(row, front, thickness):
    """Whether a row lies within limits of the front at rest and of the final thickness, m."""
    return (
        abs(float(row["front_difference"])) <= front
        and float(row["final_thickness_rms"]) <= thickness
    )


def rule():
    """All lengths on each cell size: the control of the rule, what it chooses, and the reach over all references."""
    lines = []
    for size, rows in by_size(rows_of("thin_layers.csv")).items():
        picked = chosen(rows)
        for variant in (of for of in VARIANTS if not of.startswith("nonlocal")):
            of = [row for row in rows if row["variant"] == variant]
            taught = next(f"{both(row, 1)} rms" for row in of if row["experiment"] == TEACHER)
            words = variant.removeprefix("thickness, ") + NOTES.get(variant, "")
            choice = ": chosen" if variant == picked else ""
            lines.append((f"{rounded(size, scale=MM)} mm", words, taught + choice, *reach(of)))
    asked = f"{rounded(FRONT_ASKED, scale=MM)} mm and {rounded(THICKNESS_ASKED, 1, MM)} mm rms"
    heading = ("cells", "`thin_layer`", "the 10° control (mm)", "front at rest, all references")
    heading = (*heading, "final thickness, rms", f"within {asked}")
    return table(heading, lines) + made("thin_layers.csv")


def reach(rows):
    """Range of fronts and of thicknesses, and the number of references within what was asked."""
    fronts = [float(row["front_difference"]) for row in rows]
    heights = [float(row["final_thickness_rms"]) for row in rows]
    met = sum(within(row, FRONT_ASKED, THICKNESS_ASKED) for row in rows)
    return (
        f"{span(fronts, lambda value: signed(value, 1, MM))} mm",
        f"{span(heights, lambda value: rounded(value, 1, MM))} mm",
        f"{met} of {len(rows)}",
    )


# -- shape and volume ----------------------------------------------------------------------------


def shape():
    """Which effect closes the gap of shape and volume."""
    rows = [row for row in rows_of("shape.csv") if row["variant"] in SHAPES]
    return beside_grains(rows, SHAPED) + made("shape.csv")


def beside_grains(rows, experiments):
    """A table of variants of some experiments: lengths less those of the grains, volumes of model and grains.

    Parameters
    ----------
    rows : list of dict
        Of shape.csv or closures.csv.
    experiments : dict
        Name in the table -> words.
    """
    lines = []
    for name, words in experiments.items():
        of = [row for row in rows if row["experiment"] == name]
        lines.append((words, "the grains", *[MISSING] * len(COLUMNS), *volumes(of[0], "grains")))
        lines += [
            (
                words,
                named(row["variant"]),
                *(length(row, column) for column in COLUMNS),
                *volumes(row, "model"),
            )
            for row in of
        ]
    heading = ("collapse", "model", *COLUMNS.values(), "largest volume", "last")
    return table(heading, lines)


def length(row, column):
    """A length of a row, mm: with its sign where it is model less grains."""
    show = rounded if column == "thickness_rms" else signed
    return f"{show(row[column], 1)} mm"


def volumes(row, of):
    """Largest and last change of the volume of the grains or the model, %."""
    return tuple(f"{signed(row[f'volume_{of}{end}'], 1)} %" for end in ("", "_end"))


def named(variant):
    """A variant as the text has its symbols."""
    for old, new in SYMBOLS.items():
        variant = variant.replace(old, new)
    return variant


def shape_says():
    """What each effect does to front, shape and volume, read off the table."""
    rows = {(row["experiment"], row["variant"]): row for row in rows_of("shape.csv")}
    thin, *dilating = "thin_layer 2.31 d", "dilatancy, K = 2", "dilatancy, K = 4"
    walls = ("back wall: 0", "back wall: 1", "back wall: no slip")
    settled = ("hysteresis 0.03", "hysteresis 0.06")
    swollen = [rows[name, of] for name in SHAPED for of in dilating]
    excess = [float(row["volume_model"]) / float(row["volume_grains"]) - 1.0 for row in swollen]
    last = span([float(row["volume_model_end"]) for row in swollen], lambda of: rounded(of, 1))
    back, middle = "at_back_wall", "before_middle"
    return bullets(
        [
            f"`thin_layer` (2.31 d) closes {closed(rows, thin, back)} of the gap at the back wall and "
            f"{closed(rows, thin, middle)} of that in front of the middle.",
            f"Dilatancy alone closes {closed(rows, dilating[0], back)} (K = 2) and "
            f"{closed(rows, dilating[1], back)} (K = 4) of the gap at the back wall. It widens that in front of the "
            "middle.",
            f"Dilatancy gives a largest volume that is {shares(excess)} too large. It lengthens the front by "
            f"{span(moved(rows, dilating), rounded)} mm. At the end {last} % of volume remain.",
            f"Back walls from frictionless to no slip move the front by {greatest(moved(rows, walls))} mm at most, "
            f"hysteresis by {greatest(moved(rows, settled))} mm.",
        ]
    )


def closed(rows, variant, column):
    """Which share of a gap a variant closes, over the experiments."""
    gaps = [[float(rows[name, of][column]) for of in (variant, "without")] for name in SHAPED]
    return shares([1.0 - found / before for found, before in gaps])


def moved(rows, variants):
    """By how much variants move the front, mm."""
    return [
        float(rows[name, variant]["front"]) - float(rows[name, "without"]["front"])
        for name in SHAPED
        for variant in variants
    ]


def shares(values):
    """A range of shares in %."""
    return f"{span(values, lambda value: rounded(value, 0, 100))} %"


def greatest(values):
    """The greatest size of some numbers, with one decimal."""
    return rounded(max(map(abs, values)), 1)


# -- closures ------------------------------------------------------------------------------------


def cohesion():
    """Cohesion beside the case that hides it."""
    return beside_grains(rows_of("closures.csv"), COHESIVE) + made("closures.csv")


def packings():
    """Dilatancy beside the dense and the loose packings."""
    return beside_grains(rows_of("closures.csv"), PACKED) + made("closures.csv")
