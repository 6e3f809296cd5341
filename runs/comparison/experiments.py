"""The computed collapses against experiments: runout and height, deposit shape, scaling laws."""

from typing import NamedTuple

import numpy as np

from fvcollapse.measure.pile import front_position
from runs.comparison.analysis import on_curve, power_coefficient
from runs.comparison.tables import line, profile, table
from runs.table import read_table

DEPOSITS = (  # those that have lost their flat top: label, part, name
    ("beads, a = 1.2", "channel", "a1.2"),
    ("beads, a = 2", "channel", "a2"),
    ("beads, a = 4.5", "channel", "a4.5"),
    ("discs, a = 2", "plane", "a2"),
    ("discs, a = 4", "plane", "a4"),
    ("discs, a = 6.26", "columns", "a6.26_fine"),
)
TIP = 0.02  # thickness at the end of a deposit, relative to its largest
PIXELS = 0.015  # relative reading error of the digitised points
SCATTER = 0.059  # of the runouts about 1.83 a, for a < 3
SHAPE_ERROR = 0.015  # of the published deposit shape, relative to its height


def channel(of):
    """Runout and final height of the beads against aspect ratio, point by point and on average."""
    folder, rows = of.data / "lab" / "lajeunesse2005_digitised", []
    runs = [row for row in of.computed("channel") if "_" not in row["name"]]
    runs.sort(key=lambda row: float(row["aspect"]))
    aspect = np.array([float(row["aspect"]) for row in runs])
    for label, file, given_name, found_name in (
        ("runout", "runout_planestrain.csv", "dL_over_L0", "runout_over_l0"),
        ("final height", "height_planestrain.csv", "Hf_over_L0", "final_height_over_l0"),
    ):
        points = table(folder / file, columns=(0, 1))
        a, given = points["a_H0_over_L0"], points[given_name]
        error = given * relative_error(label, a, given)
        of.write(
            f"reference/beads_{label.replace(' ', '_')}.csv",
            ("a", "value", "error"),
            zip(a, given, error.round(4), strict=True),
        )
        found = on_curve(aspect, np.array([float(row[found_name]) for row in runs]), a)
        inside = np.isfinite(found)
        for values in zip(a[inside], given[inside], error[inside], found[inside], strict=True):
            rows.append(line("beads in a channel", f"{label} / l0 (point)", *values))
        rows += summary(label, a, given, error, found)
        if label == "runout":
            thin = np.array([float(row["runout_1mm_over_l0"]) for row in runs])
            rows += summary("runout at 1 mm", a, given, error, on_curve(aspect, thin, a))
    return rows


def relative_error(label, a, given):
    """Relative uncertainty of a point: the reading, and the scatter about the power law."""
    if label == "runout":
        high = power_coefficient(a[a > 3.0], given[a > 3.0], 2 / 3)[1]
        return np.hypot(PIXELS, np.where(a < 3.0, SCATTER, high))
    high = power_coefficient(a[a > 0.9], given[a > 0.9], 1 / 3)[1]
    return np.hypot(PIXELS, np.where(a > 0.9, high, 0.0))


def summary(label, a, given, error, found):
    """Mean difference over ranges of the aspect ratio, with the uncertainty of one point."""
    for low, high in ((0.3, 1.0), (1.0, 3.0), (3.0, 7.0)):
        here = np.isfinite(found) & (a >= low) & (a < high)
        if here.any():
            unit = float(np.mean(error[here] / given[here]))
            ratio = float(np.mean(found[here] / given[here]))
            at, quantity = f"a = {low:g}-{high:g}", f"{label}, computed / measured"
            yield line(f"beads in a channel, {here.sum()} points", quantity, at, 1.0, unit, ratio)


def shape(of):
    """Dimensionless deposit: height over its largest against distance over the runout."""
    points = table(of.data / "lab" / "lube2005_shape" / "final_shape.csv")
    x, given = points["x_star"], points["y_star"]
    of.write("reference/deposit_shape.csv", ("x_star", "y_star"), zip(x, given, strict=True))
    drawn = []
    for label, part, name in DEPOSITS:
        distance, h = profile(of, part, name)
        end = front_position(distance, h, TIP * h.max())
        drawn += [
            (label, round(a, 4), round(b, 4))
            for a, b in zip(distance / end, h / h.max(), strict=True)
        ]
        difference = np.interp(x * end, distance, h) / h.max() - given
        rms = float(np.sqrt(np.mean(difference**2)))
        for quantity, value in (("root mean square", rms), ("mean", float(difference.mean()))):
            row = (f"deposit shape, {label}", f"{quantity} difference", "", 0.0, SHAPE_ERROR)
            yield (*row, round(value, 4), "", round(value / SHAPE_ERROR, 2))
    of.write("deposit_shapes.csv", ("deposit", "x_star", "y_star"), drawn)


def laws(of):
    """Coefficients of the scaling laws, from the computed runouts and heights."""
    rows = {
        row["id"]: row for row in read_table(of.data / "lab" / "scaling_laws" / "scaling_laws.csv")
    }
    beads = [row for row in of.computed("channel") if "_" not in row["name"]]
    flat = [row for part in ("columns", "plane") for row in of.computed(part)]
    flat = [row for row in flat if "_" not in row["name"]]
    for law in ("Lajeunesse2005-2D-digitised", "Lajeunesse2005-2D", "Lube2005-2D"):
        low, high = (float(rows[law][f"{side}_a_coeff"]) for side in ("low", "high"))
        yield law_line(law, "runout, a < 3", low, Fit(beads, "runout_over_l0", (0.0, 3.0), 1.0))
        yield law_line(law, "runout, a >= 3", high, Fit(beads, "runout_over_l0", (3.0, 9.0), 2 / 3))
    for law, power in (("Lajeunesse2005-2D-height-digitised", 1 / 3), ("Lube2005-2D-height", 0.4)):
        given = float(rows[law]["high_a_coeff"])
        yield law_line(
            law, "height, a > 1", given, Fit(beads, "final_height_over_l0", (1.0, 9.0), power)
        )
    given = float(rows["Lagree2011-muI-continuum"]["low_a_coeff"])
    for column in ("runout_over_l0", "runout_1mm_over_l0"):
        label = "runout, a < 7" + (", 1 mm" if "1mm" in column else ", 5 mm")
        yield law_line("Lagree2011-muI-continuum", label, given, Fit(flat, column, (0.0, 7.0), 1.0))
    given = float(rows["Lagree2011-muI-height"]["high_a_coeff"])
    yield law_line(
        "Lagree2011-muI-height",
        "height, a > 1",
        given,
        Fit(flat, "final_height_over_l0", (0.9, 7.0), 0.35),
    )


class Fit(NamedTuple):
    """What a coefficient is fitted to: a column of the runs of some aspect ratios, and the power law."""

    runs: list
    column: str
    limits: tuple
    power: float


def law_line(law, quantity, given, fit):
    """Coefficient of one law; the spread of the computed ones over the range as `at`."""
    low, high = fit.limits
    inside = [row for row in fit.runs if low <= float(row["aspect"]) < high]
    aspect = [float(row["aspect"]) for row in inside]
    computed, spread = power_coefficient(
        aspect, [float(row[fit.column]) for row in inside], fit.power
    )
    error = SCATTER * given if "runout" in quantity and "digitised" in law else None
    return line(law, f"coefficient, {quantity}", f"+-{100 * spread:.0f} %", given, error, computed)
