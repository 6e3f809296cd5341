"""The standard pictures and an animation of a result; nothing physical is computed here.

Everything is in the frame of the bed, x to the right and z up, metres on equal axes unless the
picture states an exaggeration. The grains are cut out along the surface itself (the zero line of
the level set), not along the cells.
"""

import io
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgb
from PIL import Image

from fvcollapse.draw.drawing import (
    BLUE,
    COLOURMAP,
    GREEN,
    GREY,
    ORANGE,
    WIDTH,
    colour_bar,
    draw_gate,
    draw_grains,
    extent,
    frame,
    largest,
    new_figure,
    panel_column,
    png,
    reach,
    sequence,
    stamp,
    time_limits,
    times_of_progress,
    title,
)
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.output.question import case_question, claim_folder
from fvcollapse.output.result import open_result
from fvcollapse.step.erodible_bed import layer_thickness

STATIC, FLOWING = "#8C8C8C", "#E8C98A"
PROFILE_PROGRESS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)  # fractions of the advance of the front
FIELD_PROGRESS = (0.02, 0.3, 0.7, 1.0)
EXAGGERATION = 2.5  # of heights in the picture of the profiles
FRAMES_MAX, FRAME_WIDTH = 120, 7.5
SLOW_MOTION = 3.0


def claim_pictures(result_path, folder, force=False):
    """Make a folder that of the pictures of a run; those of an earlier state of the run may be renewed.

    Parameters
    ----------
    result_path : str or Path
        `result.h5`, or the folder that holds it.
    folder : str or Path
        Where the pictures go.
    force : bool
        Take the folder over from pictures of another run; see `question`.

    Raises
    ------
    InputError, OutputError
    """
    case = open_result(result_path).case
    claim_folder(folder, "plot", case_question(case, without=["time.end"]), force)


def draw_all(result_path, folder=None):
    """Draw every standard picture of a result.

    Parameters
    ----------
    result_path : str or Path
        `result.h5`, or the folder that holds it.
    folder : str or Path, optional
        Where the pictures go; default `pictures` beside the result.

    Returns
    -------
    list of Path
        The files written.
    """
    result = open_result(result_path)
    folder = Path(folder) if folder is not None else result.path.parent / "pictures"
    pictures = {
        "profiles.png": lambda: png(draw_profiles(result)),
        "interface.png": lambda: png(draw_interface(result)),
        "speed.png": lambda: png(draw_field(result, "speed")),
        "pressure.png": lambda: png(draw_field(result, "pressure")),
        "front.png": lambda: png(draw_front(result)),
        "volume.png": lambda: png(draw_volume(result)),
        "animation.gif": lambda: animation(result),
    }
    make_folder(folder, *pictures)
    for name, draw in pictures.items():
        write_atomic(folder / name, draw())
    return [folder / name for name in pictures]


# -- lines -------------------------------------------------------------------------------------


def draw_profiles(result):
    """Thickness profiles while the front advances."""
    times, x, h, _ = result.profiles
    chosen = times_of_progress(result, times, PROFILE_PROGRESS)
    long, high = extent(result)
    figure = new_figure(WIDTH, 0.8 + (WIDTH - 0.8) * EXAGGERATION * high / long)
    axes = figure.subplots()
    for colour, j in zip(sequence(len(chosen)), chosen, strict=True):
        seen = reach(x, h[j])
        axes.plot(x[seen], h[j][seen], color=colour, label=f"{times[j]:.2f} s")
    frame(axes, long, high, EXAGGERATION)
    axes.legend(title="time", ncols=2, frameon=False)
    title(axes, result, f"thickness, heights × {EXAGGERATION:g}")
    return figure


def draw_interface(result):
    """Static and flowing part of the pile at four times."""
    times, x, h, static = result.profiles
    chosen = times_of_progress(result, times, FIELD_PROGRESS)
    figure, panels = panel_column(result, len(chosen))
    for axes, j in zip(panels, chosen, strict=True):
        axes.fill_between(x, 0.0, static[j], color=STATIC, lw=0, label="static")
        axes.fill_between(x, static[j], h[j], color=FLOWING, lw=0, label="flowing (> 0.01 m/s)")
        seen = reach(x, h[j])
        axes.plot(x[seen], h[j][seen], color="black", lw=1.0)
        draw_gate(axes, result.case, times[j], layer_thickness(result.case))
        stamp(axes, times[j])
    panels[0].legend(loc="lower right", ncols=2, frameon=False, fontsize="small")
    title(panels[0], result, "static–flowing interface")
    return figure


