"""Figures of the report: overlays before and after, gap maps, evidence, signatures, ladder.

Each is a small SVG, narrow enough to be read on a telephone; the page lays them side by side where there
is room. Colours are those of Okabe & Ito (2008) and the map RdBu; no meaning rests on colour alone.
"""

import io
import re
from itertools import cycle
from typing import NamedTuple
from urllib.parse import quote

import matplotlib
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm
from matplotlib.patches import Rectangle

from fvcollapse.diagnosis.report import BASELINE, RUNGS
from fvcollapse.diagnosis.report_words import (
    after_model,
    hypothesis_name,
    model_name,
    percent,
    ranking,
)
from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE, new_figure
from fvcollapse.measure.quantities import CURVES, HEIGHTS, observable_words, shown_gap, shown_value

WIDTH = 4.9  # inch
STYLE = {"font.size": 8.5, "axes.titlesize": 8.5, "svg.fonttype": "none", "svg.hashsalt": "report"}
STYLE |= {"axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.6}
LEVELS = (-8.0, -5.0, -3.0, -2.0, 2.0, 3.0, 5.0, 8.0)  # of z: between -2 and 2 nothing is claimed
NO_DATA = "#dfe3e8"
COVERAGE = 2.0  # combined standard uncertainties of a band
EVIDENCE_LEAST = -30.0  # ln: what is worse is drawn here, with its number
GAP_UNITS = "gap in combined standard uncertainties"
FILLS = (BLUE, ORANGE, GREEN, "#E69F00", "#CC79A7", GREY)
NEVER_NEGATIVE = {"front", *HEIGHTS}


class Picture(NamedTuple):
    """A figure as SVG bytes, its name (of a file) and what it shows, in words, for the page.

    `experiment` is the one it belongs to; empty: all.
    """

    name: str
    svg: bytes
    alt: str
    caption: str
    experiment: str = ""


def pictures(report):
    """Every figure of a report, by the chapter of the page that shows it.

    Returns
    -------
    dict of str -> list of Picture
        "overlays", "gap_maps", "evidence", "signatures", "ladder", "budget"; a chapter without data
        has an empty list.
    """
    details = report.details
    with matplotlib.rc_context(STYLE):
        return {
            "overlays": [overlay(report, one) for one in drawable(report)],
            "gap_maps": [gap_map(report, one) for one in drawable(report) if one.x is not None],
            "evidence": [evidence(report)],
            "signatures": [signatures(details.separability)] if details.separability else [],
            "ladder": [ladder(report)] if details.ladder else [],
            "budget": [budget(report)] if details.budget else [],
        }


def drawable(report):
    """Comparisons that are curves, experiment after experiment, the front first."""
    order = {name: n for n, name in enumerate(CURVES)}
    names = [*report.experiments, *report.held_out]
    curves = [one for one in report.details.comparisons if one.time is not None]
    return sorted(
        curves, key=lambda one: (names.index(one.experiment), order.get(one.observable, len(order)))
    )


def picture(figure, name, alt, caption, experiment=""):
    """The figure as a `Picture`."""
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    svg = lighter(stream.getvalue().decode()).encode()
    return Picture(name, svg, alt, caption, experiment)


def lighter(svg):
    """The SVG without indentation, its coordinates to a hundredth of a point."""
    svg = re.sub(r"<metadata>.*?</metadata>", "", re.sub(r"\n\s*", " ", svg))
    shorten = re.compile(r"(\.\d\d)\d+")
    return re.sub(r' (?:d|x|y|transform)="[^"]*"', lambda found: shorten.sub(r"\1", found[0]), svg)


def file_name(*parts):
    """A name that any file system takes; different for different parts."""
    return quote("_".join(parts), safe="")


def plain(text):
    """Text that matplotlib prints as it is."""
    return text.replace("$", r"\$")


def column(values):
    """A column of a comparison as an array, NaN for gaps."""
    return np.array([np.nan if value is None else value for value in values], float)


# -- overlays ------------------------------------------------------------------------------------


def overlay(report, one):
    """Measurement and simulation before and after, of one observable of one experiment."""
    draw = draw_history if one.x is None else draw_profiles
    after = after_model(report)
    figure = draw(report, one, after)
    what = f"{observable_words(one.observable)}, {one.experiment}"
    group = "held out" if one.experiment in report.held_out else "fitted"
    alt = f"{what}: measured, {model_name(BASELINE, report)}, {model_name(after, report)}"
    name = file_name(one.observable, one.experiment)
    return picture(figure, name, alt, f"{what} ({group})", one.experiment)


def shared_legend(figure, *panels, beside=()):
    """One legend below all panels (or in an empty one), each entry once; long ones in two lines."""
    found = [panel.get_legend_handles_labels() for panel in panels]
    named = {word: handle for pair in found for handle, word in zip(*pair, strict=True)}
    words = [broken(word, 34) for word in named]
    form = {"frameon": False, "fontsize": 8}
    if len(beside):
        beside[0].legend(named.values(), words, loc="center", borderaxespad=0.0, **form)
    else:
        figure.legend(named.values(), words, loc="outside lower center", ncols=2, **form)


def draw_measured(axes, abscissa, one, rows, factor):
    """Measured values with one standard deviation, bounds as triangles."""
    marker = {"value": "o", "upper": "v", "lower": "^"}[one.kind]
    values, sigma = factor * column(one.measured)[rows], factor * column(one.sigma)[rows]
    label = "measured \N{PLUS-MINUS SIGN} 1 sd"
    axes.plot(*bars(abscissa, values - sigma, values + sigma), color="black", lw=0.7, zorder=4)
    axes.plot(abscissa, values, marker, color="black", markersize=2.6, label=label, zorder=4)


def bars(abscissa, low, high):
    """All error bars as one line with gaps: a tenth of the size of as many single ones."""
    gap = np.full(len(abscissa), np.nan)
    return np.repeat(abscissa, 3), np.column_stack((low, high, gap)).ravel()


def draw_models(axes, abscissa, report, one, rows, after, factor):
    """Lines of the model before, with the band of all uncertainties, and after."""
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


def draw_history(report, one, after):
    """A curve over time, and under it the gap before and after."""
    figure = new_figure(WIDTH, 4.1)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.7, 1.0))
    time, everything = column(one.time), slice(None)
    factor, units = shown_value(one.observable, one.units)
    draw_models(top, time, report, one, everything, after, factor)
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


