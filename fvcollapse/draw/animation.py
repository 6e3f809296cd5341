"""An animation of a result: the grains, coloured by their speed, as GIF or MP4.

A frame is a stored profile, so that the surface of every frame is one that was computed. Fields are stored
less often than profiles. The speed in between is interpolated linearly in time, after both fields were
stretched along x so that their fronts stand where the profile has its front.
"""

import io
import shutil
import subprocess
from collections.abc import Iterator
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon
from PIL import Image

from fvcollapse.draw.drawing import (
    ORANGE,
    Picture,
    draw_gate,
    extent,
    frame,
    new_figure,
    reach,
    title,
)
from fvcollapse.draw.figures import USUAL, refuse_no_field
from fvcollapse.draw.grains import colour_bar, largest, norm, quantity, scale_of
from fvcollapse.draw.look import Look, View, view_of
from fvcollapse.errors import InputError
from fvcollapse.step.erodible_bed import layer_thickness

FRAME_TIME = 0.06  # s that a frame lasts: 16.7 frames per second
FRAMES_MAX, FRAME_WIDTH, FRAME_DPI = 250, 7.5, 100
LAST = 1.0  # s that the last frame lasts
NO_FFMPEG = (
    "no ffmpeg, which writes MP4",
    "--animation gif, or ffmpeg: pip install 'fvcollapse[video]'",
)


class Scene(NamedTuple):
    """What all frames share: the result, its fields, the scale of their colours, and the frame."""

    result: Any
    fields: list[dict]
    top: float
    view: View


def animation(result: Any, look: Look = USUAL) -> bytes:
    """The animation as a file of the format `look.animation`, "gif" or "mp4".

    Raises
    ------
    InputError
        MP4 without ffmpeg, or a result without fields.
    """
    refuse_no_field(result, "speed")
    chosen, lasting = frame_times(result), FRAME_TIME
    if look.animation == "mp4":
        return mp4(frames(result, chosen, look), round(LAST / lasting))
    palette = common_palette()
    images = [
        Image.fromarray(pixels).quantize(palette=palette, dither=Image.Dither.NONE)
        for pixels in frames(result, chosen, look)
    ]
    durations = [1000 * lasting] * (len(images) - 1) + [1000 * LAST]
    stream = io.BytesIO()
    options = {"duration": durations, "loop": 0, "disposal": 1}
    images[0].save(stream, "GIF", save_all=True, append_images=images[1:], **options)
    return stream.getvalue()


def frame_times(result: Any) -> list[int]:
    """Indices of the profiles that become frames: evenly in time, at most `FRAMES_MAX`."""
    times = result.profiles.time
    count = min(len(times), FRAMES_MAX)
    even = np.linspace(times[0], times[-1], count)
    after = np.clip(np.searchsorted(times, even), 1, max(1, len(times) - 1))
    nearer = even - times[after - 1] < times[np.minimum(after, len(times) - 1)] - even
    return sorted({int(j) for j in np.where(nearer, after - 1, np.minimum(after, len(times) - 1))})


def slow_motion(result: Any) -> float:
    """How many times slower than the collapse the animation plays."""
    chosen = frame_times(result)
    span = result.profiles.time[chosen[-1]] - result.profiles.time[chosen[0]]
    return FRAME_TIME * (len(chosen) - 1) / span if span > 0.0 else 1.0


def frames(result: Any, chosen: list[int], look: Look) -> Iterator[np.ndarray]:
    """The frames as arrays of pixels (height, width, 3), uint8."""
    fields = [result.field(j) for j in range(len(result.field_times))]
    top = max(largest(field, "speed") for field in fields)
    scene = Scene(result, fields, top, view_of(result, look))
    figure, axes = stage(scene)
    slow = slow_motion(result)
    for j in chosen:
        artists = draw_moment(axes, scene, j)
        time = result.profiles.time[j]
        title(axes, result, f"t = {time:.2f} s (slowed down {slow:.2g} times)")
        canvas: Any = figure.canvas
        canvas.draw()
        pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
        for artist in artists:
            artist.remove()
        yield pixels


def stage(scene: Scene) -> tuple[Picture, Axes]:
    """The figure without grains, its layout fixed: it takes longer than the drawing."""
    long, high = extent(scene.result)
    (x_0, z_0), (x_1, z_1) = scene.view.limits(long, high)
    figure = new_figure(FRAME_WIDTH, 0.9 + (FRAME_WIDTH - 1.8) * (z_1 - z_0) / (x_1 - x_0))
    figure.set_dpi(FRAME_DPI)
    axes = figure.subplots()
    frame(axes, scene.view, long, high)
    scene.view.draw_gravity(axes)
    colour_bar(figure, [axes], "speed", scene.top)
    title(axes, scene.result, "speed")
    figure.canvas.draw()
    figure.set_layout_engine("none")
    return figure, axes


