"""The computed collapses against the published ones, in units of the uncertainty of the data.

`compare` reads the tables of the study and the published data, writes differences.csv and the reference
curves that the figures draw, and prints the table.
"""

import json

import numpy as np

from fvcollapse.measure.pile import front_position
from runs.comparison.analysis import (
    asymmetry,
    l1_difference,
    mean_half,
    scaled_to_area,
    top_of_segments,
)
from runs.comparison.experiments import channel, laws, shape
from runs.comparison.tables import (
    AT,
    PROFILE_HEADER,
    computed_profile,
    line,
    profile,
    profile_rows,
    table,
)

THIN = 0.03  # thickness at the front, in column heights
VOF_CELL = 5.0 / 128.0  # cell of the volume-of-fluid solution, in column heights
VOF_FRONTS = (2.39, 3.17, 3.64, 3.86)  # at t* = 1 ... 4, from the symmetry plane
VOF_L1 = (0.040, 0.043, 0.043, 0.027)  # its published distance from the discs
DISCS = {"0.5": 1 / 30, "6.26": 1 / 134}  # disc diameter in column heights
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


def compare(of):
    """Write and print differences.csv; `of` are the `Folders`."""
    for part in ("columns", "volume_of_fluid", "channel", "plane"):
        of.computed(part)  # refuses one that is missing
    rows = [
        *discs("0.5", of),
        *discs("6.26", of),
        *discs("6.26", of, "_fine"),
        *dated_discs(of),
        *dated_discs(of, "_fine"),
        *volume_of_fluid(of),
        *channel(of),
        *shape(of),
        *laws(of),
    ]
    of.write("differences.csv", HEADER, rows)
    for row in rows:
        if not row[1].endswith("(point)"):
            print("".join(f"{str(item):<{width}}" for item, width in zip(row, WIDTHS, strict=True)))


WIDTHS = (36, 36, 12, 10, 10, 10, 10, 8)


# -- discs and the volume-of-fluid solution ----------------------------------------------------


def discs(aspect, of, variant=""):
    """Fronts, heights and L1 differences of one column of discs, at the whole t*."""
    folder = of.data / "particles" / "contact_dynamics"
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
        h = computed_profile(of, "columns", f"a{aspect}{variant}", row["k"])
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
    of.write(f"reference/discs_a{aspect}.csv", PROFILE_HEADER, curves)
    return rows


def l1_line(name, t_star, found, floor):
    """L1 difference: no data, but the distance of one side of the discs from the mean as unit."""
    ratio = round(found / floor, 2)
    quantity = "L1 to the mean of both sides"
    return name, quantity, f"t* = {t_star}", 0.0, round(floor, 4), round(found, 4), "", ratio


def dated_discs(of, variant=""):
    """The same column at dated instants: 99 % of the discs, solid area per column."""
    folder = of.data / "particles" / "contact_dynamics"
    name, grain, rows = f"dated discs a = 6.26{variant.replace('_', ', ')}", DISCS["6.26"], []
    run = next(row for row in of.computed("columns") if row["name"] == f"a6.26{variant}")
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
            h = np.interp(x, *profile(of, "columns", f"a6.26{variant}", row["t_star"]), right=0.0)
            found = l1_difference(x, h, scaled_to_area(x, solid, h))
            rows.append((name, "L1 to the solid area", at, 0.0, "", round(found, 4), "", ""))
    return rows


def volume_of_fluid(of):
    """Fronts and L1 differences of the volume-of-fluid set-up on three grids."""
    facets = table(of.data / "continuum" / "basilisk_muI_column" / "interface_a0.5.csv")
    rows, curves = [], []
    for t_star in range(5):
        here = facets["t_star"] == t_star
        top = top_of_segments(facets["x_over_H0"][here], facets["y_over_H0"][here], AT)
        curves += profile_rows(t_star, top)
        if t_star == 0:
            continue
        at, published, given = f"t* = {t_star}", VOF_L1[t_star - 1], VOF_FRONTS[t_star - 1]
        own = reference_l1(of, t_star, top)
        rows.append(line("the other solver", "its L1 to the discs", at, published, None, own))
        for cells in (13, 26, 52):
            name = f"volume of fluid, h0/{cells}"
            h = computed_profile(of, "volume_of_fluid", f"cells{cells}", t_star)
            for label, level in (("0.03 h0", THIN), ("0.01 h0", 0.01)):
                found = front_position(AT, h, level)
                rows.append(line(name, f"front at {label}", at, given, VOF_CELL, found))
            found = reference_l1(of, t_star, h)
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
    of.write("reference/volume_of_fluid_a0.5.csv", PROFILE_HEADER, curves)
    return sorted(rows, key=lambda row: row[0]) + finer_volume_of_fluid(of)


def finer_volume_of_fluid(of):
    """The other solver on a grid twice as fine against the computation on one twice as fine."""
    rows = []
    for row in table(of.data / "peers" / "basilisk_vs_contact_dynamics.csv"):
        if row["level"] == 8 and row["aspect"] == 0.5 and row["t_over_T"] > 0:
            at, name = f"t* = {row['t_over_T']}", "volume of fluid, its h0/51, h0/52"
            h = computed_profile(of, "volume_of_fluid", "cells52", row["t_over_T"])
            found, given = front_position(AT, h, THIN), row["front_last_h003"]
            rows.append(line(name, "front at 0.03 h0", at, given, 0.5 * VOF_CELL, found))
            found = reference_l1(of, row["t_over_T"], h)
            rows.append(line(name, "L1 to the discs", at, row["L1_rel_diff"], None, found))
    return rows


def reference_l1(of, t_star, h):
    """L1 difference of a profile on AT to the column of discs of aspect ratio 0.5."""
    outline = table(of.data / "particles" / "contact_dynamics" / "profiles_a0.5.csv")
    here = outline["k"] == t_star
    mean = mean_half(outline["x_over_H0"][here], outline["h_over_H0"][here], AT)
    return l1_difference(AT, h, mean)
