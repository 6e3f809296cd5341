"""Aluminium bars and the steady front beside the measurements, for the README of the comparison."""

from runs.readme_stamps import solver_line
from runs.readme_tables import bullets, require, rounded, signed, span, table
from runs.table import RUNS, read_table

BARS, FRONT = "comparison/bars.csv", "comparison/steady_front.csv"
EFFECTS = {"without": "without", "thickness": "`thin_layer`", "nonlocal": "`thin_layer`, nonlocal"}
SHOWN = {  # profile and time of steady_front.csv: words
    ("beads, h_inf=11.6mm", ""): "beads, 11.6 mm",
    ("beads, h_inf=14.9mm", ""): "beads, 14.9 mm",
    ("beads, h_inf=4.5mm", ""): "beads, 4.5 mm",
    ("model, without, 8 cells", "2.25"): "model, 2.25 s",
    ("model, thin_layer, 8 cells", "2.25"): "model with `thin_layer` (1.14 d), 2.25 s",
    ("dh/dx = tan(slope) - mu", ""): "dh/dx = tan θ − µ",
}
MISSING = "–"
PLACES = tuple(f"h_at_{layers}" for layers in (2, 4, 6, 8, 10, 15, 20, 30, 40))


# -- aluminium bars ------------------------------------------------------------------------------


def bars_rows():
    """The row of the experiment, and {(law, effect): row} of the model."""
    measured, *rows = read_table(RUNS / BARS)
    return measured, {(row["law"], row["thin_layer"]): row for row in rows}


def bars():
    """Deposit, front and failure line of every law, with and without thin_layer."""
    measured, rows = bars_rows()
    lines = [("measured", "", f"{rounded(measured['front'])} mm", "", "", "")]
    for (law, effect), row in rows.items():
        lines.append(
            (
                law,
                EFFECTS[effect],
                f"{rounded(row['front'])} mm",
                f"{signed(behind(row, measured), 1)} mm",
                f"{rounded(row['rms_deposit'], 1)} mm",
                f"{rounded(row['rms_failure_line'], 1)} mm",
            )
        )
    heading = (
        "law: µ₂, I₀",
        "`thin_layer`",
        "front",
        "less measured",
        "deposit, rms",
        "failure line, rms",
    )
    return table(heading, lines) + solver_line(BARS)


def behind(row, measured):
    """Front of a row less that measured, mm."""
    return float(row["front"]) - float(measured["front"])


def bars_say():
    """What thin_layer changes of the bars, with the laws whose friction rises with the shear rate and without."""
    _, rows = bars_rows()
    laws = list(dict.fromkeys(law for law, _ in rows))
    groups = {
        "the laws µ(I)": [law for law in laws if law.startswith("mu(I)")],
        "Drucker–Prager": [law for law in laws if not law.startswith("mu(I)")],
    }
    return bullets(
        [
            f"{words} moves the front of {of} by {moved(rows, found, effect, 'front', 1)} mm and the difference of the "
            f"deposit by {moved(rows, found, effect, 'rms_deposit', 2)} mm rms."
            for of, found in groups.items()
            for effect, words in EFFECTS.items()
            if effect != "without"
        ]
    )


def moved(rows, laws, effect, column, digits):
    """By how much an effect moves a number of some laws."""
    by = [float(rows[law, effect][column]) - float(rows[law, "without"][column]) for law in laws]
    return span([round(value, digits) for value in by], lambda value: signed(value, digits))


# -- steady front --------------------------------------------------------------------------------


def steady_front():
    """Thickness behind the front of beads, of the model and of the theory, in layers."""
    rows = {(row["profile"], row["time"]): row for row in read_table(RUNS / FRONT)}
    places = [name for name in next(iter(rows.values())) if name.startswith("h_at_")]
    lines = [
        (words, *(rounded(rows[of][place], 2) if rows[of][place] else MISSING for place in places))
        for of, words in SHOWN.items()
    ]
    heading = ("behind the front, layers", *(place.removeprefix("h_at_") for place in places))
    return table(heading, lines) + solver_line(FRONT)


def steady_front_says():
    """How far the model lies outside of the measured fronts, how it moves in time, what thin_layer changes."""
    rows = read_table(RUNS / FRONT)
    beads = [row for row in rows if row["profile"].startswith("beads")]
    runs = {}
    for row in rows:
        if row["profile"].startswith("model"):
            runs.setdefault(row["profile"].split(", ")[1], {})[row["time"]] = row
    of_runs = [row for run in runs.values() for row in run.values()]
    near, middle, far = PLACES[:1], PLACES[1:7], PLACES[7:]
    times = list(next(iter(runs.values())))
    thick, thin = (max(outside(of_runs, beads, far, above)) for above in (True, False))
    require(thin > thick, "30 and 40 layers behind the front the model is too thin")
    nearest = outside(of_runs, beads, near, True)
    require(min(nearest) > 0.0, "2 layers behind the front the model is too thick")
    return bullets(
        [
            f"From 4 to 20 layers behind the front the model lies at most {two(worst(of_runs, beads, middle))} of a "
            f"layer outside of the range of the {len(beads)} measured fronts, at {', '.join(times[:-1])} and "
            f"{times[-1]} s. At 2 layers it is {span(nearest, two)} too thick, with {cells(of_runs)} cells over the "
            "layer.",
            f"At 30 and 40 layers it is up to {two(thin)} too thin: the layer of 1 m drains at its rear.",
            changes_in_time(runs, (*near, *middle), far[-1]),
            f"`thin_layer` changes the thickness by at most {two(by_thin_layer(runs))} of a layer.",
        ]
    )


def changes_in_time(runs, places, last):
    """By how much the thickness at the same distance behind the front changes over the stored times."""
    by = [differences(run.values()) for run in runs.values()]
    without, with_it = (span([found[at] for at in places], two) for found in by)
    first, *_, end = next(iter(runs.values()))
    return (
        f"From {first} to {end} s the thickness at the same distance behind the front changes by {without} of a "
        f"layer without `thin_layer` and by {with_it} with it up to {places[-1].removeprefix('h_at_')} layers, at "
        f"{last.removeprefix('h_at_')} layers by {span([found[last] for found in by], two)}."
    )


def by_thin_layer(runs):
    """The largest difference in thickness between the runs at one time and place, in layers."""
    both = [[run[time] for run in runs.values()] for time in next(iter(runs.values()))]
    return max(max(differences(pair).values()) for pair in both)


def cells(rows):
    """Cells over the layer, as the profiles of some runs name them."""
    found = {row["profile"].rpartition(", ")[2].removesuffix(" cells") for row in rows}
    return " and ".join(sorted(found, key=int))


def two(value):
    """A thickness in layers, two decimals."""
    return rounded(value, 2)


def at_place(rows, place):
    """Thickness of some rows at a place, in layers; rows without one there are left out."""
    return [float(row[place]) for row in rows if row[place]]


def outside(rows, beads, places, above):
    """How far rows lie above the thickest of the beads, or below the thinnest; one number for each row and place."""
    found = []
    for place in places:
        low, high = min(at_place(beads, place)), max(at_place(beads, place))
        found += [
            max(value - high if above else low - value, 0.0) for value in at_place(rows, place)
        ]
    return found


def worst(rows, beads, places):
    """The largest distance from the range of the beads, on either side."""
    return max(max(outside(rows, beads, places, above)) for above in (True, False))


def differences(rows):
    """{place: largest less least thickness of some rows}."""
    rows = list(rows)
    return {place: max(found) - min(found) for place in PLACES if (found := at_place(rows, place))}
