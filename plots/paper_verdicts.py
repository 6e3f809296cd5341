"""All statements under all readings: confirmed, refuted, or not to be told.

python -m plots.paper_verdicts
"""

import numpy as np
from matplotlib.colors import ListedColormap

from fvcollapse.draw.drawing import GREEN, ORANGE
from plots.paper_style import key, main, panels, save
from runs.paper.beds import BEDS
from runs.paper.settled import FRONTS, ON_BED, ON_FRONT, reading_name
from runs.paper.statements import all_statements
from runs.paper.verdicts import CONFIRMED, OPEN, REFUTED

COLOURS = {CONFIRMED: GREEN, REFUTED: ORANGE, OPEN: "#CCCCCC"}
MARKS = {ON_BED: "B", ON_FRONT: "F"}
CAPTION = """
The statements of runs/paper/statements.md (by number) under each reading: the bed, and the thickness at which the
front is read where a statement reads it. White: no reading of that statement. B: depends on the bed, F: depends on
the thickness at which the front is read.
"""


def draw(of):
    """Statements along, readings across."""
    settled, _ = all_statements(of.folder)
    readings = [(bed, mm) for bed in BEDS for mm in FRONTS]
    codes = np.full((len(readings), len(settled)), np.nan)
    order = list(COLOURS)
    for column, statement in enumerate(settled):
        for row, reading in enumerate(readings):
            if reading in statement.readings:
                codes[row, column] = order.index(statement.readings[reading].verdict)
    figure, axes = panels(1, 1, (13.0, 3.4))
    panel = axes[0, 0]
    edges = np.arange(len(settled) + 1) + 0.5
    panel.pcolormesh(
        edges,
        np.arange(len(readings) + 1) - 0.5,
        codes,
        cmap=ListedColormap(list(COLOURS.values())),
        vmin=-0.5,
        vmax=2.5,
        edgecolors="white",
        lw=1.0,
    )
    for column, statement in enumerate(settled, start=1):
        panel.text(column, -0.9, MARKS.get(statement.verdict, ""), ha="center", fontsize="small")
    panel.set_yticks(range(len(readings)), [reading_name(of, True) for of in readings])
    panel.set_ylim(len(readings) - 0.5, -1.4)
    panel.set_xticks(range(1, len(settled) + 1), range(1, len(settled) + 1), fontsize=6)
    panel.set_xlabel("statement")
    styles = {name: {"color": colour, "lw": 8} for name, colour in COLOURS.items()}
    key(panel, styles, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    save(figure, "paper_verdicts", of, CAPTION, ("*", "rough*/*"))


if __name__ == "__main__":
    main(draw)
