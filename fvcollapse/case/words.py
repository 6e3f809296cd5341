"""A case in words, for titles and captions."""

from math import isfinite
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def set_up_words(case: "Case") -> str:
    """Slope and channel of a case in words."""
    geometry, width = case.geometry, case.geometry.channel_width
    channel = f", channel {100 * width:g} cm wide" if isfinite(width) else ""
    return f"slope {geometry.slope_angle_deg:g}°{channel}"
