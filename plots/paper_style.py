"""What the figures of the paper's study share: colours, lines with their grid uncertainty, saving.

The figures read the tables of runs/paper and draw; nothing is computed. Bands are the difference to
the grid 1.5 times finer, to both sides of the line.
"""

import io
import math
import textwrap
from pathlib import Path

import numpy as np
from PIL import Image

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE, new_figure
from runs.table import FINE, RUNS, VELOCITY, MissingRun, Tables

FIGURES = Path(__file__).parent / "figures"
PAPER = RUNS / "paper"  # the tables
PURPLE, YELLOW, SKY = "#CC79A7", "#E69F00", "#56B4E9"  # Okabe & Ito (2008)
SLOPE_COLOUR = {0: GREY, 10: BLUE, 16: GREEN, 19: PURPLE, 22: ORANGE}
WIDTH_NAME = {"w10": "w = 10 cm", "w20": "w = 20 cm", "winf": "w = ∞"}
END = 2.0  # s, of the front velocities
DPI = 110
ABOUT_VELOCITY = """
Velocity of the front (5 mm thickness, farthest so far) by local parabolas over 80 ms; in the first 80 ms the
front is a vertical wall that is read to a cell, so nothing is drawn.
"""
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


def percent(measured):
    """A share with its uncertainty in per cent."""
    if math.isnan(measured.value):
        return "–"
    return f"{100 * measured.value:.1f} ± {100 * measured.uncertainty:.1f} %"


def key(axes, entries, **options):
    """A legend of styles {label: style}, without drawing anything."""
    if axes.get_legend() is not None:
        axes.add_artist(axes.get_legend())  # a second legend would replace it
    handles = [axes.plot([], [], label=label, **style)[0] for label, style in entries.items()]
    axes.legend(handles=handles, frameon=False, fontsize="small", **options)


def velocities_by_slope(of, laws, slopes, widths, name):
    """Front velocities, one panel per width: colours are slopes, line styles are laws.

    Parameters
    ----------
    of : Tables
    laws : dict
        {label: (name of the case with {slope} and {width}, line style)}
    slopes, widths : sequences
    name : str
        Title of the legend of the line styles.
    """
    figure, axes = panels(1, 2, (10.5, 4.2), sharey=True)
    for panel, width in zip(axes[0], widths, strict=True):
        for slope in slopes:
            for case, line in laws.values():
                run = case.format(slope=slope, width=width)
                style = {"color": SLOPE_COLOUR[slope], "ls": line, "lw": 1.3}
                draw_line(panel, of, run, VELOCITY, end=END, **style)
        finish_velocity(panel, WIDTH_NAME[width])
    axes[0, 0].set_ylabel("front velocity (m/s)")
    colours = {f"{slope}°": {"color": SLOPE_COLOUR[slope]} for slope in slopes}
    lines = {label: {"color": "black", "ls": line} for label, (_, line) in laws.items()}
    key(axes[0, 1], colours, loc="upper right", title="slope")
    key(axes[0, 1], lines, loc="center right", title=name)
    return figure


def finish_velocity(axes, title):
    """Title, limits and time axis of a panel of front velocities."""
    axes.set_title(title, fontsize="medium")
    axes.set(xlabel="time (s)", xlim=(0.0, END), ylim=(0.0, None))


def finish_profile(axes):
    """Labels, limits and legend of a panel of profiles."""
    axes.set(xlabel="distance from the back wall (m)", ylabel="height (mm)")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    axes.legend(frameon=False, fontsize="small")


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
    write_picture(figure, name, f"{caption} {cells}")


def write_picture(figure, name, caption, folder=None):
    """Write a picture, and its caption beside it, into a folder; default `FIGURES`."""
    folder = FIGURES if folder is None else folder
    folder.mkdir(parents=True, exist_ok=True)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI)
    # 256 colours are enough for lines and one colour map, and a third of the bytes
    Image.open(stream).convert("RGB").quantize(256).save(folder / f"{name}.png", optimize=True)
    text = textwrap.fill(" ".join(caption.split()), 115, break_on_hyphens=False)
    (folder / f"{name}.txt").write_text(f"{text}\n", encoding="utf-8")


def main(draw, folder=PAPER):
    """Draw from the tables in a folder; one line where a run is missing."""
    try:
        draw(Tables(folder))
    except MissingRun as missing:
        print(f"{draw.__module__}: not drawn: {missing}")
