"""Grains coloured by a quantity, cut out along the surface, and the scales of their colours."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize, PowerNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fvcollapse.draw.look import View

APART = 0.06  # of the length of a bar that its ticks are apart at least
DECADES = 6  # of a logarithmic scale


class Scale(NamedTuple):
    """How a quantity is coloured: colour map, label, and the law of the scale, with its words."""

    colours: str
    label: str
    law: str = "linear"


LAWS = {  # words of the law of a scale
    "linear": "linear colours",
    "root": "colours by the root",
    "logarithmic": "logarithmic colours",
}
SCALES = {
    "speed": Scale("viridis", "speed (m/s)", "root"),  # slow parts show
    "pressure": Scale("cividis", "pressure (Pa)"),
    "shear_rate": Scale("magma", "shear rate (1/s)", "root"),
    "viscosity": Scale("plasma", "viscosity (Pa s)", "logarithmic"),
    "inertial_number": Scale("inferno", "inertial number", "logarithmic"),
}


def scale_of(name: str) -> Scale:
    """The `Scale` of a field; one that is not in the table is linear."""
    return SCALES.get(name, Scale("viridis", name.replace("_", " ")))


def draw_grains(axes: Axes, field: dict, name: str, top: float, view: View) -> list:
    """Coloured cells inside the surface, and the surface as a line; return the artists.

    Parameters
    ----------
    axes : Axes
    field : dict
        As `Result.field` returns it.
    name : str
        "speed", or a field at the cell centres.
    top : float
        Upper end of the colours, in the unit of the field.
    view : View
    """
    x = field["dx"] * np.arange(field["level_set"].shape[0])
    z = field["dz"] * np.arange(field["level_set"].shape[1])
    phi, place = field["level_set"].T, view.bed(axes)
    if not (phi < 0.0).any():
        return []
    low, high = axes.get_xlim(), axes.get_ylim()  # contours would change them
    colours: dict[str, Any] = {
        "cmap": scale_of(name).colours,
        "norm": norm(name, top),
        "rasterized": True,
    }
    mesh = axes.pcolormesh(x, z, quantity(field, name).T, transform=place, **colours)
    levels = [min(phi.min(), -1.0), 0.0]
    inside = axes.contourf(x, z, phi, levels, alpha=0.0, transform=place)
    mesh.set_clip_path(inside.get_paths()[0], place)
    artists = [mesh, inside]
    if (phi > 0.0).any():
        line: dict[str, Any] = {"colors": "black", "linewidths": 0.8, "transform": place}
        artists.append(axes.contour(x, z, phi, [0.0], **line))
    axes.set(xlim=low, ylim=high)
    return artists


def quantity(field: dict, name: str) -> np.ndarray:
    """A cell-centred quantity of a field, (nx, nz)."""
    if name == "speed":
        u, w = field["u"], field["w"]
        return np.hypot(0.5 * (u[:-1] + u[1:]), 0.5 * (w[:, :-1] + w[:, 1:]))
    return field[name]


def norm(name: str, top: float) -> Normalize:
    """Colour scale from zero to `top`, or over `DECADES` below it; less is shown as the least."""
    law = scale_of(name).law
    if law == "logarithmic":
        return LogNorm(top * 10.0**-DECADES, top, clip=True)
    return PowerNorm(0.5 if law == "root" else 1.0, 0.0, top, clip=True)


def largest(field: dict, name: str) -> float:
    """Largest value in the cells whose centre is in the grains; 1e-12 at least."""
    phi = field["level_set"]
    centre = 0.25 * (phi[:-1, :-1] + phi[1:, :-1] + phi[:-1, 1:] + phi[1:, 1:])
    return float(quantity(field, name)[centre < 0.0].max(initial=1e-12))


def ticks_of(name: str, top: float) -> list[float]:
    """Round values up to the largest one, without those that would stand on another in the bar."""
    kept: list[float] = []
    for value in MaxNLocator(5).tick_values(0.0, top):
        place = float(norm(name, top)(value))
        if 0.0 <= value <= top and all(
            abs(place - float(norm(name, top)(other))) > APART for other in kept
        ):
            kept.append(float(value))
    return kept


def colour_bar(figure: Figure, panels: Any, name: str, top: float) -> None:
    """Colour bar beside a column of panels; it says its law."""
    scale = scale_of(name)
    colours = ScalarMappable(norm(name, top), scale.colours)
    ticks = None if scale.law == "logarithmic" else ticks_of(name, top)
    label = f"{scale.label}\n{LAWS[scale.law]}"
    figure.colorbar(colours, ax=list(panels), label=label, fraction=0.05, pad=0.02, ticks=ticks)
