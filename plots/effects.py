"""One picture for each effect: front and final profile with and without it, at three slopes.

python -m plots.effects [FOLDER OF THE TABLES]
"""

import sys
from pathlib import Path

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE, OBSERVATION, PHYSICAL
from plots.paper_style import FIGURES, key, panels, write_picture
from runs.table import CURVES, RUNS, as_line, read_table

HERE = RUNS / "effects"  # the tables
NUMBERS = "effects.csv"
MEMBER = ("effect", "variant", "strength", "slope_deg")
BASELINE = "none"
COLOURS = (BLUE, ORANGE, GREEN)  # of the variants
LINES = {"weak": ":", "middle": "--", "strong": "-"}  # of the strengths
WITHOUT = {"color": "0.75", "lw": 3.0}
ABOUT = {
    PHYSICAL: "Effect {name}: front against time (above) and final profile (below) of collapses with it",
    OBSERVATION: "Effect {name}, of the observation: the front that is measured (above) and the final "
    "profile (below), after it",
    NUISANCE: "Error of the set-up {name}: the front that is measured (above) and the final profile "
    "(below), with it",
}
CAPTION = """
{about} and without (grey), at 0, 16 and 22 deg, w = 10 cm, no other effect; front at 5 mm thickness. Strengths are
quantiles {quantiles} of the physical prior (SI units, degrees): {values}. Cells {cell:g} mm. Numbers drawn:
runs/effects/effects.csv, curves.csv.
"""


def draw(numbers, curves, name):
    """The figure of one effect.

    Parameters
    ----------
    numbers : list of dict
        Rows of the effect in `effects.csv`.
    curves : dict
        {(effect, variant, strength, slope, quantity): Line}
    name : str
    """
    variants, slopes = (
        list(dict.fromkeys(row[n] for row in numbers)) for n in ("variant", "slope_deg")
    )
    figure, axes = panels(2, len(slopes), (10.5, 6.2))
    for column, slope in enumerate(slopes):
        for panel, quantity in zip(axes[:, column], ("front_m", "thickness_m"), strict=True):
            draw_line(panel, curves.get((BASELINE, "", "", slope, quantity)), WITHOUT)
            for variant, colour in zip(variants, COLOURS, strict=False):
                for strength, line in LINES.items():
                    found = curves.get((name, variant, strength, slope, quantity))
                    draw_line(panel, found, {"color": colour, "ls": line, "lw": 1.3})
        axes[0, column].set(title=f"{slope}°", xlabel="time (s)", xlim=(0.0, None))
        axes[1, column].set(xlabel="distance from the back wall (m)", xlim=(0.0, None))
    axes[0, 0].set_ylabel("front (m)")
    axes[1, 0].set_ylabel("thickness (m)")
    lines = {words: {"color": "black", "ls": line} for words, line in strength_names(numbers)}
    key(axes[0, 0], {"without": WITHOUT} | lines, loc="lower right")
    if len(variants) > 1:
        colours = {variant: {"color": c} for variant, c in zip(variants, COLOURS, strict=False)}
        key(axes[1, 0], colours, loc="upper right")
    return figure


def draw_line(panel, line, style):
    """A curve, if its run is there."""
    if line is not None:
        panel.plot(line.at, line.values, **style)


def strength_names(numbers):
    """Name and line of each strength; with its value where that is a single one."""
    for row in first_slope(numbers)[: len(LINES)]:
        alone = row["variant"] == "" and " " not in row["parameters"]
        value = f": {row['parameters'].replace('=', ' = ')}" if alone else ""
        yield row["strength"] + value, LINES[row["strength"]]


def first_slope(numbers):
    """The rows of the first slope."""
    return [row for row in numbers if row["slope_deg"] == numbers[0]["slope_deg"]]


def caption(numbers, name):
    """What the picture shows, with the values of the parameters."""
    values, quantiles = [], {}
    for row in first_slope(numbers):
        which = f"{row['variant']} {row['strength']}".strip()
        values.append(f"{which} {row['parameters'].replace(' ', ', ')}")
        quantiles[row["strength"]] = row["quantile"]
    return CAPTION.format(
        about=ABOUT[CATALOGUE[name].kind].format(name=name),
        quantiles=", ".join(quantiles.values()),
        values="; ".join(values),
        cell=float(numbers[0]["cell_size_mm"]),
    )


def main(tables=HERE, figures=FIGURES):
    """Draw every effect that is in the tables."""
    numbers = read_table(tables / NUMBERS)
    curves = {
        (*(row[name] for name in MEMBER), row["quantity"]): as_line(row)
        for row in read_table(tables / CURVES)
    }
    for name in CATALOGUE:
        found = [row for row in numbers if row["effect"] == name]
        if found:
            picture = draw(found, curves, name)
            write_picture(picture, f"effects_{name}", caption(found, name), figures)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
