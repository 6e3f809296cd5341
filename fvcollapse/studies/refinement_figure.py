"""The figure of a convergence study: one panel per observable, value against refinement size."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE, new_figure, png
from fvcollapse.studies.refinement import PROFILE

if TYPE_CHECKING:
    from fvcollapse.draw.drawing import Picture


SHOWN = {  # words for the axis, and the factor to its unit
    "cell_size": ("root of the cell area (mm)", 1000.0),
    "time_step": ("mean time step (ms)", 1000.0),
    "shear_rate_min": ("shear_rate_min (1/s)", 1.0),
    "tolerance": ("tolerance", 1.0),
}
LOGARITHMIC = ("shear_rate_min", "tolerance")  # axes that are varied by decades


def draw_png(records: dict, axis: str, labels: Mapping[str, str]) -> bytes:
    """The figure as PNG bytes; `labels` are the titles of the panels."""
    return png(draw(records, axis, labels))


def draw(records: dict, axis: str, labels: Mapping[str, str]) -> "Picture":
    """Values with the index of the finest, the power law through the finest three, and the fit to all."""
    figure = new_figure(12.0, 6.2)
    panels = figure.subplots(2, 4).ravel()
    for axes, (name, record) in zip(panels, records.items(), strict=True):
        axes.set_title(f"{labels[name]}\n", fontsize="medium")
        axes.set(xlabel=SHOWN[axis][0], ylabel="" if record["unit"] == "1" else record["unit"])
        if any(value is not None for value in record["value"]):
            draw_record(axes, record, axis, name == PROFILE)
            place = {"transform": axes.transAxes, "ha": "center", "fontsize": "small"}
            axes.text(0.5, 1.02, verdict(record), **place)
        else:
            axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
            place = {"transform": axes.transAxes, "ha": "center", "color": GREY}
            axes.text(0.5, 0.5, "not reached in any run", **place)
    handles = {text: line for axes in panels for line, text in drawn(axes)}
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=5)
    return figure


def drawn(axes: Axes) -> Iterator[tuple]:
    """The artists of a panel that have a name, and the name."""
    return zip(*axes.get_legend_handles_labels(), strict=True)


def verdict(record: dict) -> str:
    """Behaviour, order and index in one line."""
    parts = [record["behaviour"]]
    if record["order"] is not None:
        parts.append(f"p = {record['order']:.2f}")
    if record["gci"] is not None:
        parts.append(f"GCI {100.0 * record['gci']:.2g} %")
    return ", ".join(parts)


def draw_record(axes: Axes, record: dict, axis: str, distances: bool) -> None:
    """The values of one observable, and the limit extrapolated from them."""
    factor = SHOWN[axis][1]
    sizes = factor * np.array(record["refinement_size"] or record[axis])
    found = [value is not None for value in record["value"]]
    values = np.array([value for value in record["value"] if value is not None])
    if axis in LOGARITHMIC:
        axes.set_xscale("log")
    else:
        axes.set_xlim(0.0, 1.05 * sizes[0])
        axes.locator_params(nbins=5)
    axes.plot(sizes[found], values, color=BLUE, marker="o", lw=1.0, label="computed")
    if distances:
        axes.set_ylim(0.0, 1.15 * values.max())
        return
    if record["gci"] and found[-1]:
        bar = record["gci"] * abs(values[-1])
        axes.errorbar(sizes[-1], values[-1], bar, color=BLUE, capsize=4, label="± GCI")
    h = np.linspace(0.0 if axis not in LOGARITHMIC else sizes[-1], sizes[0], 100)
    if record["extrapolated"] is not None and record["order"]:
        limit = record["extrapolated"]
        curve = limit + (values[-1] - limit) * (h / sizes[-1]) ** record["order"]
        three = h <= sizes[-3]
        axes.plot(h[three], curve[three], color=ORANGE, ls="--", label="power law, finest three")
    if record["least_squares"] is not None:
        draw_fit(axes, record["least_squares"], h, factor, sizes[-1], values[-1])


def draw_fit(
    axes: Axes, fit: dict, h: np.ndarray, factor: float, size: float, finest: float
) -> None:
    """The series fitted to all values, and its uncertainty beside the finest."""
    curve = fit["extrapolated"] + sum(a * (h / factor) ** p for p, a in fit["coefficients"])
    axes.plot(h, curve, color=GREEN, ls=":", label="least squares, all")
    bar = fit["uncertainty"] * abs(finest)
    axes.errorbar(0.9 * size, finest, bar, color=GREEN, capsize=4, ls="none", label="± U")
