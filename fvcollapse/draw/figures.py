"""The standard figures of a result; nothing physical is computed here.

Metres on equal scales unless the picture states an exaggeration. The grains are cut out along the surface
itself (the zero line of the level set), not along the cells.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fvcollapse.draw.curves import LEAST_VOLUME, show_at_least
from fvcollapse.draw.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    WIDTH,
    Picture,
    chosen_times,
    draw_gate,
    extent,
    frame,
    new_figure,
    panel_column,
    reach,
    sequence,
    stamp,
    time_limits,
    title,
)
from fvcollapse.draw.grains import colour_bar, draw_grains, largest
from fvcollapse.draw.look import Look, View, view_of
from fvcollapse.errors import InputError
from fvcollapse.step.erodible_bed import layer_thickness

STATIC, FLOWING = "#8C8C8C", "#E8C98A"
PROFILE_PROGRESS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)  # fractions of the advance of the front
FIELD_PROGRESS = (0.02, 0.3, 0.7, 1.0)
EXAGGERATION = 2.5  # of heights in the picture of the profiles
RETREAT = 1.0e-3  # m by which a front has run back that is explained
USUAL = Look()


def draw_profiles(result: Any, look: Look = USUAL) -> Picture:
    """Thickness profiles while the front advances, over the bed, with heights exaggerated."""
    times, x, h, _ = result.profiles
    chosen = chosen_times(result, times, PROFILE_PROGRESS, look.times)
    long, high = extent(result)
    figure = new_figure(WIDTH, 0.8 + (WIDTH - 0.8) * EXAGGERATION * high / long)
    axes = figure.subplots()
    for colour, j in zip(sequence(len(chosen)), chosen, strict=True):
        seen = reach(x, h[j])
        axes.plot(x[seen], h[j][seen], color=colour, label=f"{times[j]:.2f} s")
    frame(axes, View(0.0), long, high, EXAGGERATION)
    axes.legend(title="time", ncols=2, frameon=False)
    title(axes, result, f"thickness, heights × {EXAGGERATION:g}")
    return figure


def draw_interface(result: Any, look: Look = USUAL) -> Picture:
    """Static and flowing part of the pile."""
    times, x, h, static = result.profiles
    chosen, view = chosen_times(result, times, FIELD_PROGRESS, look.times), view_of(result, look)
    figure, panels = panel_column(result, view, len(chosen))
    for axes, j in zip(panels, chosen, strict=True):
        place: dict[str, Any] = {"transform": view.bed(axes), "lw": 0}
        axes.fill_between(x, 0.0, static[j], color=STATIC, label="static", **place)
        moving = {"color": FLOWING, "label": "flowing (> 0.01 m/s)"}
        axes.fill_between(x, static[j], h[j], **moving, **place)
        seen = reach(x, h[j])
        axes.plot(x[seen], h[j][seen], color="black", lw=1.0, transform=view.bed(axes))
        draw_gate(axes, result.case, times[j], view, layer_thickness(result.case))
        stamp(axes, times[j])
    corner = "lower left" if look.upright else "lower right"
    panels[0].legend(loc=corner, ncols=2, frameon=False, fontsize="small")
    title(panels[0], result, "static–flowing interface, equal scales")
    return figure


def draw_front(result: Any, look: Look = USUAL) -> Picture:
    """Front position and front velocity against time."""
    figure = new_figure(WIDTH, 6.0)
    above, below = figure.subplots(2, 1, sharex=True)
    time, limit = result.time, 1000.0 * result.case.front.thickness
    above.plot(time, result.front_position, color=BLUE, label=f"front at {limit:g} mm")
    above.plot(time, result.runout_1mm, color=GREY, ls=":", label="runout at 1 mm")
    above.plot(time, result.runout_10mm, color=GREY, ls="--", label="runout at 10 mm")
    above.plot(time, result.x_99, color=ORANGE, ls="-.", label="99 % of the volume")
    above.set(ylabel="x (m)", ylim=(0.0, None))
    above.legend(frameon=False)
    explain_retreat(above, result)
    below.plot(time, result.front_velocity, color=BLUE)
    below.set(xlabel="time (s)", ylabel="front velocity (m/s)", xlim=time_limits(time))
    below.axhline(0.0, color="black", lw=0.5)
    title(above, result, "front")
    return figure


def explain_retreat(axes: Axes, result: Any) -> None:
    """Say why a front runs back, where it does."""
    if retreat(result) < RETREAT:
        return
    farthest = int(np.argmax(result.front_position))
    limit = 1000.0 * result.case.front.thickness
    place = (result.time[farthest], result.front_position[farthest])
    words = f"from here on the tip is thinner than {limit:g} mm:\nthe grains do not run back"
    arrow = {"arrowstyle": "->", "color": BLUE}
    style: dict[str, Any] = {
        "ha": "center",
        "va": "top",
        "fontsize": "small",
        "color": BLUE,
        "arrowprops": arrow,
    }
    axes.annotate(words, place, (0.55, 0.32), textcoords="axes fraction", **style)


def retreat(result: Any) -> float:
    """How far the front ends behind its farthest place [m]."""
    return float(result.front_position.max() - result.front_position[-1])


def draw_volume(result: Any, look: Look = USUAL) -> Picture:
    """Volume error and running sum of the volume corrections against time."""
    figure = new_figure(WIDTH, 5.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(result.time, 100.0 * result.relative_volume, color=BLUE)
    above.set_ylabel("volume error (%)")
    show_at_least(above, LEAST_VOLUME)
    below.plot(result.time, 100.0 * result.volume_correction, color=ORANGE, label="corrections")
    below.plot(result.time, 100.0 * result.detached_volume, color=GREEN, ls="--", label="detached")
    below.set(xlabel="time (s)", ylabel="part of the volume (%)", xlim=time_limits(result.time))
    below.legend(frameon=False)
    title(above, result, "volume; running sum of |corrections|; part beyond the 1 mm front")
    return figure


def draw_field(result: Any, name: str, look: Look = USUAL) -> Picture:
    """A field at some times, cut out along the surface.

    Raises
    ------
    InputError
        The result has no such field, or no fields at all.
    """
    refuse_no_field(result, name)
    chosen = chosen_times(result, result.field_times, FIELD_PROGRESS, look.times)
    fields, view = [result.field(j) for j in chosen], view_of(result, look)
    top = max(largest(field, name) for field in fields)
    figure, panels = panel_column(result, view, len(chosen), bar=True)
    for axes, field in zip(panels, fields, strict=True):
        draw_grains(axes, field, name, top, view)
        draw_gate(axes, result.case, field["time"], view)
        stamp(axes, field["time"])
    colour_bar(figure, panels, name, top)
    title(panels[0], result, f"{name.replace('_', ' ')}, equal scales")
    return figure


def refuse_no_field(result: Any, name: str) -> None:
    """Refuse a field that cannot be drawn: one that is not stored, or not at the cell centres."""
    source = result.path or "result"
    if not len(result.field_times):
        found = "no fields: they are thinned out in the cache of runs"
        raise InputError(source, "fields", found, "a result.h5 of `run`")
    field = result.field(0)
    size = np.shape(field["pressure"])
    known = ["speed", *(key for key, values in field.items() if np.shape(values) == size)]
    if name not in known:
        raise InputError(source, "field", name, ", ".join(known))


FIGURES = {
    "profiles": draw_profiles,
    "interface": draw_interface,
    "front": draw_front,
    "volume": draw_volume,
}


def draw(result: Any, what: str, look: Look = USUAL) -> Picture:
    """A figure by name: one of `FIGURES`, "speed", or a field at the cell centres."""
    if what in FIGURES:
        return FIGURES[what](result, look)
    return draw_field(result, what, look)
