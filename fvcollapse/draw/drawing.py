"""Parts that the pictures share: the frame of a pile, grains cut out along the surface, the gate.

Figures are made without pyplot, so that nothing global is touched.
"""

import io

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fvcollapse.effects.catalogue import with_effects
from fvcollapse.step.erodible_bed import layer_thickness
from fvcollapse.step.gate import gate_height, gate_lift

BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#666666"  # Okabe & Ito (2008)
WIDTH = 9.0  # inch
DPI = 130
COLOURMAP = {"speed": "viridis", "pressure": "cividis"}
GAMMA = {"speed": 0.5, "pressure": 1.0}  # root of the speed: slow parts show
LABEL = {"speed": "speed (m/s)", "pressure": "pressure (Pa)"}


def new_figure(width, height):
    """An empty figure of which pyplot knows nothing."""
    figure = Figure(figsize=(width, height), layout="constrained", dpi=DPI)
    figure.get_layout_engine().set(h_pad=0.03, hspace=0.02)
    FigureCanvasAgg(figure)
    return figure


def png(figure):
    """The figure as PNG bytes."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", bbox_inches="tight")
    return stream.getvalue()


def panel_column(result, count, bar=False):
    """A column of panels of the whole pile on equal axes."""
    long, high = extent(result)
    height = (WIDTH - (2.0 if bar else 0.9)) * high / long + 0.12
    figure = new_figure(WIDTH, 0.8 + count * height)
    panels = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for axes in panels:
        frame(axes, long, high)
        axes.label_outer()
    return figure, panels


def frame(axes, long, high, exaggeration=1.0):
    """Limits, labels and aspect of a picture of the pile."""
    axes.set(xlim=(0.0, long), ylim=(0.0, high), xlabel="x (m)", ylabel="z (m)")
    axes.set_aspect(exaggeration)
    axes.locator_params(axis="y", nbins=4)


def extent(result):
    """Length and height of the pictures, m: a little more than the grains fill at any time."""
    x, h = result.profiles.x, result.profiles.thickness.max(axis=0)
    length = x[reach(x, h)][-1]
    high = h.max() + layer_thickness(result.case)
    return 1.03 * max(length, x[1]), 1.12 * max(high, x[1])


def reach(x, h):
    """Slice of the abscissae up to the first abscissa beyond the grains."""
    filled = np.flatnonzero(h > 0.0)
    return slice(0, min(filled[-1] + 2, len(x)) if filled.size else 1)


def times_of_progress(result, times, progress):
    """Indices into `times` at which the front has covered given fractions of its advance, and the last."""
    runout = np.interp(times, result.time, result.runout)
    goals = runout[0] + np.asarray(progress) * (runout[-1] - runout[0])
    indices = [int(np.argmax(runout >= goal)) for goal in goals[:-1]]
    return sorted({*indices, len(times) - 1})


def time_limits(time):
    """Limits of a time axis, also of a run without duration."""
    return (time[0], time[-1] if time[-1] > time[0] else time[0] + 1.0)


def sequence(count):
    """Colours from dark (early) to light (late)."""
    return colormaps["viridis"](np.linspace(0.0, 0.9, count))


def stamp(axes, time):
    """The time in the corner of a panel."""
    axes.text(0.99, 0.93, f"t = {time:.2f} s", transform=axes.transAxes, ha="right", va="top")


def title(axes, result, what):
    """Set the title of a picture: quantity, slope and width of the channel."""
    geometry, width = result.case.geometry, result.case.geometry.channel_width
    channel = f", channel {100 * width:g} cm wide" if np.isfinite(width) else ""
    axes.set_title(f"{what} — slope {geometry.slope_angle_deg:g}°{channel}", fontsize="medium")


# -- fields ----


def draw_grains(axes, field, name, top):
    """Coloured cells inside the surface, and the surface as a line; return the artists."""
    x = field["dx"] * np.arange(field["level_set"].shape[0])
    z = field["dz"] * np.arange(field["level_set"].shape[1])
    phi = field["level_set"].T
    if not (phi < 0.0).any():
        return []
    mesh = axes.pcolormesh(
        x, z, quantity(field, name).T, cmap=COLOURMAP[name], norm=norm(name, top)
    )
    inside = axes.contourf(x, z, phi, [min(phi.min(), -1.0), 0.0], alpha=0.0)
    mesh.set_clip_path(inside.get_paths()[0], axes.transData)
    if not (phi > 0.0).any():
        return [mesh, inside]
    line = axes.contour(x, z, phi, [0.0], colors="black", linewidths=0.8)
    return [mesh, inside, line]


def quantity(field, name):
    """A cell-centred quantity of a field."""
    if name == "speed":
        u, w = field["u"], field["w"]
        return np.hypot(0.5 * (u[:-1] + u[1:]), 0.5 * (w[:, :-1] + w[:, 1:]))
    return field[name]


def norm(name, top):
    """Colour scale from zero to `top`; less than zero is shown as zero."""
    return PowerNorm(GAMMA[name], 0.0, top, clip=True)


def largest(field, name):
    """Largest value in the cells whose centre is in the grains; 1e-12 at least."""
    phi = field["level_set"]
    centre = 0.25 * (phi[:-1, :-1] + phi[1:, :-1] + phi[:-1, 1:] + phi[1:, 1:])
    return float(quantity(field, name)[centre < 0.0].max(initial=1e-12))


def colour_bar(figure, panels, name, top):
    """Colour bar beside a column of panels."""
    scale = ScalarMappable(norm(name, top), COLOURMAP[name])
    ticks = MaxNLocator(5)  # more would overlap at the compressed end of the scale
    figure.colorbar(scale, ax=list(panels), label=LABEL[name], fraction=0.05, pad=0.02, ticks=ticks)


def draw_gate(axes, case, time, origin=0.0):
    """The gate, as far as it is still in the picture, with z measured from `origin`; return the artists."""
    top = axes.get_ylim()[1]
    case = with_effects(case)
    bottom = gate_height(time, gate_lift(case)) - origin
    if not bottom < top:
        return []
    length_0 = case.geometry.length_0
    return axes.plot([length_0, length_0], [bottom, top], color=ORANGE, lw=2.0)