def gap_of(one, model):
    """Gap of a model as it is judged, (n,): after what controls taught, if there were any."""
    return column(one.z[model]) * column(one.combined)


def mark_regions(axes, one, time):
    """A bar along the upper edge where the gap before is significant."""
    index = np.array([-1 if n is None else n for n in one.region] or [-1] * len(time))
    for region in np.unique(index[index >= 0]):
        inside = time[index == region]
        place = {"transform": axes.get_xaxis_transform(), "clip_on": False}
        axes.plot(
            inside[[0, -1]], [1.0, 1.0], color="black", lw=3.5, solid_capstyle="butt", **place
        )


def draw_profiles(report, one, after):
    """Profiles over x, one panel for each time."""
    time, x = column(one.time), column(one.x)
    moments = np.unique(time)
    lines = (len(moments) + 1) // 2
    figure = new_figure(WIDTH, 0.6 + 1.15 * lines)
    grid = figure.subplots(lines, 2, sharex=True, sharey="row", squeeze=False)
    panels, spare = grid.ravel()[: len(moments)], grid.ravel()[len(moments) :]
    factor, units = shown_value(one.observable, one.units)
    for axes, moment in zip(panels, moments, strict=True):
        rows = np.flatnonzero(time == moment)
        rows = rows[np.argsort(x[rows])]
        draw_models(axes, x[rows], report, one, rows, after, factor)
        draw_measured(axes, x[rows], one, rows, factor)
        place = {"transform": axes.transAxes, "ha": "right", "va": "top"}
        axes.text(0.97, 0.95, f"t = {moment:.3g} s", **place)
        axes.locator_params(nbins=5)
    for axes in panels[-2:]:  # the last of each column carries the axis
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("x from the back wall (m)")
    for axes in spare:  # where the last row has one panel, the legend fills it
        axes.set_axis_off()
    figure.supylabel(f"{observable_words(one.observable)} ({units or '1'})", fontsize=8.5)
    shared_legend(figure, panels[0], beside=spare)
    return figure


