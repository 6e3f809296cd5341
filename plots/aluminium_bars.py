"""The collapse of aluminium bars beside the model, from runs/comparison/bars.csv and bars_profiles.csv.

    python -m plots.aluminium_bars

Writes plots/figures/aluminium_bars.png and its caption (.txt); nothing is computed here.
"""

from pathlib import Path

import numpy as np

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE, new_figure, png
from fvcollapse.files.atomic import write_atomic
from runs.table import RUNS, read_table

HERE = Path(__file__).parent
SOURCE = RUNS / "comparison"
LAWS = {  # law of the tables: words, colour
    "mu(I) of discs: 0.60, 0.40": (r"$\mu_2$ = 0.60, $I_0$ = 0.40", BLUE),
    "mu(I) as the default: 0.73, 0.279": (r"$\mu_2$ = 0.73, $I_0$ = 0.279", ORANGE),
    "Drucker-Prager, 0.02 Pa s": ("Drucker\N{EN DASH}Prager, 0.02 Pa s", GREEN),
}
PANELS = {"without": "without thin_layer", "thickness": "with thin_layer, 1.65 d"}
CAPTION = """\
Aluminium bars released at once on a level bed (Bui et al. 2008, grey): deposit (thick), failure line (circles), below
which no bar moved. Model, mu_1 = tan 19.8 deg as measured, no slip on the bed, cells of 4 mm: deposit (lines) and the
height below which the grains were never faster than 0.01 m/s (dashed). The friction at high speed, mu_2 and I_0,
was not measured. Fronts, where the deposit is 1.5 mm thick: measured {measured} mm; {fronts}.
"""


def panel(axes, curves, effect):
    """Deposit and failure line, measured and of each law."""
    axes.plot(*curve(curves, "measured", "", "deposit"), color=GREY, lw=4.0, alpha=0.6)
    axes.plot(*curve(curves, "measured", "", "failure line"), "o", color=GREY, ms=4.0)
    for law, (words, colour) in LAWS.items():
        axes.plot(*curve(curves, law, effect, "deposit"), color=colour, lw=1.3, label=words)
        axes.plot(*curve(curves, law, effect, "failure line"), "--", color=colour, lw=1.0)
    axes.set(xlim=(0.0, 50.0), ylim=(0.0, 11.0), xlabel="X (cm)", title=PANELS[effect])


def curve(rows, law, effect, name):
    """Places and heights of a curve, cm."""
    own = [
        row for row in rows if (row["law"], row["thin_layer"], row["curve"]) == (law, effect, name)
    ]
    return [100.0 * np.array([float(row[of]) for row in own]) for of in ("x", "height")]


def caption():
    """The caption, with the fronts of the table."""
    fronts = {
        (row["law"], row["thin_layer"]): row["front"] for row in read_table(SOURCE / "bars.csv")
    }
    told = "; ".join(
        f"{law}: {float(fronts[law, 'without']):.0f} without and {float(fronts[law, 'thickness']):.0f} with thin_layer"
        for law in LAWS
    )
    return CAPTION.format(measured=f"{float(fronts['measured', '']):.0f}", fronts=told)


def main():
    """Draw the figure."""
    curves = read_table(SOURCE / "bars_profiles.csv")
    figure = new_figure(9.0, 3.6)
    for axes, effect in zip(figure.subplots(1, 2, sharey=True), PANELS, strict=True):
        panel(axes, curves, effect)
    figure.axes[0].set_ylabel("height (cm)")
    figure.axes[0].legend(fontsize=8)
    write_atomic(HERE / "figures" / "aluminium_bars.png", png(figure))
    write_atomic(HERE / "figures" / "aluminium_bars.txt", caption().encode())


if __name__ == "__main__":
    main()
