"""Observables as curves: simulated, measured, or one over the other."""

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fvcollapse.draw.drawing import BLUE, WIDTH, Picture, new_figure, sequence
from fvcollapse.measure.quantities import CURVES, SCALAR_UNITS, observable_words, shown_value

MOMENTS = 5  # profiles
LATE = 0.01  # s after the end of a run at which its last profile still counts as simulated
CENTIMETRES = 100.0
LEAST_VOLUME = 0.01  # % of the volume that its axis shows at least


def draw_observables(
    simulated: Any = None, measured: dict | None = None, numbers: Sequence[Any] = ()
) -> Picture:
    """Curves; simulated ones as lines, measured ones as points with their deviation; then the measured numbers.

    Parameters
    ----------
    simulated : Observations, optional
    measured : dict of Curve, optional
        As in `Experiment.curves`: what is not in it has no panel. None: all that is simulated.
    numbers : sequence of Scalar
        As in `Experiment.scalars`.
    """
    names = list(CURVES) if measured is None else [name for name in CURVES if name in measured]
    runouts = [one for one in numbers if one.name == "runout"]
    if runouts and simulated is not None and "front" not in names:
        names.insert(0, "front")
    panels = [*names, *(["numbers"] if numbers else [])]
    figure = new_figure(WIDTH, 3.2 * ceil(len(panels) / 2))
    columns = min(len(panels), 2)
    axes = figure.subplots(ceil(len(panels) / 2), columns, squeeze=False).ravel()
    for place in axes[len(panels) :]:
        place.set_axis_off()
    for place, name in zip(axes, panels, strict=False):
        if name == "numbers":
            write_numbers(place, simulated, numbers)
        elif CURVES[name].is_profile:
            draw_heights(place, simulated, measured or {}, name)
        else:
            draw_line(place, simulated, measured or {}, name)
            if name == "front":
                draw_runouts(place, runouts)
            finish(place)
    return figure


def draw_runouts(axes: Axes, runouts: Sequence[Any]) -> None:
    """Measured runouts as lines, within their deviation."""
    for one in runouts:
        words = {"value": "measured runout", "upper": "runout at most", "lower": "runout at least"}
        value, sigma = CENTIMETRES * one.value, CENTIMETRES * one.sigma
        axes.axhspan(value - sigma, value + sigma, color="0.85", lw=0)
        axes.axhline(value, color="black", ls=":", label=words[one.kind])


def write_numbers(axes: Axes, simulated: Any, numbers: Sequence[Any]) -> None:
    """The measured numbers in words, beside the simulated ones."""
    lines = []
    for one in numbers:
        factor, unit = shown_value(one.name, SCALAR_UNITS[one.name])
        kind = {"value": "", "upper": "at most ", "lower": "at least "}[one.kind]
        value, sigma = factor * one.value, factor * one.sigma
        line = f"{observable_words(one.name)}: {kind}{value:.4g} ± {sigma:.2g} {unit}"
        if simulated is not None:
            own = simulated.scalars[one.name]
            line += ", simulated: " + ("not at rest" if own is None else f"{factor * own:.4g}")
        lines.append(line)
    axes.set_axis_off()
    axes.text(0.0, 0.95, "measured\n\n" + "\n".join(lines), transform=axes.transAxes, va="top")


def draw_line(axes: Axes, simulated: Any, measured: dict, name: str) -> None:
    """A curve over time."""
    factor, unit = shown_value(name, CURVES[name].unit)
    if simulated is not None:
        rows = getattr(simulated, name)
        axes.plot(rows[:, 0], factor * rows[:, 1], color=BLUE, label="simulated")
    if name in measured:
        curve = measured[name]
        value, sigma = factor * curve.value, factor * curve.sigma
        axes.errorbar(curve.time, value, sigma, fmt="k.", lw=0.7, label="measured")
    words = "change of volume" if name == "volume" else observable_words(name)
    axes.set(xlabel="time (s)", ylabel=f"{words} ({unit})")
    if name == "volume":
        show_at_least(axes, LEAST_VOLUME)


def show_at_least(axes: Axes, least: float) -> None:
    """Widen the axis of heights to so much on both sides of zero: round-off is no curve."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -least), max(high, least))


def draw_heights(axes: Axes, simulated: Any, measured: dict, name: str) -> None:
    """Heights over x at some times, early ones dark."""
    curve = measured.get(name)
    if curve is not None:
        times = np.unique(curve.time)
    elif simulated is not None:
        times = np.unique(getattr(simulated, name)[:, 0])
    else:
        times = np.empty(0)
    moments = times[
        np.unique(np.linspace(0, max(len(times) - 1, 0), MOMENTS).round().astype(int))[: len(times)]
    ]
    for colour, moment in zip(sequence(len(moments)), moments, strict=True):
        before = len(axes.lines)
        if simulated is not None and moment <= simulated.front[-1, 0] + LATE:
            rows = getattr(simulated, name)
            nearest = rows[np.argmin(np.abs(rows[:, 0] - moment)), 0]
            seen = CENTIMETRES * rows[rows[:, 0] == nearest, 1:]
            axes.plot(*seen.T, color=colour, label=f"t = {moment:.3g} s")
        if curve is not None:
            here = curve.time == moment
            place, value, sigma = (CENTIMETRES * part[here] for part in curve[1:])
            label = f"t = {moment:.3g} s" if len(axes.lines) == before else None
            axes.errorbar(place, value, sigma, fmt=".", color=colour, lw=0.7, label=label)
    axes.set(xlabel="X (cm)", ylabel=f"{observable_words(name)} (cm)")
    finish(axes)


def finish(axes: Axes) -> None:
    """A legend, if there is anything in it."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize="small")