def draw_moment(axes: Axes, scene: Scene, j: int) -> list:
    """Grains and gate at the time of a profile; return the artists."""
    result, layer = scene.result, layer_thickness(scene.result.case)
    time, x, h, _ = result.profiles
    seen = reach(x, h[j])
    surface = np.column_stack([x[seen], h[j][seen] + layer])
    foot = np.array([[surface[-1, 0], 0.0], [0.0, 0.0]])
    place = scene.view.bed(axes)
    outline = Polygon(np.concatenate([surface, foot]), transform=place, fc="none", ec="none")
    axes.add_patch(outline)
    speed, dx, dz = speed_at(scene, float(time[j]))
    edges = [size * np.arange(count + 1) for size, count in zip((dx, dz), speed.shape, strict=True)]
    colours: dict[str, Any] = {"cmap": scale_of("speed").colours, "norm": norm("speed", scene.top)}
    low, high = axes.get_xlim(), axes.get_ylim()
    mesh = axes.pcolormesh(*edges, speed.T, transform=place, **colours)
    mesh.set_clip_path(outline)
    axes.set(xlim=low, ylim=high)
    line = axes.plot(*surface.T, color="black", lw=0.8, transform=place)
    return [outline, mesh, *line, *draw_gate(axes, result.case, float(time[j]), scene.view)]


def speed_at(scene: Scene, time: float) -> tuple[np.ndarray, float, float]:
    """Speed at a time between two fields, (nx, nz) [m/s], with dx and dz [m] of its cells."""
    times = scene.result.field_times
    after = min(int(np.searchsorted(times, time)), len(times) - 1)
    before = max(after - 1, 0)
    span = times[after] - times[before]
    share = float(np.clip((time - times[before]) / span, 0.0, 1.0)) if span > 0.0 else 1.0
    pair = [scene.fields[n] for n in (before, after)]
    front = front_at(scene, time)
    count = max(field["level_set"].shape[0] for field in pair) - 1
    rows = max(field["level_set"].shape[1] for field in pair) - 1
    speeds = [stretched(field, front / front_at(scene, field["time"]), count) for field in pair]
    padded = [np.pad(speed, ((0, 0), (0, rows - speed.shape[1]))) for speed in speeds]
    return (1.0 - share) * padded[0] + share * padded[1], pair[1]["dx"], pair[1]["dz"]


def front_at(scene: Scene, time: float) -> float:
    """Front at the least thickness that is recorded [m]; not zero."""
    return max(float(np.interp(time, scene.result.time, scene.result.runout_1mm)), 1.0e-6)


def stretched(field: dict, factor: float, count: int) -> np.ndarray:
    """The speed of a field with all x multiplied by a factor, on so many columns of cells, (count, nz)."""
    speed = quantity(field, "speed")
    wanted = np.clip((np.arange(count) + 0.5) / factor - 0.5, 0.0, len(speed) - 1.0)
    left = np.minimum(wanted.astype(int), max(len(speed) - 2, 0))
    share = (wanted - left)[:, None]
    return (1.0 - share) * speed[left] + share * speed[np.minimum(left + 1, len(speed) - 1)]


def common_palette() -> Image.Image:
    """Image with the palette of all frames: the colours of the speed, greys, and the gate's."""
    colours = colormaps[scale_of("speed").colours](np.linspace(0.0, 1.0, 110))[:, :3]
    greys = np.repeat(np.linspace(0.0, 1.0, 17)[:, None], 3, axis=1)
    table = np.concatenate([colours, greys, [to_rgb(ORANGE)]])
    image = Image.new("P", (1, 1))
    image.putpalette((255.0 * table).round().astype(np.uint8).tobytes())
    return image


def mp4(pictures: Iterator[np.ndarray], repeat_last: int) -> bytes:
    """Frames as MP4 (H.264), the last one repeated.

    Raises
    ------
    InputError
        There is no ffmpeg, or it fails.
    """
    images = [even(pixels) for pixels in pictures]
    images += images[-1:] * repeat_last
    height, width = images[0].shape[:2]
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
    source += ["-r", f"{1.0 / FRAME_TIME:.6g}", "-i", "-"]
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20"]
    target = ["-movflags", "frag_keyframe+empty_moov", "-f", "mp4", "-"]
    command = [ffmpeg(), "-v", "error", *source, *coded, *target]
    done = subprocess.run(command, input=b"".join(map(bytes, images)), capture_output=True)
    if done.returncode != 0 or not done.stdout:
        raise InputError("ffmpeg", "animation", done.stderr.decode(errors="replace"), "gif")
    return done.stdout


def even(pixels: np.ndarray) -> np.ndarray:
    """Pixels with an even number of rows and columns, as H.264 takes them."""
    height, width = (size - size % 2 for size in pixels.shape[:2])
    return np.ascontiguousarray(pixels[:height, :width])


def ffmpeg() -> str:
    """Path of ffmpeg, that of the system or that of the package imageio-ffmpeg.

    Raises
    ------
    InputError
        There is none.
    """
    path = shutil.which("ffmpeg")
    if path is None:
        try:
            path = import_module("imageio_ffmpeg").get_ffmpeg_exe()
        except (ImportError, RuntimeError):
            raise InputError("command line", "--animation mp4", *NO_FFMPEG) from None
    return path
