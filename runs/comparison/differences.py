"""The computed collapses against the published ones, in units of the uncertainty of the data.

`compare(data)` reads the tables of the study and the published data, writes differences.csv and the
reference curves that the figures draw, and prints the table.
"""

import csv
import json
from pathlib import Path

import numpy as np
from analysis import (
    asymmetry,
    l1_difference,
    mean_half,
    on_curve,
    power_coefficient,
    scaled_to_area,
    top_of_segments,
)

from fvcollapse.observables import front_position

HERE = Path(__file__).parent
AT = np.linspace(0.0, 6.0, 2401)  # distances from the symmetry plane, in column heights
THIN = 0.03  # thickness at the front, in column heights
VOF_CELL = 5.0 / 128.0  # cell of the volume-of-fluid solution, in column heights
VOF_FRONTS = (2.39, 3.17, 3.64, 3.86)  # at t* = 1 ... 4, from the symmetry plane
VOF_L1 = (0.040, 0.043, 0.043, 0.027)  # its published distance from the discs
DISCS = {"0.5": 1 / 30, "6.26": 1 / 134}  # disc diameter in column heights
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
HEADER = (
    "comparison",
    "quantity",
    "at",
    "data",
    "uncertainty",
    "computed",
    "relative_difference",
    "in_uncertainties",
)


def compare(data):
    """Write and print differences.csv; `data` is the folder of the published data."""
    (HERE / "reference").mkdir(exist_ok=True)
    rows = [
        *discs("0.5", data),
        *discs("6.26", data),
        *discs("6.26", data, "_fine"),
        *dated_discs(data),
        *dated_discs(data, "_fine"),
        *volume_of_fluid(data),
        *channel(data),
        *shape(data),
        *laws(data),
    ]
    write(HERE / "differences.csv", HEADER, rows)
    for row in rows:
        if not row[1].endswith("(point)"):
            print("".join(f"{str(item):<{width}}" for item, width in zip(row, WIDTHS, strict=True)))


WIDTHS = (36, 36, 12, 10, 10, 10, 10, 8)


def line(comparison, quantity, at, data, uncertainty, computed):
    """One row of the table; `uncertainty` is None where the data state none."""
    difference = computed - data
    return (
        comparison,
        quantity,
        at,
        round(float(data), 4),
        "" if uncertainty is None else round(float(uncertainty), 4),
        round(float(computed), 4),
        round(float(difference / data), 4),
        "" if uncertainty is None else round(float(difference / uncertainty), 2),
    )


# -- discs and the volume-of-fluid solution ----------------------------------------------------


def discs(aspect, data, variant=""):
    """Fronts, heights and L1 differences of one column of discs, at the whole t*."""
    folder = data / "particles" / "contact_dynamics"
    outline = table(folder / f"profiles_a{aspect}.csv")
    fronts = table(folder / f"fronts_a{aspect}.csv")
    name = f"discs a = {aspect}{variant.replace('_', ', ')}"
    grain, rows, curves = DISCS[aspect], [], []
    for row in fronts:
        here = outline["k"] == row["k"]
        x, measured = outline["x_over_H0"][here], outline["h_over_H0"][here]
        mean = mean_half(x, measured, AT)
        curves += profile_rows(row["k"], mean)
        if row["k"] == 0:
            continue
        h = computed_profile("columns", f"a{aspect}{variant}", row["k"])
        sides = abs(row["front_left_over_H0"] - row["front_right_over_H0"])
        error = max(0.5 * sides, 2.0 * grain)
        for label, level in (("one disc", grain), ("0.03 h0", THIN)):
            found, given = (front_position(AT, curve, level) for curve in (h, mean))
            rows.append(line(name, f"front at {label}", f"t* = {row['k']}", given, error, found))
        rows.append(
            line(name, "largest height", f"t* = {row['k']}", mean.max(), 2.0 * grain, h.max())
        )
        floor = asymmetry(x, measured, AT)
        rows.append(l1_line(name, row["k"], l1_difference(AT, h, mean), floor))
    write(HERE / "reference" / f"discs_a{aspect}.csv", PROFILE_HEADER, curves)
    return rows


def l1_line(name, t_star, found, floor):
    """L1 difference: no data, but the distance of one side of the discs from the mean as unit."""
    ratio = round(found / floor, 2)
    quantity = "L1 to the mean of both sides"
    return name, quantity, f"t* = {t_star}", 0.0, round(floor, 4), round(found, 4), "", ratio


