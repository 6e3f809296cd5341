"""Significant regions of the gap in words."""

import numpy as np

from fvcollapse.diagnosis.report.words import hundredths, number, span
from fvcollapse.measure.quantities import QUANTITIES, direction_words, observable_words, shown_gap


def region_lines(points, regions):
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
        if is_earliest(region, regions) and region.t_range[0] > first_time(points, region):
            text += f"; nothing significant before {region.t_range[0]:.2f} s"
        lines.append(text)
    return lines


def is_earliest(region, regions):
    """Whether no region of the same run begins before this one; a number has no time."""
    starts = [
        other.t_range[0]
        for other in regions
        if other.experiment == region.experiment and other.t_range
    ]
    return bool(region.t_range) and region.t_range[0] == min(starts)


def block_of(points, region):
    """The `Block` of the points of a region."""
    return next(block for block in points.blocks if block.start <= region.points[0] < block.stop)


def first_time(points, region):
    """Time of the first point of the run of a region."""
    return float(np.nanmin(points.time[points.of(region.experiment)]))


def region_line(region, block):
    """One line: what, how much, in which direction, where and when."""
    factor, unit = QUANTITIES[region.observable].gap_shown
    size = size_words(factor * abs(region.gap), factor * region.uncertainty)
    direction = direction_words(region.observable, region.gap)
    text = f"{observable_words(region.observable)} {size} {unit} {direction}"
    if block.kind != "value":
        text += f" (beyond the {block.kind} bound)"
    if region.x_range:
        text += f", X = {region.x_range[0]:.2f} to {region.x_range[1]:.2f} m"
    if region.t_range:
        text += time_words(*region.t_range, float(np.max(block.time)))
    return text


def size_words(size, uncertainty):
    """A size with its uncertainty, which has one figure, from 10 to 19 two."""
    decade = int(np.floor(np.log10(uncertainty)))
    digits = max(0, -decade + (uncertainty < 2.0 * 10.0**decade))
    return f"{size:.{digits}f} \N{PLUS-MINUS SIGN} {uncertainty:.{digits}f}"


def time_words(start, stop, last):
    """When a region is there; `last` is the last time that was measured."""
    if start == stop:
        return f" at {start:.2f} s"
    if stop == last:
        return f" from {start:.2f} s on"
    return f" from {start:.2f} to {stop:.2f} s"


def region_words(region):
    """One plain sentence for a region."""
    if region.words:
        return region.words
    factor, shown = shown_gap(region.observable, region.units)
    spread = f" \N{PLUS-MINUS SIGN} {number(factor * region.gap_sd, 2)}" if region.gap_sd else ""
    size = f"{number(factor * abs(region.gap), 2)}{spread} {shown}".rstrip()
    side = direction_words(region.observable, region.gap)
    text = f"simulated {observable_words(region.observable)} {size} {side}"
    if region.t_range is not None:
        text += f" from {span(region.t_range, hundredths)} s"
    if region.x_range is not None:
        text += f", at x = {span(region.x_range, hundredths)} m"
    return text
