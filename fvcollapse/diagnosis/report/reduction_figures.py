"""Figures of the ladder of models and of the sources of uncertainty."""

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.names import RUNGS
from fvcollapse.diagnosis.report.drawing import WIDTH, broken, picture, plain, shared_legend
from fvcollapse.diagnosis.report.words import model_name
from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE, new_figure
from fvcollapse.measure.quantities import observable_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Misfit, Report

FILLS = (BLUE, ORANGE, GREEN, "#E69F00", "#CC79A7", GREY)
APART = 0.14  # rows between the fitted and the held-out experiments of a model
ROOM = 1.12  # right of the largest gap, so that no marker is cut


def ladder(report: "Report") -> "Picture":
    """Gap of each model and the fraction closed, in fitted and held-out experiments."""
    rungs = report.details.ladder[::-1]
    parts = [part for rung in rungs for part in (rung.fitted, rung.held_out) if part is not None]
    apart = APART if len(parts) > len(rungs) else 0.0
    figure = new_figure(WIDTH, 1.2 + 0.62 * len(rungs))
    left, right = figure.subplots(1, 2, sharey=True)
    for row, rung in enumerate(rungs):
        draw_rung((left, right), row + apart, rung.fitted, BLUE, "o", "fitted")
        if rung.held_out is not None:
            draw_rung((left, right), row - apart, rung.held_out, ORANGE, "s", "held out")
    labels = [f"{RUNGS[rung.model]}  {model_name(rung.model, report)}" for rung in rungs]
    left.set_yticks(range(len(rungs)), [plain(broken(text)) for text in labels])
    left.set(xlabel="rms gap in combined\nstandard uncertainties", ylim=(-0.5, len(rungs) - 0.5))
    largest = max(
        (rms for part in parts for rms in (part.rms, *part.by_experiment.values())), default=1.0
    )
    left.set_xlim(0.0, ROOM * (largest or 1.0))
    right.axvline(0.0, color="black", lw=0.8)
    right.set(xlabel="share of the gap of G0\nthat is closed (%)")
    for axes in (left, right):
        axes.grid(axis="x", lw=0.4)
    shared_legend(figure, left, right)
    alt = "gap of the model as given, re-calibrated, and with the first and second effect"
    return picture(figure, "ladder", alt, "How far the gap shrinks")


def draw_rung(
    panels: "tuple[Axes, Axes]", row: float, misfit: "Misfit", colour: str, marker: str, word: str
) -> None:
    """One model over one group: rms gap (single experiments small), fraction closed with its range."""
    left, right = panels
    singles = list(misfit.by_experiment.values())
    if len(singles) > 1:
        label = f"{word}, one experiment each"
        left.plot(singles, [row] * len(singles), "|", color=colour, markersize=7, label=label)
    left.plot(misfit.rms, row, marker, color=colour, markersize=6, label=f"{word}, all")
    if misfit.interval is not None:
        ends = [100.0 * end for end in misfit.interval]
        right.plot(ends, [row, row], color=colour, lw=1.6)
    if misfit.fraction_closed is not None:
        right.plot(100.0 * misfit.fraction_closed, row, marker, color=colour, markersize=6)
    if misfit.predicted is not None:
        right.plot(
            100.0 * misfit.predicted,
            row,
            "D",
            color=GREEN,
            markerfacecolor="none",
            markersize=6,
            label="foreseen before its run",
        )


def budget(report: "Report") -> "Picture":
    """Share of the variance of the gap that each source of uncertainty has, by observable."""
    table = report.details.budget
    sources = list(dict.fromkeys(name for row in table.values() for name in row))
    names = list(table)[::-1]
    figure = new_figure(WIDTH, 1.3 + 0.3 * len(names))
    axes = figure.subplots()
    left = np.zeros(len(names))
    for source, colour in zip(sources, cycle(FILLS), strict=False):
        variance = np.array([table[name].get(source, 0.0) ** 2 for name in names])
        total = np.array([sum(sd**2 for sd in table[name].values()) for name in names])
        share = 100.0 * variance / np.where(total > 0.0, total, 1.0)
        axes.barh(
            np.arange(len(names)),
            share,
            left=left,
            color=colour,
            ec="white",
            height=0.7,
            label=source,
        )
        left += share
    axes.set_yticks(range(len(names)), [observable_words(name) for name in names])
    axes.set(xlim=(0.0, 100.0), xlabel="share of the variance of the gap (%)")
    shared_legend(figure, axes)
    alt = "share of each source in the combined uncertainty of each observable"
    return picture(figure, "uncertainty", alt, "Where the combined uncertainty comes from")
