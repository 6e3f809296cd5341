"""Output of a convergence study: a table, converge.json, converge.csv and a figure."""

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fvcollapse.files.atomic import write_atomic
from fvcollapse.studies.refinement import AXES, FORMAL_ORDER, NAME, PROFILE
from fvcollapse.studies.refinement_figure import draw_png

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


LABELS = {
    "runout_10mm": "runout at 10 mm",
    "runout": "runout",  # with the thickness of the case
    "runout_1mm": "runout at 1 mm",
    "x_99": "x_99",
    "final_thickness": "final height",
    "peak_front_velocity": "peak front velocity",
    "arrest_time": "time of arrest",
    PROFILE: "profile, L1 to the next finer",
}
HAD = {  # what the sizes of a record are, where they are not the values of the axis
    "cell_size": "root of the cell area (m)",
    "time_step": "mean step taken (s)",
    "shear_rate_min": "shear rate (1/s)",
}
NUMBERS = ("order", "extrapolated", "relative_error", "extrapolated_error", "gci")
ROLES = ("coarse", "medium", "fine")
RATIO_LEAST = 1.3  # recommended by Celik et al. (2008)


def write_report(
    records: dict, axis: str, case: "Case", folder: Path, json_path: Path | None = None
) -> list[Path]:
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
    labels = {name: label(name, case) for name in records}
    files = {
        folder / f"{NAME}.json": text.encode(),
        folder / f"{NAME}.csv": csv_text(records, axis).encode(),
        folder / f"{NAME}.png": draw_png(records, axis, labels),
    }
    if json_path is not None:
        files[Path(json_path)] = text.encode()
    for path, data in files.items():
        write_atomic(path, data)
    return list(files)


def label(name: str, case: "Case") -> str:
    """Words for an observable, the thickness of the front in them."""
    thickness = f" at {1000.0 * case.front.thickness:g} mm" if name == "runout" else ""
    return LABELS[name] + thickness


def csv_text(records: dict, axis: str) -> str:
    """One line per observable and three neighbouring values, the finest three last; sizes as in the picture."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    sizes = [f"{axis}_{role}" for role in ROLES]
    writer.writerow(
        ["observable", "unit", *sizes, *(f"value_{role}" for role in ROLES), "behaviour", *NUMBERS]
    )
    for name, record in records.items():
        for n, triplet in enumerate(record["triplets"]):
            numbers = [triplet[number] for number in NUMBERS]
            used, values = sizes_of(record, axis)[n : n + 3], record["value"][n : n + 3]
            writer.writerow([name, record["unit"], *used, *values, triplet["behaviour"], *numbers])
    return stream.getvalue()


def sizes_of(record: dict, axis: str) -> list[float]:
    """The sizes that the runs really had: root of the area of a cell, mean step; else the values of the axis."""
    return record["refinement_size"] or record[axis]


# -- the table -----------------------------------------------------------------------------------


def table(records: dict, axis: str, case: "Case") -> str:
    """Blocks of aligned text: the values, the convergence of every three neighbours, the fit to all; remarks."""
    values = next(iter(records.values()))[axis]
    rows = [[f"{axis} ({AXES[axis].unit})", *(f"{value:g}" for value in values), "spread"]]
    used = sizes_of(next(iter(records.values())), axis)
    if used != values:
        rows.append([HAD[axis], *(f"{size:.4g}" for size in used), ""])
    outcomes = [["", axis, "behaviour", "order", "extrapolated", "e_a", "e_ext", "GCI"]]
    fits = [["all values, least squares", "series", "order", "extrapolated", "scatter", "U"]]
    for name, record in records.items():
        first = f"{label(name, case)} ({record['unit']})"
        measured = [digits(value) for value in record["value"]]
        rows.append([first, *measured, percent(record["spread"])])
        for triplet in record["triplets"]:
            outcomes.append([label(name, case), *outcome_cells(triplet, axis)])
        if record["least_squares"] is not None:
            fits.append([label(name, case), *fit_cells(record["least_squares"])])
    blocks = [aligned(rows), aligned(outcomes), *([aligned(fits)] if len(fits) > 1 else [])]
    return "\n\n".join([*blocks, "\n".join(remarks(records, axis, values))])


def remarks(records: dict, axis: str, values: list[float]) -> Iterator[str]:
    """Notes on how to read the indices, and warnings."""
    if AXES[axis].size is None:
        yield "The tolerance is no refinement size: differences only."
        return
    yield (
        "e_a: difference of the two finest values, of the finest. e_ext: finest less extrapolated value, of the"
        " latter. spread: largest difference of any value from the finest, of the finest."
    )
    yield (
        f"GCI (Celik et al. 2008): 1.25 e_a / (r^p - 1), where p counts as {FORMAL_ORDER:g} at most."
    )
    yield (
        "Without an order to trust (oscillatory, diverging, p < 0.5): 3 times the largest difference"
        " of the three values; for p > 2 at least 1.25 times it."
    )
    if any(record["least_squares"] for record in records.values()):
        yield "U, the uncertainty of the finest value from all values: Eca & Hoekstra (2014)."
    yield oscillations(records)
    ratios = [coarse / fine for coarse, fine in zip(values, values[1:], strict=False)]
    if min(ratios) < RATIO_LEAST:
        yield (
            f"Neighbouring values differ by less than {RATIO_LEAST:g} times: "
            "the orders magnify what is not smooth in the values."
        )


def oscillations(records: dict) -> Any:
    """Share of the observables, and of the points of the profile, that oscillate on refinement."""
    found = [
        triplet["behaviour"]
        for name, record in records.items()
        for triplet in record["triplets"]
        if name != PROFILE
    ]
    points = records[PROFILE]["oscillating"]
    return (
        f"Oscillatory: {found.count('oscillatory')} of {len(found)} lines above the profile, and "
        f"{100.0 * points:.0f} % of the points of the final profile (finest three)."
    )


def outcome_cells(triplet: dict, axis: str) -> list[str]:
    """The cells of one line of the second block."""
    order = "-" if triplet["order"] is None else f"{triplet['order']:.2f}"
    errors = [percent(triplet[name]) for name in NUMBERS[2:]]
    sizes = " ".join(f"{value:g}" for value in triplet[axis])
    return [sizes, triplet["behaviour"], order, digits(triplet["extrapolated"]), *errors]


def fit_cells(fit: dict) -> list[str]:
    """The cells of one line of the third block."""
    errors = [percent(fit["deviation"]), percent(fit["uncertainty"])]
    return [fit["series"], f"{fit['order']:.2f}", digits(fit["extrapolated"]), *errors]


def aligned(rows: list) -> str:
    """Rows of texts as lines: the first column to the left, the others to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = []
    for first, *others in rows:
        cells = [text.rjust(width) for text, width in zip(others, widths[1:], strict=True)]
        lines.append("  ".join([first.ljust(widths[0]), *cells]))
    return "\n".join(lines)


def digits(value: float | None) -> str:
    """A value to five digits, or a dash."""
    return "-" if value is None else f"{value:.5g}"


def percent(fraction: float | None) -> str:
    """A fraction in per cent, or a dash."""
    return "-" if fraction is None else f"{100.0 * fraction:.2f} %"