def dated_discs(data, variant=""):
    """The same column at dated instants: 99 % of the discs, solid area per column."""
    folder = data / "particles" / "contact_dynamics"
    name, grain, rows = f"dated discs a = 6.26{variant.replace('_', ', ')}", DISCS["6.26"], []
    run = next(row for row in read(HERE / "columns.csv") if row["name"] == f"a6.26{variant}")
    x_99 = np.array(json.loads(run["x_99_curve"]))
    surface = table(folder / "dated_surface_a6.26.csv")
    for row in table(folder / "dated_summary_a6.26.csv"):
        found = np.interp(row["t_star"], 0.1 * np.arange(x_99.size), x_99)
        if row["t_star"] > 0.0:
            given = row["absx_p99_over_H0"]
            at = f"t* = {row['t_star']:g}"
            rows.append(line(name, "distance of 99 % of the volume", at, given, 2.0 * grain, found))
            here = surface["t_star"] == row["t_star"]
            x, solid = surface["absx_over_H0"][here], surface["grain_area_per_width_over_H0"][here]
            h = np.interp(x, *profile("columns", f"a6.26{variant}", row["t_star"]), right=0.0)
            found = l1_difference(x, h, scaled_to_area(x, solid, h))
            rows.append((name, "L1 to the solid area", at, 0.0, "", round(found, 4), "", ""))
    return rows


def volume_of_fluid(data):
    """Fronts and L1 differences of the volume-of-fluid set-up on three grids."""
    facets = table(data / "continuum" / "basilisk_muI_column" / "interface_a0.5.csv")
    rows, curves = [], []
    for t_star in range(5):
        here = facets["t_star"] == t_star
        top = top_of_segments(facets["x_over_H0"][here], facets["y_over_H0"][here], AT)
        curves += profile_rows(t_star, top)
        if t_star == 0:
            continue
        at, published, given = f"t* = {t_star}", VOF_L1[t_star - 1], VOF_FRONTS[t_star - 1]
        own = reference_l1(data, t_star, top)
        rows.append(line("the other solver", "its L1 to the discs", at, published, None, own))
        for cells in (13, 26, 52):
            name = f"volume of fluid, h0/{cells}"
            h = computed_profile("volume_of_fluid", f"cells{cells}", t_star)
            for label, level in (("0.03 h0", THIN), ("0.01 h0", 0.01)):
                found = front_position(AT, h, level)
                rows.append(line(name, f"front at {label}", at, given, VOF_CELL, found))
            found = reference_l1(data, t_star, h)
            rows.append(line(name, "L1 to the discs", at, published, None, found))
            rows.append(
                (
                    name,
                    "L1 to that solver",
                    at,
                    0.0,
                    "",
                    round(l1_difference(AT, h, top), 4),
                    "",
                    "",
                )
            )
    write(HERE / "reference" / "volume_of_fluid_a0.5.csv", PROFILE_HEADER, curves)
    return sorted(rows, key=lambda row: row[0]) + finer_volume_of_fluid(data)


def finer_volume_of_fluid(data):
    """The other solver on a grid twice as fine against the computation on one twice as fine."""
    rows = []
    for row in table(data / "peers" / "basilisk_vs_contact_dynamics.csv"):
        if row["level"] == 8 and row["aspect"] == 0.5 and row["t_over_T"] > 0:
            at, name = f"t* = {row['t_over_T']}", "volume of fluid, its h0/51, h0/52"
            h = computed_profile("volume_of_fluid", "cells52", row["t_over_T"])
            found, given = front_position(AT, h, THIN), row["front_last_h003"]
            rows.append(line(name, "front at 0.03 h0", at, given, 0.5 * VOF_CELL, found))
            found = reference_l1(data, row["t_over_T"], h)
            rows.append(line(name, "L1 to the discs", at, row["L1_rel_diff"], None, found))
    return rows


def reference_l1(data, t_star, h):
    """L1 difference of a profile on AT to the column of discs of aspect ratio 0.5."""
    outline = table(data / "particles" / "contact_dynamics" / "profiles_a0.5.csv")
    here = outline["k"] == t_star
    mean = mean_half(outline["x_over_H0"][here], outline["h_over_H0"][here], AT)
    return l1_difference(AT, h, mean)


# -- experiments -------------------------------------------------------------------------------


