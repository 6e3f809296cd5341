"""Measurement and simulation, before and after, in one figure."""

from typing import TYPE_CHECKING, Any

import numpy as np

from fvcollapse.diagnosis.names import BASELINE
from fvcollapse.diagnosis.report.drawing import (
    WIDTH,
    column,
    file_name,
    picture,
    plain,
    shared_legend,
)
from fvcollapse.diagnosis.report.words import CENTIMETRES, after_model, model_name, thinned_words
from fvcollapse.draw.drawing import BLUE, GREY, ORANGE, new_figure
from fvcollapse.measure.quantities import HEIGHTS, observable_words, shown_gap, shown_value

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Comparison, Report

COVERAGE = 2.0  # combined standard uncertainties of a band
NEVER_NEGATIVE = {"front", *HEIGHTS}


def overlay(report: "Report", one: "Comparison") -> "Picture":
    """Measurement and simulation before and after, of one observable of one experiment."""
    draw = draw_history if one.x is None else draw_profiles
    after = after_model(report)
    figure = draw(report, one)
    what = f"{observable_words(one.observable)}, {one.experiment}"
    group = "held out" if one.experiment in report.held_out else "fitted"
    alt = f"{what}: measured, {model_name(BASELINE, report)}, {model_name(after, report)}"
    name = file_name(one.observable, one.experiment)
    compared = thinned_words(one)
    about = f"{group}; {compared}" if compared else group
    return picture(figure, name, alt, f"{what} ({about})", one.experiment)


def draw_measured(
    axes: "Axes", abscissa: np.ndarray, one: "Comparison", rows: np.ndarray | slice, factor: float
) -> None:
    """Measured values with one standard deviation, bounds as triangles."""
    marker = {"value": "o", "upper": "v", "lower": "^"}[one.kind]
    values, sigma = factor * column(one.measured)[rows], factor * column(one.sigma)[rows]
    label = "measured \N{PLUS-MINUS SIGN} 1 sd"
    axes.plot(*bars(abscissa, values - sigma, values + sigma), color="black", lw=0.7, zorder=4)
    axes.plot(abscissa, values, marker, color="black", markersize=2.6, label=label, zorder=4)


def bars(abscissa: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All error bars as one line with gaps: a tenth of the size of as many single ones."""
    gap = np.full(len(abscissa), np.nan)
    return np.repeat(abscissa, 3), np.column_stack((low, high, gap)).ravel()


def draw_models(
    axes: "Axes",
    abscissa: np.ndarray,
    report: "Report",
    one: "Comparison",
    rows: np.ndarray | slice,
    factor: float,
) -> None:
    """Lines of the model before, with the band of all uncertainties, and after."""
    after = after_model(report)
    before = factor * column(one.simulated[BASELINE])[rows]
    expected = factor * (column(one.measured) + gap_of(one, BASELINE))[rows]
    spread = COVERAGE * factor * column(one.combined)[rows]
    low = expected - spread
    if one.observable in NEVER_NEGATIVE:
        low = np.maximum(low, np.minimum(expected, 0.0))
    band = "before \N{PLUS-MINUS SIGN} 2 combined sd"
    axes.fill_between(abscissa, low, expected + spread, color=ORANGE, alpha=0.18, lw=0, label=band)
    axes.plot(
        abscissa,
        before,
        "--",
        color=ORANGE,
        lw=1.4,
        label=plain(f"before: {model_name(BASELINE, report)}"),
    )
    if after != BASELINE and after in one.simulated:
        values = factor * column(one.simulated[after])[rows]
        axes.plot(
            abscissa, values, color=BLUE, lw=1.4, label=plain(f"after: {model_name(after, report)}")
        )


def draw_history(report: "Report", one: "Comparison") -> "Figure":
    """A curve over time, and under it the gap before and after."""
    after = after_model(report)
    figure = new_figure(WIDTH, 4.1)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.7, 1.0))
    time, everything = column(one.time), slice(None)  # type: ignore[arg-type]
    factor, units = shown_value(one.observable, one.units)
    draw_models(top, time, report, one, everything, factor)
    draw_measured(top, time, one, everything, factor)
    top.set(ylabel=f"{observable_words(one.observable)} ({units or '1'})")
    factor, units = shown_gap(one.observable, one.units)
    spread = COVERAGE * factor * column(one.combined)
    bottom.fill_between(time, -spread, spread, color=GREY, alpha=0.18, lw=0)
    bottom.axhline(0.0, color="black", lw=0.8)
    styles = {BASELINE: {"marker": "s", "ls": "--", "color": ORANGE}}
    styles = {after: {"marker": "o", "ls": "-", "color": BLUE}} | styles
    for model in (BASELINE, after):
        if model in one.z:
            bottom.plot(time, factor * gap_of(one, model), lw=1.0, markersize=2.6, **styles[model])
    mark_regions(bottom, one, time)
    bottom.set(xlabel="time (s)", ylabel=f"simulated \N{MINUS SIGN}\nmeasured ({units or '1'})")
    shared_legend(figure, top)
    return figure


def gap_of(one: "Comparison", model: str) -> np.ndarray:
    """Gap of a model as it is judged, (n,): after what controls taught, if there were any."""
    return column(one.z[model]) * column(one.combined)


def mark_regions(axes: "Axes", one: "Comparison", time: np.ndarray) -> None:
    """A bar along the upper edge where the gap before is significant."""
    index = np.array([-1 if n is None else n for n in one.region] or [-1] * len(time))
    for region in np.unique(index[index >= 0]):
        inside = time[index == region]
        place: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "clip_on": False}
        axes.plot(
            inside[[0, -1]], [1.0, 1.0], color="black", lw=3.5, solid_capstyle="butt", **place
        )


def draw_profiles(report: "Report", one: "Comparison") -> "Figure":
    """Profiles over x, one panel for each time."""
    time, x = column(one.time), CENTIMETRES * column(one.x)  # type: ignore[arg-type]
    moments = np.unique(time)
    lines = (len(moments) + 1) // 2
    figure = new_figure(WIDTH, 0.6 + 1.15 * lines)
    grid = figure.subplots(lines, 2, sharex=True, sharey="row", squeeze=False)
    panels, spare = grid.ravel()[: len(moments)], grid.ravel()[len(moments) :]
    factor, units = shown_value(one.observable, one.units)
    for axes, moment in zip(panels, moments, strict=True):
        rows = np.flatnonzero(time == moment)
        rows = rows[np.argsort(x[rows])]
        draw_models(axes, x[rows], report, one, rows, factor)
        draw_measured(axes, x[rows], one, rows, factor)
        place = {"transform": axes.transAxes, "ha": "right", "va": "top"}
        axes.text(0.97, 0.95, f"t = {moment:.3g} s", **place)
        axes.locator_params(nbins=5)
    for axes in panels[-2:]:  # the last of each column carries the axis
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("x from the back wall (cm)")
    for axes in spare:  # where the last row has one panel, the legend fills it
        axes.set_axis_off()
    figure.supylabel(f"{observable_words(one.observable)} ({units or '1'})", fontsize=8.5)
    shared_legend(figure, panels[0], beside=spare)
    return figure
