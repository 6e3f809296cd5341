"""What the figures of the paper's study share: colours, lines with their grid uncertainty, saving.

The figures read the tables of runs/paper and draw; nothing is computed. Bands are the difference to
the grid 1.5 times finer, to both sides of the line.
"""

import textwrap
from pathlib import Path

import numpy as np

from fvcollapse.drawing import BLUE, GREEN, GREY, ORANGE, new_figure
from runs.paper.tables import FINE, MissingRun, Tables

FIGURES = Path(__file__).parent / "figures"
PURPLE, YELLOW, SKY = "#CC79A7", "#E69F00", "#56B4E9"  # Okabe & Ito (2008)
SLOPE_COLOUR = {0: GREY, 10: BLUE, 16: GREEN, 19: PURPLE, 22: ORANGE}
WIDTH_NAME = {"w10": "w = 10 cm", "w20": "w = 20 cm", "winf": "w = ∞"}
DPI = 110
CELLS = "Cells {coarse:g} mm; bands and bars: difference to {fine:.3g} mm cells. Numbers drawn: {sources}."


def panels(rows, columns, size, **options):
    """A figure and its panels, (rows, columns)."""
    figure = new_figure(*size)
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def fine_line(of, case, quantity, t=None, at=None):
    """Values of the finer grid at given abscissae; None where that was not run."""
    try:
        line = of.line(case, quantity, t, refinement=FINE)
    except MissingRun:
        return None
    return np.interp(at, line.at, line.values, right=beyond(quantity, line))


def beyond(quantity, line):
    """What a curve is beyond its last value: a stopped front stays, everything else is zero."""
    return line.values[-1] if quantity.startswith("front") else 0.0


def draw_line(axes, of, case, quantity, t=None, end=None, **style):
    """A curve of a case with its band.

    Parameters
    ----------
    axes : Axes
    of : Tables
    case, quantity : str
    t : float, optional
        Time of a profile [s].
    end : float, optional
        Last abscissa; a curve that stops before goes on as it ended (front) or with zero.
    **style
        Of the line.
    """
    line = of.line(case, quantity, t)
    at, values = line.at, line.values
    if end is not None and at[-1] < end:
        more = np.arange(at[-1] + 1e-9, end, at[1] - at[0])[1:]
        at = np.concatenate([at, more])
        values = np.concatenate([values, np.full(len(more), beyond(quantity, line))])
    axes.plot(at, values, **style)
    fine = fine_line(of, case, quantity, t, at)
    if fine is not None:
        gap = np.abs(fine - values)
        axes.fill_between(at, values - gap, values + gap, color=style["color"], alpha=0.15, lw=0)


def key(axes, entries, **options):
    """A legend of styles {label: style}, without drawing anything."""
    handles = [axes.plot([], [], label=label, **style)[0] for label, style in entries.items()]
    legend = axes.legend(handles=handles, frameon=False, fontsize="small", **options)
    axes.add_artist(legend)


def save(figure, name, of, caption, sources):
    """Write picture and caption.

    Parameters
    ----------
    figure : Figure
    name : str
        Without ending.
    of : Tables
    caption : str
        What is drawn, without the cells and the sources, which are added.
    sources : tuple of str
        Groups whose tables hold the numbers drawn.
    """
    case = "muI_a22_w10"
    cells = CELLS.format(
        coarse=of.cell_size(case),
        fine=of.cell_size(case, FINE),
        sources=", ".join(f"runs/paper/{group}" for group in sources),
    )
    FIGURES.mkdir(exist_ok=True)
    figure.savefig(FIGURES / f"{name}.png", dpi=DPI)
    text = textwrap.fill(" ".join(f"{caption} {cells}".split()), 115, break_on_hyphens=False)
    (FIGURES / f"{name}.txt").write_text(f"{text}\n", encoding="utf-8")


def main(draw):
    """Draw from the tables of the repository; one line where a run is missing."""
    try:
        draw(Tables())
    except MissingRun as missing:
        print(f"{draw.__module__}: not drawn: {missing}")
