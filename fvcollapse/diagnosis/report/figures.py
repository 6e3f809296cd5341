"""All figures of a report, by the chapter of the page that shows them."""

import matplotlib

from fvcollapse.diagnosis.report.cause_figures import evidence, signatures
from fvcollapse.diagnosis.report.drawing import STYLE
from fvcollapse.diagnosis.report.gap_figures import gap_map
from fvcollapse.diagnosis.report.overlays import overlay
from fvcollapse.diagnosis.report.reduction_figures import budget, ladder
from fvcollapse.diagnosis.report.scalar_figures import scalars
from fvcollapse.measure.quantities import CURVES


def pictures(report):
    """Every figure of a report, by the chapter of the page that shows it.

    Returns
    -------
    dict of str -> list of Picture
        "overlays", "scalars", "gap_maps", "evidence", "signatures", "ladder", "budget"; a chapter without data
        has an empty list.
    """
    details = report.details
    with matplotlib.rc_context(STYLE):
        return {
            "overlays": [overlay(report, one) for one in drawable(report)],
            "scalars": [scalars(report)] if has_scalars(report) else [],
            "gap_maps": [gap_map(report, one) for one in drawable(report) if one.x is not None],
            "evidence": [evidence(report)],
            "signatures": [signatures(details.separability)] if details.separability else [],
            "ladder": [ladder(report)] if details.ladder else [],
            "budget": [budget(report)] if details.budget else [],
        }


def has_scalars(report):
    """Whether a single number other than 0 was measured."""
    return any(one.time is None and any(one.measured) for one in report.details.comparisons)


def drawable(report):
    """Comparisons that are curves, experiment after experiment, the front first."""
    order = {name: n for n, name in enumerate(CURVES)}
    names = [*report.experiments, *report.held_out]
    curves = [one for one in report.details.comparisons if one.time is not None]
    return sorted(
        curves, key=lambda one: (names.index(one.experiment), order.get(one.observable, len(order)))
    )
