"""What all figures of the report share.

Each is a small SVG, narrow enough to be read on a telephone; the page lays them side by side where there
is room. Colours are those of Okabe & Ito (2008) and the map RdBu; no meaning rests on colour alone.
"""

import io
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import quote

import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 4.2  # inch: letters of 9 points are 11 pixels high on a telephone
STYLE = {"font.size": 9.0, "axes.titlesize": 9.0, "svg.fonttype": "none", "svg.hashsalt": "report"}
STYLE |= {"axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.6}
GAP_UNITS = "gap in combined standard uncertainties"


class Picture(NamedTuple):
    """A figure as SVG bytes, its name (of a file) and what it shows, in words, for the page.

    `experiment` is the one it belongs to; empty: all.
    """

    name: str
    svg: bytes
    alt: str
    caption: str
    experiment: str = ""


def picture(figure: "Figure", name: str, alt: str, caption: str, experiment: str = "") -> Picture:
    """The figure as a `Picture`, of the size that it was given: to cut it to what is drawn, it would be drawn twice."""
    lay_out(figure)
    stream = io.BytesIO()
    undated = {"Date": None, "Creator": None}
    figure.savefig(stream, format="svg", metadata=undated, bbox_inches=None)
    svg = lighter(stream.getvalue().decode()).encode()
    return Picture(name, svg, alt, caption, experiment)


def lay_out(figure: "Figure") -> None:
    """Place the parts of a figure for good, as its layout engine has it: saved, it is drawn once and not twice."""
    FigureCanvasSVG(figure)
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    figure.set_layout_engine("none")


def lighter(svg: str) -> str:
    """The SVG without indentation, its coordinates to a hundredth of a point."""
    svg = re.sub(r"<metadata>.*?</metadata>", "", re.sub(r"\n\s*", " ", svg))
    shorten = re.compile(r"(\.\d\d)\d+")
    return re.sub(r' (?:d|x|y|transform)="[^"]*"', lambda found: shorten.sub(r"\1", found[0]), svg)


def file_name(*parts: str) -> str:
    """A name that any file system takes; different for different parts."""
    return quote("_".join(parts), safe="")


def plain(text: str) -> str:
    """Text that matplotlib prints as it is."""
    return text.replace("$", r"\$")


def column(values: Iterable[float | None]) -> np.ndarray:
    """A column of a comparison as an array, NaN for gaps."""
    return np.array([np.nan if value is None else value for value in values], float)


def shared_legend(
    figure: "Figure", *panels: "Axes", beside: "Sequence[Axes] | np.ndarray" = ()
) -> None:
    """One legend below all panels (or in an empty one), each entry once; long ones in two lines."""
    found = [panel.get_legend_handles_labels() for panel in panels]
    named = {word: handle for pair in found for handle, word in zip(*pair, strict=True)}
    words = [broken(word, 24) for word in named]
    form = {"frameon": False, "fontsize": 8}
    if len(beside):
        beside[0].legend(named.values(), words, loc="center", borderaxespad=0.0, **form)
    else:
        figure.legend(named.values(), words, loc="outside lower center", ncols=2, **form)


def broken(text: str, width: int = 20) -> str:
    """The text in lines of about `width` letters."""
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)
