"""Computed collapses beside those of other people, from the tables of runs/comparison.

    python -m plots.comparison

Writes plots/figures/comparison_<name>.png and its caption (.txt); nothing is computed here.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from runs.table import RUNS, read_table

HERE = Path(__file__).parent
SOURCE = RUNS / "comparison"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
VARIANTS = (  # end of the name, line, label
    ("", "C0-o", "computed"),
    ("_smooth_sides", "C1^", "without lateral friction"),
    ("_rough_bed", "C2x", "no slip on the bed"),
    ("_half_size", "C3+", "half the size"),
)
CAPTIONS = {
    "discs_a0.5": """
Column of aspect ratio 0.5 against discs (grey; contact dynamics, mean of both sides of the pile), h0/26 cells. mu(I)
0.32/0.60/0.40, d = h0/30, rough bed, symmetry plane; t* = t sqrt(g/h0), of the discs inferred in the data.
""",
    "discs_a6.26": """
Column of aspect ratio 6.26 against discs (grey; contact dynamics, mean of both sides of the pile). mu(I)
0.32/0.60/0.40, d = h0/134, rough bed, symmetry plane; t* = t sqrt(g/h0).
""",
    "volume_of_fluid": """
Column of aspect ratio 0.5 in the set-up of the volume-of-fluid solution (grey; cells of h0/25.6), on three grids.
""",
    "channel": """
Runout (at two bead diameters) and final height of glass beads in a channel 45 mm wide. Computed with the measured wall
friction on the lateral walls, the bed and the back wall, and mu_1 of the repose angle; nothing is tuned. The size of
the column is not in the data: 64 cm2 assumed; "half the size" shows what it does. Bars: reading and scatter.
""",
    "deposit_shape": """
Deposit: height over the largest against distance over the distance where 2 % of it is left. Grey: dimensionless shape
of the experiments, valid where the flat top is consumed.
""",
}


def discs(name, runs, times):
    """Profiles of a column of discs at several times, one panel each."""
    given = by_time(read_table(SOURCE / "reference" / f"discs_{name}.csv"))
    computed = read_table(SOURCE / "columns_profiles.csv")
    panels(name=f"discs_{name}", given=given, computed=computed, runs=runs, times=times)


def volume_of_fluid():
    """Profiles of the volume-of-fluid set-up on three grids."""
    given = by_time(read_table(SOURCE / "reference" / "volume_of_fluid_a0.5.csv"))
    computed = read_table(SOURCE / "volume_of_fluid_profiles.csv")
    runs = {f"cells{n}": (f"h0/{n}", style) for n, style in ((13, ":"), (26, "--"), (52, "-"))}
    panels("volume_of_fluid", given, computed, runs, (1, 2, 3, 4))


def panels(name, given, computed, runs, times):
    """One panel per time: the reference in grey, the runs {name: (label, line style)} coloured."""
    figure, axes = plt.subplots(
        len(times), figsize=(6.0, 1.4 * len(times)), sharex=True, layout="constrained"
    )
    for panel, t_star in zip(axes, times, strict=True):
        panel.fill_between(*given[float(t_star)], color="0.8", label="reference")
        for number, (run, (label, style)) in enumerate(runs.items()):
            curves = by_time([row for row in computed if row["name"] == run])
            panel.plot(*curves[float(t_star)], style, color=COLOURS[number], lw=1.2, label=label)
        panel.set_title(f"t* = {t_star}", loc="right", y=0.76, fontsize=9)
        panel.set_ylabel("h/h$_0$")
        panel.set_ylim(bottom=0.0)
    axes[-1].set_xlim(left=0.0)
    axes[-1].set_xlabel("distance from the symmetry plane / h$_0$")
    axes[0].legend(loc="center right", fontsize=8)
    save(figure, name)


def channel():
    """Runout and final height against aspect ratio."""
    runs = sorted(read_table(SOURCE / "channel.csv"), key=lambda row: float(row["aspect"]))
    figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.6), layout="constrained")
    for panel, file, column, label in (
        (axes[0], "runout", "runout_over_l0", "(runout - l$_0$) / l$_0$"),
        (axes[1], "final_height", "final_height_over_l0", "final height / l$_0$"),
    ):
        points = read_table(SOURCE / "reference" / f"beads_{file}.csv")
        a, value, error = ([float(row[key]) for row in points] for key in ("a", "value", "error"))
        panel.errorbar(a, value, error, fmt="o", color="0.5", ms=4, label="measured")
        for suffix, style, name in VARIANTS:
            line = [row for row in runs if row["name"] == f"a{float(row['aspect']):g}{suffix}"]
            curve = [[float(row[key]) for row in line] for key in ("aspect", column)]
            panel.plot(*curve, style, ms=5, label=name)
        panel.set(xscale="log", yscale="log", xlabel="aspect ratio h$_0$/l$_0$", ylabel=label)
    axes[0].legend(fontsize=8)
    save(figure, "channel")


def deposit_shape():
    """Dimensionless deposits."""
    figure, axes = plt.subplots(figsize=(5.5, 4.0), layout="constrained")
    points = read_table(SOURCE / "reference" / "deposit_shape.csv")
    x, y = ([float(row[key]) for row in points] for key in ("x_star", "y_star"))
    axes.plot(x, y, "o", color="0.5", ms=4, label="measured")
    shapes = read_table(SOURCE / "deposit_shapes.csv")
    for number, label in enumerate(dict.fromkeys(row["deposit"] for row in shapes)):
        line = [row for row in shapes if row["deposit"] == label]
        x, y = ([float(row[key]) for row in line] for key in ("x_star", "y_star"))
        style = "-" if label.startswith("beads") else "--"
        axes.plot(x, y, style, color=COLOURS[number % len(COLOURS)], lw=1.2, label=label)
    axes.set(xlabel="distance / runout", ylabel="h / largest h", xlim=(0, 1.05), ylim=(0, 1.05))
    axes.legend(fontsize=8)
    save(figure, "deposit_shape")


def by_time(rows):
    """Distances and heights of each time, from the rows of a profile table."""
    curves = {}
    for row in rows:
        x, h = curves.setdefault(float(row["t_star"]), ([], []))
        x.append(float(row["x_over_h0"]))
        h.append(float(row["h_over_h0"]))
    return curves


def save(figure, name):
    """Write the picture and its caption."""
    path = HERE / "figures" / f"comparison_{name}"
    figure.savefig(f"{path}.png", dpi=120)
    plt.close(figure)
    Path(f"{path}.txt").write_text(CAPTIONS[name].lstrip() + "Source: runs/comparison.\n")


if __name__ == "__main__":
    discs("a0.5", {"a0.5": ("computed", "-")}, (1, 2, 3, 4, 8))
    fine = {"a6.26_fine": ("h0/100", "-"), "a6.26": ("h0/64", ":")}
    discs("a6.26", fine, (1, 2, 3, 4, 6))
    volume_of_fluid()
    channel()
    deposit_shape()
