"""Maps of the gap over place and time."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm
from matplotlib.patches import Rectangle

from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.report.drawing import GAP_UNITS, WIDTH, column, file_name, picture, plain
from fvcollapse.diagnosis.report.words import CENTIMETRES, after_model, model_name
from fvcollapse.draw.drawing import new_figure
from fvcollapse.measure.quantities import observable_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Comparison, Report

LEVELS = (-8.0, -5.0, -3.0, -2.0, 2.0, 3.0, 5.0, 8.0)  # of z: between -2 and 2 nothing is claimed
NO_DATA = "#dfe3e8"


def gap_map(report: "Report", one: "Comparison") -> "Picture":
    """Gap in combined standard uncertainties over place and time, before and after."""
    after = after_model(report)
    models = [model for model in dict.fromkeys((BASELINE, after)) if model in one.z]
    time, x = column(one.time), CENTIMETRES * column(one.x)  # type: ignore[arg-type]
    moments = np.unique(time)
    cells = [cell(x, time, moments, n) for n in range(len(x))]
    ends = min(corners[0][0] for corners in cells), max(corners[1][0] for corners in cells)
    figure = new_figure(WIDTH, 1.55 + 0.27 * len(moments))
    panels = figure.subplots(1, len(models), sharey=True, squeeze=False)[0]
    norm = BoundaryNorm(LEVELS, 256, extend="both")
    for axes, model in zip(panels, models, strict=True):
        drawn = PolyCollection(cells, array=column(one.z[model]), cmap="RdBu_r", norm=norm)
        drawn.set(edgecolor="face", linewidth=0.3, rasterized=True)
        axes.add_collection(drawn)
        if model == BASELINE:
            outline(axes, one, cells)
        axes.set_facecolor(NO_DATA)
        word = "before" if model == BASELINE else "after"
        axes.set_title(plain(f"{word}: {model_name(model, report)}"), fontsize=7.5, wrap=True)
        axes.set(xlim=ends, ylim=(-0.5, len(moments) - 0.5), xlabel="x (cm)")
        axes.set_yticks(range(len(moments)), [f"{moment:.3g}" for moment in moments])
        axes.locator_params(axis="x", nbins=5)
    panels[0].set_ylabel("time (s), one row each")
    bar = figure.colorbar(
        drawn, ax=panels, location="bottom", aspect=35, ticks=LEVELS, extend="both"
    )
    bar.set_label(
        "simulated too low  \N{LEFTWARDS ARROW}  z = gap / combined sd  \N{RIGHTWARDS ARROW}  too high",
        fontsize=8,
    )
    what = f"{observable_words(one.observable)}, {one.experiment}"
    group = "held out" if one.experiment in report.held_out else "fitted"
    alt = f"map over place and time of the {GAP_UNITS}: {what}"
    name = file_name("gap", one.observable, one.experiment)
    return picture(figure, name, alt, f"{what} ({group})", one.experiment)


def cell(x: np.ndarray, time: np.ndarray, moments: np.ndarray, n: int) -> list[tuple[float, float]]:
    """Corners of the cell of point n: its row, half-way to its neighbours in x."""
    row = np.sort(x[time == time[n]])
    place = int(np.searchsorted(row, x[n]))
    edges = np.concatenate(([row[0]], 0.5 * (row[1:] + row[:-1]), [row[-1]]))
    if len(row) > 1:
        edges[0], edges[-1] = 1.5 * row[0] - 0.5 * row[1], 1.5 * row[-1] - 0.5 * row[-2]
    left, right = edges[place], edges[place + 1]
    low = float(np.searchsorted(moments, time[n])) - 0.5
    return [(left, low), (right, low), (right, low + 1.0), (left, low + 1.0)]


def outline(
    axes: "Axes", one: "Comparison", cells: Sequence[Sequence[tuple[float, float]]]
) -> None:
    """Black edges around the cells of significant regions, neighbours in a row as one."""
    inside = sorted(
        (cells[n][0][1], cells[n][0][0], cells[n][1][0])
        for n, region in enumerate(one.region)
        if region is not None
    )
    joined: list[tuple[float, float, float]] = []
    for low, left, right in inside:
        if joined and joined[-1][0] == low and left - joined[-1][2] < 1.0e-9:
            joined[-1] = (low, joined[-1][1], right)
        else:
            joined.append((low, left, right))
    for low, left, right in joined:
        axes.add_patch(Rectangle((left, low), right - left, 1.0, fill=False, ec="black", lw=1.0))
