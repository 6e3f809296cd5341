"""Runouts on the bed of the paper and on a rough bed, read at three thicknesses.

python -m plots.paper_beds
"""

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import WIDTH_NAME, key, main, panels, save
from runs.paper.beds import BEDS, WORDS
from runs.paper.cases import SLOPES
from runs.table import MissingRun, Tables

FRONTS = {10: GREEN, 5: BLUE, 1: ORANGE}  # mm
LINES = dict(zip(BEDS, ("-", "--", ":"), strict=True))
FACTS = {0: (0.475, 0.025, False), 10: (0.70, 0.05, True), 22: (1.60, 0.10, True)}  # m
CAPTION = """
Runout against slope, µ(I) with the constants of Table I, with (w = 10 cm) and without lateral friction: on the bed
of the paper, on which grains slide with µ_b = µ1, and on a rough bed, without and with thin_layer (1.65 d). Colours:
thickness at which the front is read. Bars: grid uncertainty. Black: what is printed of the experiments at w = 10 cm,
a measured runout at 0 deg and upper bounds at 10 and 22 deg.
"""


def draw(of):
    """One panel per width."""
    figure, axes = panels(1, 2, (10.5, 4.4), sharey=True)
    for panel, width in zip(axes[0], ("w10", "winf"), strict=True):
        for bed, line in LINES.items():
            for mm, colour in FRONTS.items():
                curve(panel, Tables(of.folder / bed, mm), width, color=colour, ls=line)
        panel.set_title(WIDTH_NAME[width], fontsize="medium")
        panel.set(xlabel="slope (°)")
    for slope, (value, error, bound) in FACTS.items():
        style = {"color": "black", "capsize": 4, "marker": "_" if bound else "s", "ms": 6}
        axes[0, 0].errorbar([slope], [value], [error], uplims=bound, **style)
    axes[0, 0].set_ylabel("runout from the back wall (m)")
    key(axes[0, 0], {f"{mm} mm": {"color": c} for mm, c in FRONTS.items()}, loc="upper left")
    run = [bed for bed in BEDS if Tables(of.folder / bed).scalars]
    beds = {WORDS[bed]: {"color": "black", "ls": LINES[bed]} for bed in run}
    key(axes[0, 1], beds, loc="upper left")
    save(figure, "paper_beds", of, CAPTION, ("lateral_friction", "rough*/lateral_friction"))


def curve(axes, of, width, **style):
    """Runouts of the slopes that were run."""
    found = []
    for slope in SLOPES:
        try:
            found.append((slope, *of.value(f"muI_a{slope}_{width}", of.runout)[:2]))
        except MissingRun:
            continue
    if found:
        slopes, values, errors = zip(*found, strict=True)
        axes.errorbar(slopes, values, errors, lw=1.2, capsize=2, **style)


if __name__ == "__main__":
    main(draw)
