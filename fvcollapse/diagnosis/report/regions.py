"""Significant regions of the gap in words."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fvcollapse.diagnosis.report.words import CENTIMETRES, number
from fvcollapse.measure.quantities import direction_words, observable_words, shown_gap

if TYPE_CHECKING:
    from fvcollapse.diagnosis.gap_map import Region
    from fvcollapse.diagnosis.points import Block, Points
    from fvcollapse.diagnosis.report import schema as form


def region_lines(points: "Points", regions: "Sequence[Region]") -> list[str]:
    """One line for each region; the earliest of a run also says that nothing before it is significant.

    Parameters
    ----------
    points : Points
    regions : sequence of gap_map.Region

    Returns
    -------
    list of str
    """
    lines = []
    for region in regions:
        text = region_line(region, block_of(points, region))
        span = region.t_range
        if span and is_earliest(region, regions) and span[0] > first_time(points, region):
            text += f"; nothing significant before {span[0]:.2f} s"
        lines.append(text)
    return lines


def is_earliest(region: "Region", regions: "Sequence[Region]") -> bool:
    """Whether no region of the same run begins before this one; a number has no time."""
    starts = [
        other.t_range[0]
        for other in regions
        if other.experiment == region.experiment and other.t_range
    ]
    return region.t_range is not None and region.t_range[0] == min(starts)


def block_of(points: "Points", region: "Region") -> "Block":
    """The `Block` of the points of a region."""
    return next(block for block in points.blocks if block.start <= region.points[0] < block.stop)


def first_time(points: "Points", region: "Region") -> float:
    """Time of the first point of the run of a region."""
    return float(np.nanmin(points.time[points.of(region.experiment)]))


def region_line(region: "Region", block: "Block") -> str:
    """One line for a region of the gap map: what, how much, in which direction, where and when."""
    return composed(region, region.uncertainty, float(np.max(block.time)), block.kind)


def region_words(region: "form.Region", report: "form.Report") -> str:
    """One line for a region of a report, in the units of its page.

    What the line of the file says after its semicolon, that nothing before is significant, stays.
    """
    same = [
        one
        for one in report.details.comparisons
        if (one.experiment, one.observable) == (region.experiment, region.observable)
    ]
    timed = [one.time for one in same if one.time is not None]
    last = max((t for time in timed for t in time if t is not None), default=None)
    text = composed(region, region.gap_sd, last, same[0].kind if same else "value")
    rest = region.words.partition("; ")[2]
    return f"{text}; {rest}" if rest else text


def composed(
    region: "Region | form.Region", uncertainty: float | None, last: float | None, kind: str
) -> str:
    """The words of a region.

    Parameters
    ----------
    region : gap_map.Region or schema_gap.Region
    uncertainty : float or None
        Standard uncertainty of its gap, SI.
    last : float or None
        Last time at which the observable was measured [s].
    kind : str
        "value", or the bound: "upper", "lower".
    """
    factor, unit = shown_gap(region.observable, region.units)
    gap = factor * abs(region.gap)
    size = size_words(gap, factor * uncertainty) if uncertainty else number(gap, 2)
    direction = direction_words(region.observable, region.gap)
    text = f"{observable_words(region.observable)} {size} {unit}".rstrip() + f" {direction}"
    if kind != "value":
        text += f" (beyond the {kind} bound)"
    if region.x_range is not None:
        first, last_place = map(centimetres, region.x_range)
        place = first if first == last_place else f"{first} to {last_place}"
        text += f", X = {place} cm"
    if region.t_range is not None:
        text += time_words(*region.t_range, last)
    return text


def centimetres(metres: float) -> str:
    """A length in cm without decimals."""
    return f"{CENTIMETRES * metres:.0f}"


def size_words(size: float, uncertainty: float) -> str:
    """A size with its uncertainty, which has one figure, from 10 to 19 two."""
    decade = int(np.floor(np.log10(uncertainty)))
    digits = max(0, -decade + (uncertainty < 2.0 * 10.0**decade))
    return f"{size:.{digits}f} \N{PLUS-MINUS SIGN} {uncertainty:.{digits}f}"


def time_words(start: float, stop: float, last: float | None) -> str:
    """When a region is there; `last` is the last time that was measured."""
    if start == stop:
        return f" at {start:.2f} s"
    if stop == last:
        return f" from {start:.2f} s on"
    return f" from {start:.2f} to {stop:.2f} s"
