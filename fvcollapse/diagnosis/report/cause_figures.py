"""Figures of the evidence of the hypotheses and of the likeness of their signatures."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Rectangle

from fvcollapse.diagnosis.report.drawing import WIDTH, broken, column, picture, plain
from fvcollapse.diagnosis.report.words import hypothesis_name, percent, ranking
from fvcollapse.draw.drawing import BLUE, GREY, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Report, Separability

NAME_WIDTH = 22  # letters in a line
SECOND_LINE = 0.6  # height of one more line of a name, in rows
EVIDENCE_LEAST = -30.0  # ln: what is worse is drawn here, with its number


def evidence(report: "Report") -> "Picture":
    """Probabilities of all hypotheses, and their ln evidence with its change under wider priors."""
    verdict, hypotheses = report.verdict, report.details.hypotheses
    names = [name for name, _ in ranking(report)][::-1]
    labels = [broken(hypothesis_name(name), NAME_WIDTH) for name in names]
    heights = np.array([1.0 + SECOND_LINE * label.count("\n") for label in labels])
    rows = np.cumsum(heights) - 0.5 * heights
    figure = new_figure(WIDTH, 0.9 + 0.25 * heights.sum())
    left, right = figure.subplots(1, 2, sharey=True)
    chances = 100.0 * np.array([verdict.probability[name] for name in names])
    colours = [BLUE if name in verdict.set else "#b9c4cc" for name in names]
    left.barh(rows, chances, color=colours, height=0.7)
    for row, name in zip(rows, names, strict=True):
        chance = verdict.probability[name]
        inside = chance > 0.6
        place = {"ha": "right" if inside else "left", "va": "center", "fontsize": 7.5}
        text = f" {percent(chance)} "
        left.text(100.0 * chance, row, text, color="white" if inside else "black", **place)
    left.set_yticks(rows, [plain(label) for label in labels])
    left.set(xlim=(0.0, 100.0), ylim=(0.0, heights.sum()), xlabel="probability (%)")
    known = [h.log_evidence for h in hypotheses.values() if h.log_evidence is not None]
    best = max(known, default=0.0)
    for row, name in zip(rows, names, strict=True):
        if name in hypotheses and (value := hypotheses[name].log_evidence) is not None:
            draw_evidence(right, row, value, hypotheses[name].log_evidence_wide, best)
    right.axvline(0.0, color="black", lw=0.8)
    right.set(
        xlim=(1.12 * EVIDENCE_LEAST, 3.0),
        xlabel="ln evidence\n\N{MINUS SIGN} that of the best",
        xticks=(-30, -15, 0),
    )
    right.grid(axis="x", lw=0.4)
    first = names[-1]
    alt = f"probability of each hypothesis; {hypothesis_name(first)} leads with {percent(verdict.probability[first])}"
    return picture(figure, "evidence", alt, "Probability and evidence of each hypothesis")


def draw_evidence(axes: "Axes", row: float, own: float, wide: float | None, best: float) -> None:
    """Evidence (ln) relative to the best: `own` filled, `wide`, with priors twice as wide, open."""
    value = own - best
    shown = max(value, EVIDENCE_LEAST)
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


def signatures(separability: "Separability") -> "Picture":
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


def cosine_text(value: float) -> str:
    """Two decimals without the leading zero."""
    return f"{value:.2f}".replace("0.", ".").replace("-", "\N{MINUS SIGN}").replace("1.00", "1")
