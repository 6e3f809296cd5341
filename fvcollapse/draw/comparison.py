"""A run over another run, or over an experiment: front over time, and profiles at some times."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from fvcollapse.case.words import set_up_words
from fvcollapse.draw.drawing import BLUE, ORANGE, WIDTH, new_figure, png
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.align import as_grid, on_points
from fvcollapse.measure.comparison import covered, moves
from fvcollapse.measure.observables import observe

if TYPE_CHECKING:
    from fvcollapse.measure.curves import Curve
    from fvcollapse.measure.experiment import Experiment
    from fvcollapse.measure.observables import Observations
    from fvcollapse.output.result import Result


PICTURE = "comparison.png"
MOMENTS = 4  # profiles
CENTIMETRES = 100.0
STYLES: tuple[dict[str, Any], ...] = ({"color": BLUE}, {"color": ORANGE, "ls": "--"})


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
    measured = {} if experiment is None else covered(first, experiment.curves)
    figure = new_figure(WIDTH, 6.4)
    still = " (still moves at its end)" if moves(first) else ""
    figure.suptitle(
        f"{names[0]}{still} beside {names[1]} — {set_up_words(result.case)}", fontsize="medium"
    )
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
    grids = [as_grid(one.profiles) for one in (first, second) if one is not None]
    times = common_times(grids) if measured is None else np.unique(measured.time)
    wanted = np.unique(np.linspace(0, len(times) - 1, MOMENTS + 1).round().astype(int)[1:])
    longest = 1.03 * CENTIMETRES * max(reached(*grid) for grid in grids)
    for axes in panels[len(wanted) :]:
        axes.set_axis_off()
    for axes, moment in zip(panels, times[wanted], strict=False):
        for grid, style in zip(grids, STYLES, strict=False):
            draw_profile(axes, grid, moment, **style)
        if measured is not None and measured.x is not None:
            here = measured.time == moment
            values, sigma = scaled(measured)
            place = CENTIMETRES * measured.x[here]
            axes.errorbar(place, values[here], sigma[here], fmt="k.", lw=0.7)
            longest = max(longest, 1.03 * place[values[here] > 0.0].max(initial=0.0))
        axes.set(xlabel="X (cm)", title=f"t = {moment:.3g} s", ylim=(0.0, None))
    for axes in panels:
        axes.set_xlim(0.0, longest)
    panels[0].set_ylabel("thickness (cm)")


def common_times(grids: list[tuple]) -> np.ndarray:
    """Times of the profiles of the first run that all runs reach; its first one at least."""
    times = grids[0][0]
    return times[: max(1, np.count_nonzero(times <= min(grid[0][-1] for grid in grids)))]


def reached(time: np.ndarray, x: np.ndarray, values: np.ndarray) -> float:
    """The farthest place [m] at which a pile is ever thicker than nothing."""
    return float(x[(values > 0.0).any(axis=0)].max(initial=0.0))


def draw_profile(axes: Axes, grid: tuple, moment: float, **style: Any) -> None:
    """The profile of a run at one time."""
    x = grid[1]
    values = on_points(grid[0], x, grid[2], np.full(len(x), moment), x)
    axes.plot(CENTIMETRES * x, CENTIMETRES * values, **style)