# -- gap maps ------------------------------------------------------------------------------------


def gap_map(report, one):
    """Gap in combined standard uncertainties over place and time, before and after."""
    after = after_model(report)
    models = [model for model in dict.fromkeys((BASELINE, after)) if model in one.z]
    time, x = column(one.time), column(one.x)
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
        axes.set(xlim=ends, ylim=(-0.5, len(moments) - 0.5), xlabel="x (m)")
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


def cell(x, time, moments, n):
    """Corners of the cell of point n: its row, half-way to its neighbours in x."""
    row = np.sort(x[time == time[n]])
    place = int(np.searchsorted(row, x[n]))
    edges = np.concatenate(([row[0]], 0.5 * (row[1:] + row[:-1]), [row[-1]]))
    if len(row) > 1:
        edges[0], edges[-1] = 1.5 * row[0] - 0.5 * row[1], 1.5 * row[-1] - 0.5 * row[-2]
    left, right = edges[place], edges[place + 1]
    low = float(np.searchsorted(moments, time[n])) - 0.5
    return [(left, low), (right, low), (right, low + 1.0), (left, low + 1.0)]


def outline(axes, one, cells):
    """Black edges around the cells of significant regions, neighbours in a row as one."""
    inside = sorted(
        (cells[n][0][1], cells[n][0][0], cells[n][1][0])
        for n, region in enumerate(one.region)
        if region is not None
    )
    joined = []
    for low, left, right in inside:
        if joined and joined[-1][0] == low and left - joined[-1][2] < 1.0e-9:
            joined[-1] = (low, joined[-1][1], right)
        else:
            joined.append((low, left, right))
    for low, left, right in joined:
        axes.add_patch(Rectangle((left, low), right - left, 1.0, fill=False, ec="black", lw=1.0))


# -- which effect --------------------------------------------------------------------------------


def evidence(report):
    """Probabilities of all hypotheses, and their ln evidence with its change under wider priors."""
    verdict, hypotheses = report.verdict, report.details.hypotheses
    names = [name for name, _ in ranking(report)][::-1]
    figure = new_figure(WIDTH, 0.9 + 0.25 * len(names))
    left, right = figure.subplots(1, 2, sharey=True)
    rows = np.arange(len(names))
    chances = 100.0 * np.array([verdict.probability[name] for name in names])
    colours = [BLUE if name in verdict.set else "#b9c4cc" for name in names]
    left.barh(rows, chances, color=colours, height=0.7)
    for row, name in zip(rows, names, strict=True):
        chance = verdict.probability[name]
        inside = chance > 0.6
        place = {"ha": "right" if inside else "left", "va": "center", "fontsize": 7.5}
        text = f" {percent(chance)} "
        left.text(100.0 * chance, row, text, color="white" if inside else "black", **place)
    left.set_yticks(rows, [plain(hypothesis_name(name)) for name in names])
    left.set(xlim=(0.0, 100.0), xlabel="probability (%)")
    known = [h.log_evidence for h in hypotheses.values() if h.log_evidence is not None]
    best = max(known, default=0.0)
    for row, name in zip(rows, names, strict=True):
        if name in hypotheses and hypotheses[name].log_evidence is not None:
            draw_evidence(right, row, hypotheses[name], best)
    right.axvline(0.0, color="black", lw=0.8)
    right.set(
        xlim=(1.12 * EVIDENCE_LEAST, 3.0),
        xlabel="ln evidence \N{MINUS SIGN} best",
        xticks=(-30, -20, -10, 0),
    )
    right.grid(axis="x", lw=0.4)
    first = names[-1]
    alt = f"probability of each hypothesis; {hypothesis_name(first)} leads with {percent(verdict.probability[first])}"
    return picture(figure, "evidence", alt, "Probability and evidence of each hypothesis")


