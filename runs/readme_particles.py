"""Tables of the particle laboratory for its README: the baseline, thin layers, shape and volume, closures."""

from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, require, rounded, signed, span, table
from runs.table import RUNS, read_table

FOLDER = "particle_laboratory"
MM = 1000
MISSING = "–"
SYMBOLS = {"kappa_0": "κ₀", ", looser": " and 0.044 looser"}
SHAPES = (  # variants of shape.csv that are shown
    "without",
    "thin_layer 2.31 d",
    "thin_layer 4 d",
    "dilatancy, K = 4",
    "thin_layer, dilatancy K = 4",
    "thin_layer 4 d, dilatancy K = 4",
)
LEVEL = "b01"  # of SHAPED, at 0 deg
SHAPED = {
    LEVEL: "0°, `b01`",
    "control_10deg": "10°",
    "control_16deg": "16°",
    "b03": "16°, frictionless walls, `b03`",
    "b09": "16°, `b09`",
    "b02": "22°, `b02`",
    "b06": "22°, `b06`",
}
STEEPER = tuple(name for name in SHAPED if name != LEVEL)
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


def made(*names):
    """The line that names the solver of tables of the study."""
    return solver_line(*(f"{FOLDER}/{name}" for name in names))


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
    chute, longer, *dilating = SHAPES[1], SHAPES[2], "dilatancy, K = 2", "dilatancy, K = 4"
    walls = ("back wall: 0", "back wall: 1", "back wall: no slip")
    settled = ("hysteresis 0.03", "hysteresis 0.06")
    swollen = [rows[name, of] for name in SHAPED for of in dilating]
    excess = [float(row["volume_model"]) / float(row["volume_grains"]) - 1.0 for row in swollen]
    require(min(excess) > 0.0, "dilatancy gives a largest volume that is too large")
    require(min(moved(rows, dilating)) > 0.0, "dilatancy lengthens the front")
    back, middle = "at_back_wall", "before_middle"
    wider = [
        gap(rows, name, of, middle) > gap(rows, name, "without", middle)
        for name in SHAPED
        for of in dilating
    ]
    return bullets(
        [
            f"The gap without any effect is {left(rows, 'without', back)} mm at the back wall and "
            f"{left(rows, 'without', middle)} mm in front of the middle; the smallest is that at "
            f"{slopes(min, lambda name, of: gap(rows, name, 'without', of))}.",
            f"`thin_layer` with 2.31 d closes {closed(rows, chute, back)} of it at the back wall and "
            f"{closed(rows, chute, middle)} in front of the middle, most at "
            f"{slopes(max, lambda name, of: share(rows, chute, of, name))}. It leaves "
            f"{left(rows, chute, back)} mm and {left(rows, chute, middle)} mm.",
            f"With 4 d it closes {closed(rows, longer, back)} and {closed(rows, longer, middle)}, and leaves "
            f"{left(rows, longer, back)} mm and {left(rows, longer, middle)} mm.",
            f"Dilatancy alone closes {closed(rows, dilating[0], back, STEEPER)} (K = 2) and "
            f"{closed(rows, dilating[1], back, STEEPER)} (K = 4) of the gap at the back wall from 10° on, and "
            f"{closed(rows, dilating[0], back, (LEVEL,))} and {closed(rows, dilating[1], back, (LEVEL,))} at 0°. It "
            f"widens that in front of the middle in {sum(wider)} of {len(wider)} runs.",
            f"Dilatancy gives a largest volume that is {shares(excess)} too large. It lengthens the front by "
            f"{span(moved(rows, dilating), rounded)} mm. At the end the volume of the model differs from that "
            f"at the start by {ends(swollen, 'model')} %, that of the grains by {ends(swollen, 'grains')} %.",
            f"Back walls from frictionless to no slip move the front by {greatest(moved(rows, walls))} mm at most, "
            f"hysteresis by {greatest(moved(rows, settled))} mm.",
        ]
    )


def left(rows, variant, column):
    """Range of what a variant leaves of a gap, mm."""
    return span([float(rows[name, variant][column]) for name in SHAPED], lambda of: signed(of, 1))


def ends(rows, of):
    """Range of the last change of the volume, %."""
    return span([float(row[f"volume_{of}_end"]) for row in rows], lambda value: signed(value, 1))


def closed(rows, variant, column, names=tuple(SHAPED)):
    """Which share of a gap a variant closes, over the experiments."""
    return shares([share(rows, variant, column, name) for name in names])


def share(rows, variant, column, name):
    """Which share of the gap of an experiment a variant closes."""
    return 1.0 - float(rows[name, variant][column]) / float(rows[name, "without"][column])


def gap(rows, name, variant, column):
    """Size of the gap of an experiment, mm."""
    return abs(float(rows[name, variant][column]))


def slopes(chosen, size):
    """Slope at which `size(experiment, column)` is least or largest (`chosen`); both columns if they differ."""
    columns = {"at_back_wall": "at the back wall", "before_middle": "in front of the middle"}
    found = {}
    for column, words in columns.items():
        name = chosen(SHAPED, key=lambda name, column=column: size(name, column))
        found.setdefault(SHAPED[name].partition(",")[0], []).append(words)
    if len(found) == 1:
        return next(iter(found))
    return " and ".join(f"{slope} ({', '.join(words)})" for slope, words in found.items())


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