def channel(data):
    """Runout and final height of the beads against aspect ratio, point by point and on average."""
    folder, rows = data / "lab" / "lajeunesse2005_digitised", []
    runs = [row for row in read(HERE / "channel.csv") if "_" not in row["name"]]
    runs.sort(key=lambda row: float(row["aspect"]))
    aspect = np.array([float(row["aspect"]) for row in runs])
    for label, file, given_name, found_name in (
        ("runout", "runout_planestrain.csv", "dL_over_L0", "runout_over_l0"),
        ("final height", "height_planestrain.csv", "Hf_over_L0", "final_height_over_l0"),
    ):
        points = table(folder / file, columns=(0, 1))
        a, given = points["a_H0_over_L0"], points[given_name]
        error = given * relative_error(label, a, given)
        write(
            HERE / "reference" / f"beads_{label.replace(' ', '_')}.csv",
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


def shape(data):
    """Dimensionless deposit: height over its largest against distance over the runout."""
    points = table(data / "lab" / "lube2005_shape" / "final_shape.csv")
    x, given = points["x_star"], points["y_star"]
    write(
        HERE / "reference" / "deposit_shape.csv", ("x_star", "y_star"), zip(x, given, strict=True)
    )
    drawn = []
    for label, part, name in DEPOSITS:
        distance, h = profile(part, name)
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
    write(HERE / "deposit_shapes.csv", ("deposit", "x_star", "y_star"), drawn)


def laws(data):
    """Coefficients of the scaling laws, from the computed runouts and heights."""
    rows = {row["id"]: row for row in read(data / "lab" / "scaling_laws" / "scaling_laws.csv")}
    beads = [row for row in read(HERE / "channel.csv") if "_" not in row["name"]]
    flat = [row for part in ("columns", "plane") for row in read(HERE / f"{part}.csv")]
    flat = [row for row in flat if "_" not in row["name"]]
    for law in ("Lajeunesse2005-2D-digitised", "Lajeunesse2005-2D", "Lube2005-2D"):
        low, high = (float(rows[law][f"{side}_a_coeff"]) for side in ("low", "high"))
        yield law_line(law, "runout, a < 3", low, beads, "runout_over_l0", (0.0, 3.0), 1.0)
        yield law_line(law, "runout, a >= 3", high, beads, "runout_over_l0", (3.0, 9.0), 2 / 3)
    for law, power in (("Lajeunesse2005-2D-height-digitised", 1 / 3), ("Lube2005-2D-height", 0.4)):
        given = float(rows[law]["high_a_coeff"])
        yield law_line(
            law, "height, a > 1", given, beads, "final_height_over_l0", (1.0, 9.0), power
        )
    given = float(rows["Lagree2011-muI-continuum"]["low_a_coeff"])
    for column in ("runout_over_l0", "runout_1mm_over_l0"):
        label = "runout, a < 7" + (", 1 mm" if "1mm" in column else ", 5 mm")
        yield law_line("Lagree2011-muI-continuum", label, given, flat, column, (0.0, 7.0), 1.0)
    given = float(rows["Lagree2011-muI-height"]["high_a_coeff"])
    yield law_line(
        "Lagree2011-muI-height",
        "height, a > 1",
        given,
        flat,
        "final_height_over_l0",
        (0.9, 7.0),
        0.35,
    )


def law_line(law, quantity, given, runs, column, limits, power):
    """Coefficient of one law; the spread of the computed ones over the range as `at`."""
    here = [row for row in runs if limits[0] <= float(row["aspect"]) < limits[1]]
    aspect = [float(row["aspect"]) for row in here]
    found, spread = power_coefficient(aspect, [float(row[column]) for row in here], power)
    error = SCATTER * given if "runout" in quantity and "digitised" in law else None
    return line(law, f"coefficient, {quantity}", f"+-{100 * spread:.0f} %", given, error, found)


# -- tables ------------------------------------------------------------------------------------

PROFILE_HEADER = ("t_star", "x_over_h0", "h_over_h0")


def computed_profile(part, name, t_star):
    """A computed profile at the distances AT."""
    return np.interp(AT, *profile(part, name, t_star), right=0.0)


def profile(part, name, t_star=None):
    """Distances and heights of one computed profile; the last one without a time."""
    rows = [row for row in read(HERE / f"{part}_profiles.csv") if row["name"] == name]
    times = sorted({float(row["t_star"]) for row in rows})
    wanted = times[-1] if t_star is None else min(times, key=lambda time: abs(time - t_star))
    if t_star is not None and abs(wanted - t_star) > 0.01:
        raise ValueError(f"{part}, {name}: no profile at t* = {t_star}")
    rows = [row for row in rows if float(row["t_star"]) == wanted]
    return tuple(np.array([float(row[key]) for row in rows]) for key in PROFILE_HEADER[1:])


def profile_rows(t_star, h):
    """Every tenth point of a profile on AT, up to its end, for the figures."""
    last = np.flatnonzero(h > 0.0)[-1] + 2
    return [
        (int(t_star), round(float(x), 3), round(float(value), 4))
        for x, value in zip(AT[: last + 10 : 10], h[: last + 10 : 10], strict=True)
    ]


def table(path, columns=None):
    """A numeric table of the data, or some of its columns, by column name."""
    return np.genfromtxt(
        path, delimiter=",", names=True, dtype=None, encoding="utf-8", usecols=columns
    )


def read(path):
    """Rows of a table as dictionaries."""
    with path.open() as file:
        return list(csv.DictReader(file))


def write(path, header, rows):
    """Write a table."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
