"""How pictures of a pile look: what is drawn, when, in which frame, and in which file format.

The frame is that of the bed, x to the right along it and z normal to it, or the upright one, in which
gravity points down and the bed falls to the right. An arrow of gravity stands in either.
"""

from math import cos, radians, sin
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Affine2D, Transform

FORMATS = ("png", "pdf", "svg")
ANIMATIONS = ("gif", "mp4", "none")
DPI = 130
ARROW = (0.07, 0.5)  # length of the arrow of gravity, at most, in the width and height of a panel
CORNER = (0.82, 0.85)  # where it begins, in the width and height of a panel


class Look(NamedTuple):
    """What is drawn, and how.

    Attributes
    ----------
    upright : bool
        Rotate, so that gravity points down.
    times : tuple of float
        Times [s] of the panels, for which the nearest stored ones are taken; empty: times at which the
        front has covered given parts of its advance.
    fields : tuple of str
        Fields that get a picture each: "speed", or names of fields at cell centres.
    format : str
        One of `FORMATS`.
    dpi : int
        Pixels per inch, of a PNG as a whole and of the coloured cells in all formats.
    animation : str
        One of `ANIMATIONS`.
    """

    upright: bool = False
    times: tuple[float, ...] = ()
    fields: tuple[str, ...] = ("speed", "pressure")
    format: str = "png"
    dpi: int = DPI
    animation: str = "gif"


class View(NamedTuple):
    """The frame of a picture: slope of the bed [rad], and whether gravity points down."""

    slope: float
    upright: bool = False

    def rotation(self) -> Affine2D:
        """Transform of points (x, z) of the bed's frame [m] to the frame that is shown."""
        return Affine2D().rotate(-self.slope if self.upright else 0.0)

    def bed(self, axes: Axes) -> Transform:
        """Transform of points of the bed's frame to the picture."""
        return self.rotation() + axes.transData

    def limits(self, long: float, high: float) -> np.ndarray:
        """((x_0, z_0), (x_1, z_1)) [m] of a picture of the bed up to `long` and of heights up to `high`."""
        corners = np.array([[0.0, 0.0], [long, 0.0], [0.0, high], [long, high]])
        seen = self.rotation().transform(corners)
        return np.array([seen.min(axis=0), seen.max(axis=0)])

    def gravity(self) -> np.ndarray:
        """Unit vector of gravity in the frame that is shown, (2,)."""
        return np.array([0.0, -1.0] if self.upright else [sin(self.slope), -cos(self.slope)])

    def draw_gravity(self, axes: Axes) -> None:
        """Draw the arrow of gravity into the corner of a panel with equal scales."""
        limits = np.array([axes.get_xlim(), axes.get_ylim()])
        size = limits[:, 1] - limits[:, 0]
        tail = limits[:, 0] + np.array(CORNER) * size
        head = tail + (ARROW * size).min() * self.gravity()
        style = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", head, tail, arrowprops=style)
        axes.annotate("g", tail, (-3, -9), textcoords="offset points", ha="right", style="italic")

    def draw_walls(self, axes: Axes, long: float, high: float) -> None:
        """Draw bed and back wall, which the frame of the axes shows where it is that of the bed."""
        if self.upright:
            wall = ([0.0, 0.0, long], [high, 0.0, 0.0])
            axes.plot(*wall, color="black", lw=1.2, transform=self.bed(axes))


def view_of(result: Any, look: Look = Look()) -> View:  # noqa: B008 (immutable)
    """The `View` of a result."""
    return View(radians(result.case.geometry.slope_angle_deg), look.upright)
