"""Figures 7 and 8: front velocity with and without lateral friction.

python -m plots.paper_front_walls
"""

from plots.paper_style import ABOUT_VELOCITY, main, save, velocities_by_slope

LAWS = {"without": ("muI_a{slope}_winf", "--"), "with": ("muI_a{slope}_{width}", "-")}
CAPTION = "Figures 7 and 8 of the paper: µ(I) with (solid) and without (dashed) lateral friction."


def draw(of):
    """One panel per width."""
    figure = velocities_by_slope(of, LAWS, (10, 16, 22), ("w10", "w20"), "lateral friction")
    groups = ("lateral_friction",)
    save(figure, "paper_07_08_front_walls", of, CAPTION + ABOUT_VELOCITY, groups)


if __name__ == "__main__":
    main(draw)
