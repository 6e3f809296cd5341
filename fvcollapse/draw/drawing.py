"""Parts that the pictures share: the frame of a pile, its times, the gate.

Figures are made without pyplot, so that nothing global is touched.
"""

import io
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fvcollapse.case.words import set_up_words
from fvcollapse.draw.look import DPI, View
from fvcollapse.step.erodible_bed import layer_thickness
from fvcollapse.step.gate import gate_height, gate_lift

BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#666666"  # Okabe & Ito (2008)
WIDTH = 9.0  # inch
# no dates: the same picture is the same file
UNDATED = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}


class Picture(Figure):
    """A figure that notebooks show by themselves, whatever their backend."""

    def savefig(self, *arguments: Any, **options: Any) -> None:
        """As that of matplotlib, cut to what is drawn."""
        super().savefig(*arguments, **{"bbox_inches": "tight"} | options)

    def _repr_png_(self) -> bytes:
        return png(self)


def new_figure(width: float, height: float) -> Picture:
    """An empty figure of which pyplot knows nothing; sizes in inches."""
    figure = Picture(figsize=(width, height), layout="constrained", dpi=DPI)
    layout: Any = figure.get_layout_engine()
    layout.set(h_pad=0.03, hspace=0.02)
    FigureCanvasAgg(figure)
    return figure


def png(figure: Figure) -> bytes:
    """The figure as PNG."""
    return image_of(figure, "png", DPI)


def image_of(figure: Figure, kind: str, dpi: int) -> bytes:
    """The figure as a file of a format (one of `look.FORMATS`)."""
    stream = io.BytesIO()
    figure.savefig(stream, format=kind, dpi=dpi, metadata=UNDATED[kind])
    return stream.getvalue()


def panel_column(
    result: Any, view: View, count: int, bar: bool = False
) -> tuple[Picture, np.ndarray]:
    """A column of panels of the whole pile with equal scales, and the arrow of gravity in the first."""
    long, high = extent(result)
    (x_0, z_0), (x_1, z_1) = view.limits(long, high)
    height = (WIDTH - (2.0 if bar else 0.9)) * (z_1 - z_0) / (x_1 - x_0) + 0.12
    figure = new_figure(WIDTH, 0.8 + count * height)
    panels = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for axes in panels:
        frame(axes, view, long, high)
        axes.label_outer()
    view.draw_gravity(panels[0])
    return figure, panels


def frame(axes: Axes, view: View, long: float, high: float, exaggeration: float = 1.0) -> None:
    """Limits, labels and aspect of a picture of the pile, and its walls."""
    (x_0, z_0), (x_1, z_1) = view.limits(long, high)
    names = ("horizontally (m)", "up (m)") if view.upright else ("x (m)", "z (m)")
    axes.set(xlim=(x_0, x_1), ylim=(z_0, z_1), xlabel=names[0], ylabel=names[1])
    axes.set_aspect(exaggeration)
    axes.locator_params(axis="y", nbins=4)
    view.draw_walls(axes, long, high)


def extent(result: Any) -> tuple[float, float]:
    """Length and height of the pictures, m: a little more than the grains fill at any time."""
    x, h = result.profiles.x, result.profiles.thickness.max(axis=0)
    length = x[reach(x, h)][-1]
    high = h.max() + layer_thickness(result.case)
    return 1.03 * max(length, x[1]), 1.12 * max(high, x[1])


def reach(x: np.ndarray, h: np.ndarray) -> slice:
    """Slice of the abscissae up to the first abscissa beyond the grains."""
    filled = np.flatnonzero(h > 0.0)
    return slice(0, min(filled[-1] + 2, len(x)) if filled.size else 1)


def chosen_times(
    result: Any, times: np.ndarray, progress: tuple[float, ...], wanted: tuple[float, ...] = ()
) -> list[int]:
    """Indices into stored `times`: those nearest to what is wanted, else those of the progress of the front."""
    if wanted:
        return sorted({int(np.argmin(np.abs(times - time))) for time in wanted})
    return times_of_progress(result, times, progress)


def times_of_progress(result: Any, times: np.ndarray, progress: tuple[float, ...]) -> list[int]:
    """Indices into `times` at which the front has covered given fractions of its advance, and the last."""
    runout = np.interp(times, result.time, result.runout)
    goals = runout[0] + np.asarray(progress) * (runout[-1] - runout[0])
    indices = [int(np.argmax(runout >= goal)) for goal in goals[:-1]]
    return sorted({*indices, len(times) - 1})


def time_limits(time: np.ndarray) -> tuple[float, float]:
    """Limits of a time axis, also of a run without duration."""
    return (time[0], time[-1] if time[-1] > time[0] else time[0] + 1.0)


def sequence(count: int) -> np.ndarray:
    """Colours from dark (early) to light (late), (count, 4)."""
    return colormaps["viridis"](np.linspace(0.0, 0.9, count))


def stamp(axes: Axes, time: float) -> None:
    """The time in the corner of a panel."""
    axes.text(0.99, 0.93, f"t = {time:.2f} s", transform=axes.transAxes, ha="right", va="top")


def title(axes: Axes, result: Any, what: str) -> None:
    """Set the title of a picture: quantity, slope and width of the channel."""
    axes.set_title(f"{what} — {set_up_words(result.case)}", fontsize="medium")


def draw_gate(axes: Axes, case: Any, time: float, view: View, origin: float = 0.0) -> list:
    """The gate, as far as it is still in the picture, with z measured from `origin`; return the artists."""
    top = axes.get_ylim()[1]
    case = case.resolved
    bottom = gate_height(time, gate_lift(case)) - origin
    if not bottom < top:
        return []
    length_0 = case.geometry.length_0
    gate = ([length_0, length_0], [bottom, top])
    return axes.plot(*gate, color=ORANGE, lw=2.0, transform=view.bed(axes))
