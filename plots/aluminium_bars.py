"""The collapse of aluminium bars beside the model, from runs/comparison/bars.csv and bars_profiles.csv.

    python -m plots.aluminium_bars

Writes plots/figures/aluminium_bars.png and its caption (.txt); nothing is computed here.
"""

import numpy as np

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE, new_figure
from plots.paper_style import write_picture
from runs.table import RUNS, read_table

SOURCE = RUNS / "comparison"
LAWS = {  # law of the tables: words, colour
    "mu(I) of discs: 0.60, 0.40": ("µ₂ = 0.60, I₀ = 0.40", BLUE),
    "mu(I) as the default: 0.73, 0.279": ("µ₂ = 0.73, I₀ = 0.279", ORANGE),
    "Drucker-Prager, 0.02 Pa s": ("Drucker\N{EN DASH}Prager, 0.02 Pa s", GREEN),
}
PANELS = {"without": "without thin_layer", "thickness": "with thin_layer, 1.65 d"}
CAPTION = """
Aluminium bars released at once on a level bed (Bui et al. 2008) and the model, without and with thin_layer.
Thick grey line: the deposit as measured. Grey dots: the measured failure line, below which no bar moved. Solid
lines: the deposits of the model. Dashed lines: the height below which the grains of the model were never faster
than 0.01 m/s. µ₁ = tan 19.8° as measured, no slip on the bed, cells of 4 mm. The friction at high speed, µ₂ and
I₀, was not measured; each colour is one choice. Fronts, where the deposit is 1.5 mm thick: measured {measured}
mm; {fronts}.
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
        f"{words}: {float(fronts[law, 'without']):.0f} mm without and {float(fronts[law, 'thickness']):.0f} mm with "
        "thin_layer"
        for law, (words, _) in LAWS.items()
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
    write_picture(figure, "aluminium_bars", caption())


if __name__ == "__main__":
    main()
