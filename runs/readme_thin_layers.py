"""Tables of thin layers on the references of the particle laboratory, for its README."""

from runs.particle_laboratory.thin_layers import (
    FROM_CHUTE,
    FRONT_ASKED,
    FRONT_LIMIT,
    LENGTHS,
    TEACHER,
    THICKNESS_ASKED,
    THICKNESS_LIMIT,
    VARIANTS,
)
from runs.readme_particles import MM, made, rows_of
from runs.readme_tables import rounded, signed, span, table

THIN = ("thin_layers.csv", "thin_layers_finer.csv")
MORE = {"b03": ", frictionless walls"}  # what a reference has beside its slope
NOTES = {f"thickness, L = {FROM_CHUTE:g} d": ", the least of the chute"}


def thin_rows():
    """The rows of the tables of thin layers."""
    return [row for name in THIN for row in rows_of(name)]


def by_size(rows):
    """{cell size: its rows}, the coarser first."""
    found = {}
    for row in rows:
        found.setdefault(row["cell_size"], []).append(row)
    return found


def thin_layers():
    """Every reference with every length of thin layers, a table for each cell size."""
    text = ""
    for size, rows in by_size(thin_rows()).items():
        cells = {(row["experiment"], row["variant"]): both(row) for row in rows}
        slopes = {row["experiment"]: row["slope_deg"] for row in rows}
        told = list(dict.fromkeys(row["variant"] for row in rows))
        lines = [
            (f"`{name}`, {slope}°{MORE.get(name, '')}", *(cells[name, of] for of in told))
            for name, slope in slopes.items()
        ]
        heading = ("reference", *(of.removeprefix("thickness, ") for of in told))
        text += f"{rounded(size, scale=MM)} mm cells:\n\n{table(heading, lines)}\n"
    return text.removesuffix("\n") + made(*THIN)


def both(row, digits=0):
    """Front at rest less measured and final thickness of a row, mm."""
    front = signed(row["front_difference"], digits, MM)
    return f"{front}, {rounded(row['final_thickness_rms'], 1, MM)}"


def chosen(rows):
    """The variant that the rule chooses, None if no length passes."""
    teaching = {row["variant"]: row for row in rows if row["experiment"] == TEACHER}
    for length in LENGTHS:
        variant = f"thickness, L = {length:g} d"
        if variant in teaching and within(teaching[variant], FRONT_LIMIT, THICKNESS_LIMIT):
            return variant
    return None


def within(row, front, thickness):
    """Whether a row lies within limits of the front at rest and of the final thickness, m."""
    return (
        abs(float(row["front_difference"])) <= front
        and float(row["final_thickness_rms"]) <= thickness
    )


def rule():
    """All lengths on each cell size: the control of the rule, what it chooses, and the reach over all references."""
    lines = []
    for size, rows in by_size(thin_rows()).items():
        picked = chosen(rows)
        for variant in (of for of in VARIANTS if not of.startswith("nonlocal")):
            of = [row for row in rows if row["variant"] == variant]
            if not of:
                continue
            taught = next(f"{both(row, 1)} rms" for row in of if row["experiment"] == TEACHER)
            words = variant.removeprefix("thickness, ") + NOTES.get(variant, "")
            choice = ": chosen" if variant == picked else ""
            lines.append((f"{rounded(size, scale=MM)} mm", words, taught + choice, *reach(of)))
    asked = f"{rounded(FRONT_ASKED, scale=MM)} mm and {rounded(THICKNESS_ASKED, 1, MM)} mm rms"
    heading = ("cells", "`thin_layer`", "the 10° control (mm)", "front at rest, all references")
    heading = (*heading, "final thickness, rms", f"within {asked}")
    return table(heading, lines) + made(*THIN)


def reach(rows):
    """Range of fronts and of thicknesses, and the number of references within what was asked."""
    fronts = [float(row["front_difference"]) for row in rows]
    heights = [float(row["final_thickness_rms"]) for row in rows]
    met = sum(within(row, FRONT_ASKED, THICKNESS_ASKED) for row in rows)
    return (
        f"{span(fronts, lambda value: signed(value, 1, MM))} mm",
        f"{span(heights, lambda value: rounded(value, 1, MM))} mm",
        f"{met} of {len(rows)}",
    )
