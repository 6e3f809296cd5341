"""A run over another run, or over an experiment: front over time, and profiles at some times."""

import numpy as np

from fvcollapse.draw.drawing import BLUE, ORANGE, WIDTH, new_figure, png
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.align import as_grid, on_points
from fvcollapse.measure.observables import observe

PICTURE = "comparison.png"
MOMENTS = 4  # profiles
CENTIMETRES = 100.0


def draw_comparison(folder, names, result, other=None, experiment=None):
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


def draw_front(axes, names, first, second, measured):
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


def scaled(curve):
    """Values and standard deviations in cm."""
    return CENTIMETRES * curve.value, CENTIMETRES * curve.sigma


def draw_profiles(panels, first, second, measured):
    """Thickness over X, one panel for each time: those measured, else spread over the run."""
    grid = as_grid(first.profiles)
    times = grid[0] if measured is None else np.unique(measured.time)
    wanted = np.linspace(0, len(times) - 1, MOMENTS + 1).round().astype(int)[1:]
    for axes, moment in zip(panels, times[wanted], strict=True):
        draw_profile(axes, grid, moment, color=BLUE)
        if second is not None:
            draw_profile(axes, as_grid(second.profiles), moment, color=ORANGE, ls="--")
        if measured is not None:
            here = measured.time == moment
            values, sigma = scaled(measured)
            place = CENTIMETRES * measured.x[here]
            axes.errorbar(place, values[here], sigma[here], fmt="k.", lw=0.7)
        axes.set(xlabel="X (cm)", title=f"t = {moment:.3g} s", ylim=(0.0, None))
    panels[0].set_ylabel("thickness (cm)")


def draw_profile(axes, grid, moment, **style):
    """The profile of a run at one time."""
    x = grid[1]
    values = on_points(*grid, np.full(len(x), moment), x)
    axes.plot(CENTIMETRES * x, CENTIMETRES * values, **style)
