"""Figure of the single numbers of the experiments: measured, before and after."""

from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.report.drawing import WIDTH, broken, column, picture, plain, shared_legend
from fvcollapse.diagnosis.report.words import after_model, model_name
from fvcollapse.draw.drawing import BLUE, ORANGE, new_figure
from fvcollapse.measure.quantities import observable_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Comparison, Report

BAR, MARKERS = 2.0, {"value": "o", "upper": "<", "lower": ">"}


def scalars(report: "Report") -> "Picture":
    """Every single number as a dot with its bar, and the simulated ones beside it, relative to what was measured.

    The bar covers two combined standard uncertainties; a bound is a triangle that points to where it allows values.
    """
    rows = [
        (one, n)
        for one in report.details.comparisons
        if one.time is None
        for n in range(len(one.measured))
        if one.measured[n]
    ][::-1]
    figure = new_figure(WIDTH, 1.2 + 0.36 * len(rows))
    axes = figure.subplots()
    axes.axvline(100.0, color="black", lw=0.6)
    for row, (one, n) in enumerate(rows):
        draw_row(axes, row, one, n, report)
    labels = [f"{observable_words(one.observable)}, {one.experiment}" for one, _ in rows]
    axes.set_yticks(range(len(rows)), [plain(broken(label, 26)) for label in labels])
    axes.set(xlabel="relative to the measured value (%)", ylim=(-0.6, len(rows) - 0.4))
    axes.grid(axis="x", lw=0.4)
    shared_legend(figure, axes)
    alt = "single numbers: measured with two combined standard uncertainties, simulated before and after"
    return picture(figure, "scalars", alt, "Single numbers, relative to what was measured")


def draw_row(axes: "Axes", row: int, one: "Comparison", n: int, report: "Report") -> None:
    """One number: the measured one with its bar, and those of the models."""
    measured, combined = (float(column(values)[n]) for values in (one.measured, one.combined))
    after, spread = after_model(report), 100.0 * BAR * combined / abs(measured)
    label = "measured \N{PLUS-MINUS SIGN} 2 combined sd"
    axes.plot([100.0 - spread, 100.0 + spread], [row, row], color="black", lw=1.4)
    axes.plot(100.0, row, MARKERS[one.kind], color="black", markersize=5, label=label)
    styles = {BASELINE: ("before", ORANGE, "s", 0.16), after: ("after", BLUE, "D", -0.16)}
    styles[BASELINE] = ("before", ORANGE, "s", 0.16)
    for model, (word, colour, marker, shift) in styles.items():
        value = one.simulated.get(model, np.full(n + 1, None))[n]
        if value is not None:
            label = plain(f"{word}: {model_name(model, report)}")
            place = (100.0 * value / measured, row + shift)
            axes.plot(*place, marker, color=colour, markersize=5, ls="", label=label)
