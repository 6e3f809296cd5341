"""Figure 16: profiles at 22 deg and 1.76 s for variable and constant viscosity.

python -m plots.paper_deposits
"""

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import PURPLE, draw_line, finish_profile, main, panels, save

LAWS = {
    "η_I": ("muI", BLUE),
    "0.4 Pa s": ("eta0.4", PURPLE),
    "1 Pa s": ("eta1", GREEN),
    "2 Pa s": ("eta2", ORANGE),
}
CAPTION = """
Figure 16 of the paper: thickness at 22 deg, w = 10 cm, t = 1.76 s, for η_I and constant viscosities.
"""


def draw(of):
    """One panel."""
    figure, axes = panels(1, 1, (9.0, 3.6))
    for label, (law, colour) in LAWS.items():
        style = {"color": colour, "label": label, "ls": "--" if law == "eta0.4" else "-"}
        draw_line(axes[0, 0], of, f"{law}_a22_w10", "thickness_mm", 1.76, **style)
    finish_profile(axes[0, 0])
    save(figure, "paper_16_deposits", of, CAPTION, ("lateral_friction", "viscosity"))


if __name__ == "__main__":
    main(draw)
