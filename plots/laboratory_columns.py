"""The gap of the model on real grains: 28 columns of glass beads between walls, from runs/laboratories/columns.csv.

    python -m plots.laboratory_columns

Writes plots/figures/laboratory_columns.png and its caption (.txt); nothing is computed here.
"""

from pathlib import Path

import numpy as np

from fvcollapse.draw.drawing import BLUE, GREY, ORANGE, new_figure, png
from fvcollapse.files.atomic import write_atomic
from runs.table import RUNS, read_table

HERE = Path(__file__).parent
WALLS = ("absent", "measured")
QUANTITIES = ("runout", "final_height")
SOURCE = RUNS / "laboratories"
LABELS = {
    "runout": "run-out, computed / measured",
    "final_height": "final height, computed / measured",
}
COLOURS = {"absent": BLUE, "measured": ORANGE}
WORDS = {"absent": "walls without friction", "measured": "measured friction of the walls"}
CAPTION = """\
Twenty-eight columns of glass beads released between walls 45 mm apart (Lajeunesse et al. 2005, digitised; the size of
the columns is an assumption), against aspect ratio. Open: the constants that the laboratory states, with and
without the measured friction of the lateral walls. Filled, with it: {factor:.2f} of the stated friction of the grains
at rest in all columns, fitted to two columns of three. Grey: one standard deviation of the measurement.
"""


def panel(axes, rows, fits):
    """Computed over measured, with the stated friction and with the fitted one."""
    for walls in WALLS:
        own = [row for row in rows if row["walls"] == walls]
        aspect, measured, sigma = (
            np.array([float(row[name]) for row in own]) for name in ("aspect", "measured", "sigma")
        )
        if walls == "absent":
            axes.fill_between(
                aspect, 1.0 - sigma / measured, 1.0 + sigma / measured, color=GREY, alpha=0.35, lw=0
            )
            axes.axhline(1.0, color=GREY, lw=1.0)
        fitted = float(fits[walls]["factor"])
        shown = {"computed_fitted": (fitted, COLOURS[walls]), "computed_1": (1.0, "none")}
        for name, (factor, face) in shown.items():
            if name == "computed_fitted" and fitted == 1.0:
                continue
            ratio = [float(row[name]) / float(row["measured"]) for row in own]
            axes.plot(
                aspect,
                ratio,
                "o",
                ms=4.5,
                mfc=face,
                mec=COLOURS[walls],
                label=f"{WORDS[walls]}, {words_of(factor)}",
            )
    axes.set_xscale("log")
    axes.set_xticks([0.2, 0.5, 1, 2, 5, 10, 20], ["0.2", "0.5", "1", "2", "5", "10", "20"])
    axes.minorticks_off()
    axes.set_xlabel("aspect ratio of the column")


def words_of(factor):
    """A friction of the grains in words."""
    return "stated" if factor == 1.0 else rf"{factor:.2f} $\times$ $\mu_1$"


def main():
    """Draw the figure."""
    rows = read_table(SOURCE / "columns.csv")
    fits = {row["walls"]: row for row in read_table(SOURCE / "columns_fit.csv")}
    figure = new_figure(9.5, 4.6)
    panels = figure.subplots(1, 2)
    for axes, quantity in zip(panels, QUANTITIES, strict=True):
        panel(axes, [row for row in rows if row["quantity"] == quantity], fits)
        axes.set_ylabel(LABELS[quantity])
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, fontsize=9, frameon=False)
    path = HERE / "figures" / "laboratory_columns.png"
    write_atomic(path, png(figure))
    write_atomic(
        path.with_suffix(".txt"), CAPTION.format(factor=float(fits["measured"]["factor"])).encode()
    )
    print(path)


if __name__ == "__main__":
    main()
