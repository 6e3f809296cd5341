"""Figure 17: the surface at 22 deg and 1.5 s for variable and constant viscosity.

python -m plots.paper_domain
"""

from fvcollapse.draw.drawing import BLUE
from plots.paper_style import (
    PURPLE,
    WIDTH_NAME,
    draw_line,
    finish_profile,
    main,
    panels,
    save,
)

LAWS = {"η_I": ("muI", BLUE), "0.4 Pa s": ("eta0.4", PURPLE)}
CAPTION = """
Figure 17 of the paper: surface at 22 deg, t = 1.5 s, with and without lateral friction (the paper does not say
which), η_I and η_c = 0.4 Pa s. Roughness: rms deviation of the surface from a smooth one over 15 cm.
"""


def draw(of):
    """One panel per width."""
    figure, axes = panels(2, 1, (9.0, 5.6), sharex=True)
    for panel, width in zip(axes[:, 0], ("w10", "winf"), strict=True):
        for label, (law, colour) in LAWS.items():
            case = f"{law}_a22_{width}"
            rough = of.value(case, "roughness_1.5_mm")
            words = f"{label}, roughness {rough.value:.2f} ± {rough.uncertainty:.2f} mm"
            style = {"color": colour, "label": words, "ls": "-" if law == "muI" else "--"}
            draw_line(panel, of, case, "thickness_mm", 1.5, **style)
        finish_profile(panel)
        panel.set_title(WIDTH_NAME[width], fontsize="medium")
    axes[0, 0].set_xlabel("")
    save(figure, "paper_17_domain", of, CAPTION, ("lateral_friction", "viscosity"))


if __name__ == "__main__":
    main(draw)
