"""A run over another run, or over an experiment: front over time, and profiles at some times."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from fvcollapse.draw.drawing import BLUE, ORANGE, WIDTH, new_figure, png
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.align import as_grid, on_points
from fvcollapse.measure.observables import observe

if TYPE_CHECKING:
    from fvcollapse.measure.curves import Curve
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations
    from fvcollapse.output.result import Result


PICTURE = "comparison.png"
MOMENTS = 4  # profiles
CENTIMETRES = 100.0


def draw_comparison(
    folder: Path,
    names: Sequence[str],
    result: "Result",
    other: "Result | None" = None,
    experiment: "Experiment | None" = None,
) -> Path:
    """Write the overlay as a picture; its path.

    Parameters
    ----------
    folder : Path
    names : (str, str)
        Of the run, and of what it is compared with.
    result : Result
    other : Result, optional
    experiment : Experiment, optional
        One of the two is given.
    """
    first = observe(result, experiment)
    second = None if other is None else observe(other)
    measured = {} if experiment is None else experiment.curves
    figure = new_figure(WIDTH, 6.4)
    axes = figure.subplot_mosaic([["front"] * MOMENTS, list(range(MOMENTS))])
    draw_front(axes["front"], names, first, second, measured.get("front"))
    panels = [axes[n] for n in range(MOMENTS)]
    draw_profiles(panels, first, second, measured.get("profiles"))
    path = folder / PICTURE
    write_atomic(path, png(figure))
    return path


def draw_front(
    axes: Axes,
    names: Sequence[str],
    first: "Observations",
    second: "Observations | None",
    measured: "Curve | None",
) -> None:
    """Front over time."""
    axes.plot(first.front[:, 0], CENTIMETRES * first.front[:, 1], color=BLUE, label=names[0])
    if second is not None:
        rows = second.front
        axes.plot(rows[:, 0], CENTIMETRES * rows[:, 1], "--", color=ORANGE, label=names[1])
    if measured is not None:
        axes.errorbar(measured.time, *scaled(measured), fmt="k.", lw=0.7, label=names[1])
    elif second is None:
        axes.plot([], [], "k.", label=f"{names[1]} (front not measured)")
    axes.set(xlabel="time (s)", ylabel="front position (cm)")
    axes.legend(frameon=False)


def scaled(curve: "Curve") -> tuple[np.ndarray, np.ndarray]:
    """Values and standard deviations in cm."""
    return CENTIMETRES * curve.value, CENTIMETRES * curve.sigma


def draw_profiles(
    panels: list, first: "Observations", second: "Observations | None", measured: "Curve | None"
) -> None:
    """Thickness over X, one panel for each time: those measured, else spread over the run."""
    grid = as_grid(first.profiles)
    times = grid[0] if measured is None else np.unique(measured.time)
    wanted = np.linspace(0, len(times) - 1, MOMENTS + 1).round().astype(int)[1:]
    for axes, moment in zip(panels, times[wanted], strict=True):
        draw_profile(axes, grid, moment, color=BLUE)
        if second is not None:
            draw_profile(axes, as_grid(second.profiles), moment, color=ORANGE, ls="--")
        if measured is not None and measured.x is not None:
            here = measured.time == moment
            values, sigma = scaled(measured)
            place = CENTIMETRES * measured.x[here]
            axes.errorbar(place, values[here], sigma[here], fmt="k.", lw=0.7)
        axes.set(xlabel="X (cm)", title=f"t = {moment:.3g} s", ylim=(0.0, None))
    panels[0].set_ylabel("thickness (cm)")


def draw_profile(axes: Axes, grid: tuple, moment: float, **style: Any) -> None:
    """The profile of a run at one time."""
    x = grid[1]
    values = on_points(grid[0], x, grid[2], np.full(len(x), moment), x)
    axes.plot(CENTIMETRES * x, CENTIMETRES * values, **style)
