"""Figures 16 and 17: profiles at 22 deg, 1.76 s and 1.5 s, for variable and constant viscosity.

python -m plots.paper_deposits
"""

from fvcollapse.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import PURPLE, WIDTH_NAME, draw_line, main, panels, save

LAWS = {
    "η_I": ("muI", BLUE),
    "0.4 Pa s": ("eta0.4", PURPLE),
    "1 Pa s": ("eta1", GREEN),
    "2 Pa s": ("eta2", ORANGE),
}
DEPOSIT = """
Figure 16 of the paper: thickness at 22 deg, w = 10 cm, t = 1.76 s, for η_I and constant viscosities.
"""
DOMAIN = """
Figure 17 of the paper: surface at 22 deg, t = 1.5 s, with and without lateral friction (the paper does not say
which), η_I and η_c = 0.4 Pa s. Roughness: rms deviation of the surface from a smooth one over 15 cm.
"""


def draw(of):
    """Both figures."""
    figure, axes = panels(1, 1, (9.0, 3.6))
    for label, (law, colour) in LAWS.items():
        draw_line(axes[0, 0], of, f"{law}_a22_w10", "thickness_mm", 1.76, color=colour, label=label)
    finish(axes[0, 0])
    save(figure, "paper_16_deposits", of, DEPOSIT, ("lateral_friction", "viscosity"))
    figure, axes = panels(2, 1, (9.0, 5.6), sharex=True)
    for panel, width in zip(axes[:, 0], ("w10", "winf"), strict=True):
        for label in ("η_I", "0.4 Pa s"):
            law, colour = LAWS[label]
            case = f"{law}_a22_{width}"
            rough = of.value(case, "roughness_1.5_mm")
            words = f"{label}, roughness {rough.value:.2f} ± {rough.uncertainty:.2f} mm"
            draw_line(panel, of, case, "thickness_mm", 1.5, color=colour, label=words)
        finish(panel)
        panel.set_title(WIDTH_NAME[width], fontsize="medium")
    axes[0, 0].set_xlabel("")
    save(figure, "paper_17_domain", of, DOMAIN, ("lateral_friction", "viscosity"))


def finish(axes):
    """Labels and limits."""
    axes.set(xlabel="distance from the back wall (m)", ylabel="height (mm)")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    axes.legend(frameon=False, fontsize="small")


if __name__ == "__main__":
    main(draw)