def draw_evidence(axes, row, hypothesis, best):
    """Evidence (ln) relative to the best (filled), with priors twice as wide (open)."""
    value = hypothesis.log_evidence - best
    shown = max(value, EVIDENCE_LEAST)
    wide = hypothesis.log_evidence_wide
    if value < EVIDENCE_LEAST:
        axes.plot(shown, row, marker=8, color=GREY, markersize=6)  # an arrow to the left
        axes.text(
            shown + 1.5,
            row,
            f"{value:.0f}".replace("-", "\N{MINUS SIGN}"),
            va="center",
            fontsize=7.5,
        )
        return
    if wide is not None:
        end = max(wide - best, EVIDENCE_LEAST)
        axes.plot([shown, end], [row, row], color=BLUE, lw=1.0)
        axes.plot(end, row, "o", markerfacecolor="white", color=BLUE, markersize=4)
    axes.plot(shown, row, "o", color=BLUE, markersize=4)


def signatures(separability):
    """Matrix of cosines, the classes that cannot be told apart outlined and side by side."""
    order = [separability.names.index(name) for group in separability.classes for name in group]
    matrix = np.array([column(row) for row in separability.cosine])[np.ix_(order, order)]
    names = [hypothesis_name(separability.names[n]) for n in order]
    k = len(names)
    figure = new_figure(WIDTH, 1.2 + (WIDTH - 1.6) * min(1.0, 0.4 + k / 14.0))
    axes = figure.subplots()
    drawn = axes.imshow(matrix, cmap="PuOr_r", vmin=-1.0, vmax=1.0, aspect="auto")
    for (row, place), value in np.ndenumerate(matrix):
        if np.isfinite(value):
            colour = "white" if abs(value) > 0.65 else "black"
            axes.text(
                place, row, cosine_text(value), ha="center", va="center", color=colour, fontsize=7
            )
    axes.set_xticks(range(k), names, rotation=45, ha="right")
    axes.set_yticks(range(k), names)
    start = 0
    for group in separability.classes:
        if len(group) > 1:
            corner, size = (start - 0.5, start - 0.5), len(group)
            axes.add_patch(Rectangle(corner, size, size, fill=False, ec="black", lw=2.2))
        start += len(group)
    bar = figure.colorbar(drawn, ax=axes, location="right", aspect=30, ticks=(-1, -0.5, 0, 0.5, 1))
    bar.set_label("cosine between signatures")
    groups = [
        " and ".join(hypothesis_name(name) for name in group)
        for group in separability.classes
        if len(group) > 1
    ]
    alt = "matrix of the cosine between the signatures of the effects; alike: " + (
        "; ".join(groups) or "none"
    )
    return picture(figure, "signatures", alt, "How alike the effects look in these data")


def cosine_text(value):
    """Two decimals without the leading zero."""
    return f"{value:.2f}".replace("0.", ".").replace("-", "\N{MINUS SIGN}").replace("1.00", "1")


# -- how far -------------------------------------------------------------------------------------


def ladder(report):
    """Gap of each model and the fraction closed, in fitted and held-out experiments."""
    rungs = report.details.ladder[::-1]
    figure = new_figure(WIDTH, 1.2 + 0.62 * len(rungs))
    left, right = figure.subplots(1, 2, sharey=True)
    for row, rung in enumerate(rungs):
        draw_rung(left, right, row + 0.14, rung.fitted, BLUE, "o", "fitted")
        if rung.held_out is not None:
            draw_rung(left, right, row - 0.14, rung.held_out, ORANGE, "s", "held out")
    labels = [f"{RUNGS[rung.model]}  {model_name(rung.model, report)}" for rung in rungs]
    left.set_yticks(range(len(rungs)), [plain(broken(text)) for text in labels])
    left.set(xlabel="rms gap in combined\nstandard uncertainties", ylim=(-0.5, len(rungs) - 0.5))
    left.set_xlim(left=0.0)
    right.axvline(0.0, color="black", lw=0.8)
    right.set(xlabel="share of the gap of G0\nthat is closed (%)")
    for axes in (left, right):
        axes.grid(axis="x", lw=0.4)
    shared_legend(figure, left, right)
    alt = "gap of the model as given, re-calibrated, and with the first and second effect"
    return picture(figure, "ladder", alt, "How far the gap shrinks")


def draw_rung(left, right, row, misfit, colour, marker, word):
    """One model over one group: rms gap (single experiments small), fraction closed with its range."""
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
            label="predicted before running it",
        )


def broken(text, width=20):
    """The text in lines of about `width` letters."""
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)


# -- uncertainty ---------------------------------------------------------------------------------


def budget(report):
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
