"""Figures 12 and 13: front velocity with eta_I and with the bounds of its range.

python -m plots.paper_front_bounds
"""

from plots.paper_style import ABOUT_VELOCITY, main, save, velocities_by_slope

LAWS = {
    "1 Pa s": ("eta1_a{slope}_{width}", "--"),
    "0.1 Pa s": ("eta0.1_a{slope}_{width}", ":"),
    "η_I": ("muI_a{slope}_{width}", "-"),
}
CAPTION = "Figures 12 and 13 of the paper: η_I (solid), η_c = 0.1 (dotted) and 1 Pa s (dashed)."


def draw(of):
    """One panel per width."""
    figure = velocities_by_slope(of, LAWS, (10, 16, 22), ("w10", "w20"), "viscosity")
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_12_13_front_bounds", of, CAPTION + ABOUT_VELOCITY, groups)


if __name__ == "__main__":
    main(draw)