def draw_front(result):
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
    below.plot(time, result.front_velocity, color=BLUE)
    below.set(xlabel="time (s)", ylabel="front velocity (m/s)", xlim=time_limits(time))
    below.axhline(0.0, color="black", lw=0.5)
    title(above, result, "front")
    return figure


def draw_volume(result):
    """Volume error and running sum of the volume corrections against time."""
    figure = new_figure(WIDTH, 5.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(result.time, 100.0 * result.relative_volume, color=BLUE)
    above.set_ylabel("volume error (%)")
    below.plot(result.time, 100.0 * result.volume_correction, color=ORANGE, label="corrections")
    below.plot(result.time, 100.0 * result.detached_volume, color=GREEN, ls="--", label="detached")
    below.set(xlabel="time (s)", ylabel="part of the volume (%)", xlim=time_limits(result.time))
    below.legend(frameon=False)
    title(above, result, "volume; running sum of |corrections|; part beyond the 1 mm front")
    return figure


# -- fields ------------------------------------------------------------------------------------


def draw_field(result, name):
    """Speed or pressure at four times, cut out along the surface."""
    chosen = times_of_progress(result, result.field_times, FIELD_PROGRESS)
    fields = [result.field(j) for j in chosen]
    top = max(largest(field, name) for field in fields)
    figure, panels = panel_column(result, len(chosen), bar=True)
    for axes, field in zip(panels, fields, strict=True):
        draw_grains(axes, field, name, top)
        draw_gate(axes, result.case, field["time"])
        stamp(axes, field["time"])
    colour_bar(figure, panels, name, top)
    title(panels[0], result, name)
    return figure


# -- animation ---------------------------------------------------------------------------------


def animation(result):
    """GIF (bytes) of speed and surface; at most `FRAMES_MAX` of the stored fields."""
    count = len(result.field_times)
    chosen = np.unique(np.linspace(0, count - 1, min(count, FRAMES_MAX)).round().astype(int))
    top = max(largest(result.field(j), "speed") for j in chosen)
    long, high = extent(result)
    figure = new_figure(FRAME_WIDTH, 0.9 + (FRAME_WIDTH - 1.8) * high / long)
    axes = figure.subplots()
    frame(axes, long, high)
    colour_bar(figure, [axes], "speed", top)
    title(axes, result, "speed")
    figure.canvas.draw()
    figure.set_layout_engine("none")  # keep the layout, which takes longer than the drawing
    images = [animation_frame(figure, axes, result, result.field(j), top) for j in chosen]
    lasting = np.diff(result.field_times[chosen], append=result.field_times[chosen[-1]] + 0.5)
    palette = common_palette()
    images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    stream = io.BytesIO()
    images[0].save(
        stream,
        "GIF",
        save_all=True,
        append_images=images[1:],
        duration=[max(20, int(1000 * SLOW_MOTION * time)) for time in lasting],
        loop=0,
    )
    return stream.getvalue()


def animation_frame(figure, axes, result, field, top):
    """One picture of the animation; the axes are left as they were."""
    artists = draw_grains(axes, field, "speed", top)
    artists += draw_gate(axes, result.case, field["time"])
    title(axes, result, f"t = {field['time']:.2f} s (slowed down {SLOW_MOTION:g} times)")
    figure.canvas.draw()
    image = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])
    for artist in artists:
        artist.remove()
    return image


def common_palette():
    """Image with the palette of all frames: the colours of the speed, greys, and the gate's."""
    colours = colormaps[COLOURMAP["speed"]](np.linspace(0.0, 1.0, 110))[:, :3]
    greys = np.repeat(np.linspace(0.0, 1.0, 17)[:, None], 3, axis=1)
    table = np.concatenate([colours, greys, [to_rgb(ORANGE)]])
    image = Image.new("P", (1, 1))
    image.putpalette((255.0 * table).round().astype(np.uint8).tobytes())
    return image
