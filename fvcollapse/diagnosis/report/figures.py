"""All figures of a report, by the chapter of the page that shows them."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import matplotlib

from fvcollapse.diagnosis.report.cause_figures import evidence, signatures
from fvcollapse.diagnosis.report.drawing import STYLE
from fvcollapse.diagnosis.report.gap_figures import gap_map
from fvcollapse.diagnosis.report.overlays import overlay
from fvcollapse.diagnosis.report.reduction_figures import budget, ladder
from fvcollapse.diagnosis.report.scalar_figures import scalars
from fvcollapse.measure.quantities import CURVES

if TYPE_CHECKING:
    from fvcollapse.diagnosis.report.drawing import Picture
    from fvcollapse.diagnosis.report.schema import Comparison, Report

    # chapter, function, its arguments
    Drawing = tuple[str, Callable[..., Picture], *tuple[Any, ...]]

CHAPTERS = ("overlays", "scalars", "gap_maps", "evidence", "signatures", "ladder", "budget")


def pictures(
    report: "Report", draw: "Callable[[Report, int], list[Picture]] | None" = None
) -> "dict[str, list[Picture]]":
    """Every figure of a report, by the chapter of the page that shows it.

    Parameters
    ----------
    report : Report
    draw : function, optional
        Draws the figures of (report, their number), in the order of `drawings`; default in this process. See `Painter`.

    Returns
    -------
    dict of str -> list of Picture
        Of all `CHAPTERS`; a chapter without data has an empty list.
    """
    chapters = [chapter for chapter, *_ in drawings(report)]
    made = drawn(report) if draw is None else draw(report, len(chapters))
    shown: dict[str, list[Picture]] = {chapter: [] for chapter in CHAPTERS}
    for chapter, picture in zip(chapters, made, strict=True):
        shown[chapter].append(picture)
    return shown


def drawn(report: "Report", some: slice = slice(None)) -> "list[Picture]":
    """The `Picture`s of a report, or some of them."""
    with matplotlib.rc_context(STYLE):  # type: ignore[arg-type]
        return [function(*arguments) for _, function, *arguments in drawings(report)[some]]


def drawings(report: "Report") -> "list[Drawing]":
    """(chapter, function, arguments, ...) of every figure of a report, in the order of `CHAPTERS`."""
    details, curves = report.details, drawable(report)
    made: list[Drawing] = [("overlays", overlay, report, one) for one in curves]
    if has_scalars(report):
        made.append(("scalars", scalars, report))
    made += [("gap_maps", gap_map, report, one) for one in curves if one.x is not None]
    made.append(("evidence", evidence, report))
    if details.separability:
        made.append(("signatures", signatures, details.separability))
    if details.ladder:
        made.append(("ladder", ladder, report))
    if details.budget:
        made.append(("budget", budget, report))
    return made


def has_scalars(report: "Report") -> bool:
    """Whether a single number other than 0 was measured."""
    return any(one.time is None and any(one.measured) for one in report.details.comparisons)


def drawable(report: "Report") -> "list[Comparison]":
    """Comparisons that are curves, experiment after experiment, the front first."""
    order = {name: n for n, name in enumerate(CURVES)}
    names = [*report.experiments, *report.held_out]
    curves = [one for one in report.details.comparisons if one.time is not None]
    return sorted(
        curves, key=lambda one: (names.index(one.experiment), order.get(one.observable, len(order)))
    )
