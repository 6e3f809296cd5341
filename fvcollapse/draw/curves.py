"""Observables as curves: simulated, measured, or one over the other."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fvcollapse.draw.drawing import BLUE, WIDTH, Picture, new_figure, sequence

MOMENTS = 5  # profiles
LATE = 0.01  # s after the end of a run at which its last profile still counts as simulated
CENTIMETRES, PERCENT = 100.0, 100.0


def draw_observables(simulated: Any = None, measured: dict | None = None) -> Picture:
    """Front, profiles and volume; simulated ones as lines, measured ones as points with their deviation.

    Parameters
    ----------
    simulated : Observations, optional
    measured : dict of Curve, optional
        As in `Experiment.curves`.
    """
    measured = measured or {}
    figure = new_figure(WIDTH, 6.4)
    above, below = figure.subplots(2, 2, width_ratios=(3, 2))
    draw_line(above[0], simulated, measured, "front", CENTIMETRES)
    above[0].set(xlabel="time (s)", ylabel="front position (cm)")
    draw_line(above[1], simulated, measured, "volume", PERCENT)
    above[1].set(xlabel="time (s)", ylabel="change of volume (%)")
    for axes, name in zip(below, ("profiles", "interface"), strict=True):
        draw_heights(axes, simulated, measured, name)
    below[0].set_ylabel("thickness (cm)")
    below[1].set_ylabel("static–flowing interface (cm)")
    return figure


def draw_line(axes: Axes, simulated: Any, measured: dict, name: str, factor: float) -> None:
    """A curve over time."""
    if simulated is not None:
        rows = getattr(simulated, name)
        axes.plot(rows[:, 0], factor * rows[:, 1], color=BLUE, label="simulated")
    if name in measured:
        curve = measured[name]
        value, sigma = factor * curve.value, factor * curve.sigma
        axes.errorbar(curve.time, value, sigma, fmt="k.", lw=0.7, label="measured")
    finish(axes)


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
    axes.set(xlabel="X (cm)")
    finish(axes)


def finish(axes: Axes) -> None:
    """A legend, or the word that nothing was measured."""
    if axes.has_data():
        axes.legend(frameon=False, fontsize="small")
    else:
        style: dict[str, Any] = {
            "transform": axes.transAxes,
            "ha": "center",
            "va": "center",
            "color": "grey",
        }
        axes.text(0.5, 0.5, "not measured", **style)
