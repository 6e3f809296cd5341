"""Runout against slope for the three channel widths, from runs/acceptance/matrix.csv and grid.csv.

    python -m plots.runout_against_slope

Writes plots/figures/runout_against_slope.png, the numbers drawn (.csv) and the caption (.txt).
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from runs.table import RUNS, read_table, write_table

HERE = Path(__file__).parent
SOURCE = RUNS / "acceptance" / "matrix.csv"
GRID = RUNS / "acceptance" / "grid.csv"
FIGURE = HERE / "figures" / "runout_against_slope"
STYLES = {
    "0.1": ("#0072b2", "o", "w = 10 cm"),
    "0.2": ("#009e73", "s", "w = 20 cm"),
    "inf": ("#d55e00", "^", "w = ∞"),
}
CAPTION = """Runout from the back wall at 5 mm thickness against slope, mu(I) with the paper's Table I, 6 mm cells,
lateral friction 0.18. From 6 to 3 mm cells the value at 22 deg and w = 10 cm moves by {moves:+.1f} %
(runs/acceptance/grid.csv).
Source: runs/acceptance/matrix.csv.
"""


def points():
    """Rows (width, slope in degrees, runout in m), sorted."""
    rows = read_table(SOURCE)
    parsed = [(*row["name"].removeprefix("a").split("_w"), float(row["runout"])) for row in rows]
    return sorted((width, float(slope), runout) for slope, width, runout in parsed)


def caption():
    """The caption, with the change of the runout between grids."""
    runout = {row["name"]: float(row["runout"]) for row in read_table(GRID)}
    return CAPTION.format(moves=100.0 * (runout["dx3mm"] / runout["dx6mm"] - 1.0))


def draw(rows):
    """One line per width."""
    figure, axes = plt.subplots(figsize=(5.5, 4.0), layout="constrained")
    for width, (colour, marker, label) in STYLES.items():
        line = [(slope, runout) for name, slope, runout in rows if name == width]
        axes.plot(*zip(*line, strict=True), color=colour, marker=marker, label=label)
    axes.set_xlabel("slope (deg)")
    axes.set_ylabel("runout from the back wall (m)")
    axes.legend()
    figure.savefig(FIGURE.with_suffix(".png"), dpi=150)


if __name__ == "__main__":
    drawn = points()
    draw(drawn)
    columns = ("width_m", "slope_deg", "runout_m")
    rows = (dict(zip(columns, point, strict=True)) for point in drawn)
    write_table(FIGURE.with_suffix(".csv"), rows)
    FIGURE.with_suffix(".txt").write_text(caption(), encoding="utf-8")
