"""Figures 9 and 10: front velocity with eta_I and with a constant 0.4 Pa s.

python -m plots.paper_front_viscosity
"""

from plots.paper_style import ABOUT_VELOCITY, main, save, velocities_by_slope

LAWS = {"0.4 Pa s": ("eta0.4_a{slope}_{width}", "--"), "η_I": ("muI_a{slope}_{width}", "-")}
CAPTION = "Figures 9 and 10 of the paper: η_I (solid) against η_c = 0.4 Pa s (dashed)."


def draw(of):
    """One panel per width."""
    figure = velocities_by_slope(of, LAWS, (0, 10, 16, 19, 22), ("winf", "w10"), "viscosity")
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_09_10_front_viscosity", of, CAPTION + ABOUT_VELOCITY, groups)


if __name__ == "__main__":
    main(draw)
