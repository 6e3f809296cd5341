"""What a convergence study leaves behind: a table, converge.json, converge.csv and a figure."""

import csv
import io
import json
from pathlib import Path

from fvcollapse.drawing import BLUE, ORANGE, new_figure, png
from fvcollapse.files import write_atomic
from fvcollapse.refinement import AXES, PROFILE

LABELS = {
    "runout_10mm": "runout at 10 mm",
    "runout": "runout",  # with the thickness of the case
    "runout_1mm": "runout at 1 mm",
    "x_99": "x_99",
    "final_thickness": "final height",
    "peak_front_velocity": "peak front velocity",
    "arrest_time": "arrest time",
    PROFILE: "profile L1 to the finest",
}
NUMBERS = ("order", "extrapolated", "relative_error", "extrapolated_error", "gci", "gci_limited")
ROLES = ("coarse", "medium", "fine")
LOGARITHMIC = ("shear_rate_min", "tolerance")  # axes that are varied by decades
NAME = "converge"
RATIO_LEAST = 1.3  # recommended by Celik et al. (2008)


def write_report(records, axis, case, folder, json_path=None):
    """Write converge.json, .csv and .png into the folder; return their paths.

    Parameters
    ----------
    records : dict
        From `refinement.refine`.
    axis : str
    case : Case
        The one that was refined.
    folder : Path
    json_path : Path, optional
        A second place for the JSON.
    """
    text = json.dumps(records, indent=1, allow_nan=False) + "\n"
    files = {
        folder / f"{NAME}.json": text.encode(),
        folder / f"{NAME}.csv": csv_text(records, axis).encode(),
        folder / f"{NAME}.png": png(draw(records, axis, case)),
    }
    if json_path is not None:
        files[Path(json_path)] = text.encode()
    for path, data in files.items():
        write_atomic(path, data)
    return list(files)


def label(name, case):
    """Words for an observable, the thickness of the front in them."""
    thickness = f" at {1000.0 * case.front.thickness:g} mm" if name == "runout" else ""
    return LABELS[name] + thickness


def csv_text(records, axis):
    """One line per observable and three neighbouring values, the finest three last."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    sizes = [f"{axis}_{role}" for role in ROLES]
    writer.writerow(
        ["observable", "unit", *sizes, *(f"value_{role}" for role in ROLES), "behaviour", *NUMBERS]
    )
    for name, record in records.items():
        for n, triplet in enumerate(record["triplets"]):
            numbers = [triplet[number] for number in NUMBERS]
            values = record["value"][n : n + 3]
            writer.writerow(
                [name, record["unit"], *triplet[axis], *values, triplet["behaviour"], *numbers]
            )
    return stream.getvalue()


# -- the table -----------------------------------------------------------------------------------


def table(records, axis, case):
    """Two blocks of aligned text: the values, and what each three neighbours say."""
    values = next(iter(records.values()))[axis]
    head = [f"{axis} ({AXES[axis].unit})", *(f"{value:g}" for value in values), "spread"]
    rows = [head]
    for name, record in records.items():
        first = f"{label(name, case)} ({record['unit']})"
        measured = [digits(value) for value in record["value"]]
        rows.append([first, *measured, percent(record["spread"])])
    heads = ["", axis, "behaviour", "order", "extrapolated", "e_a", "e_ext", "GCI", "GCI p<=2"]
    outcomes = [heads]
    for name, record in records.items():
        for triplet in record["triplets"]:
            outcomes.append([label(name, case), *outcome_cells(triplet, axis)])
    return "\n\n".join([aligned(rows), aligned(outcomes), *remarks(values, axis)])


def remarks(values, axis):
    """What the reader of the table must be warned of."""
    ratios = [coarse / fine for coarse, fine in zip(values, values[1:], strict=False)]
    if AXES[axis].size is not None and min(ratios) < RATIO_LEAST:
        yield (
            f"Neighbouring values differ by less than {RATIO_LEAST:g} times: "
            "the orders magnify what is not smooth in the values."
        )


def outcome_cells(triplet, axis):
    """The cells of one line of the second block."""
    order = "-" if triplet["order"] is None else f"{triplet['order']:.2f}"
    errors = [percent(triplet[name]) for name in NUMBERS[2:]]
    sizes = " ".join(f"{value:g}" for value in triplet[axis])
    return [sizes, triplet["behaviour"], order, digits(triplet["extrapolated"]), *errors]


def aligned(rows):
    """Rows of texts as lines: the first column to the left, the others to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = []
    for first, *others in rows:
        cells = [text.rjust(width) for text, width in zip(others, widths[1:], strict=True)]
        lines.append("  ".join([first.ljust(widths[0]), *cells]))
    return "\n".join(lines)


def digits(value):
    """A value to five digits, or a dash."""
    return "-" if value is None else f"{value:.5g}"


def percent(fraction):
    """A fraction in per cent, or a dash."""
    return "-" if fraction is None else f"{100.0 * fraction:.2f} %"


# -- the figure ----------------------------------------------------------------------------------


def draw(records, axis, case):
    """One panel per observable: value against size, index as error bar, extrapolated value."""
    figure = new_figure(13.0, 6.0)
    panels = figure.subplots(2, 4).flat
    for axes, (name, record) in zip(panels, records.items(), strict=True):
        draw_record(axes, record, axis, scale=1.0 if name == PROFILE else None)
        axes.set_title(label(name, case), fontsize="medium")
        axes.set(xlabel=f"{axis} ({AXES[axis].unit})", ylabel=record["unit"])
    return figure


def draw_record(axes, record, axis, scale):
    """The values of one observable, and what the finest three say of the limit."""
    points = [
        (size, value)
        for size, value in zip(record[axis], record["value"], strict=True)
        if value is not None
    ]
    if axis in LOGARITHMIC:
        axes.set_xscale("log")
    else:
        axes.set_xlim(0.0, 1.05 * record[axis][0])
    if points:
        axes.plot(*zip(*points, strict=True), color=BLUE, marker="o")
    text = record["behaviour"]
    if record["gci"] is not None:
        size, value = points[-1]
        axes.errorbar(size, value, record["gci"] * (scale or abs(value)), color=BLUE, capsize=4)
        axes.axhline(record["extrapolated"], color=ORANGE, ls="--", lw=1.0)
    if scale is not None:
        axes.set_ylim(bottom=0.0)  # a distance
    if record["order"] is not None:
        text += f", p = {record['order']:.2f}"
    axes.text(0.03, 0.03, text, transform=axes.transAxes, fontsize="small")
