"""Figures 3 and 4: profiles and static–flowing interface at 10 and 22 deg, with and without lateral friction.

python -m plots.paper_profiles
"""

from fvcollapse.draw.drawing import BLUE, ORANGE
from plots.paper_style import WIDTH_NAME, draw_line, key, main, panels, save

FIGURES = {  # number: (slope, times at w = 10 cm, at w = 20 cm)
    3: (10, (0.18, 0.48, 1.0), (0.18, 0.48, 1.02)),
    4: (22, (0.32, 0.96, 1.76), (0.30, 1.02, 1.8)),
}
CAPTION = """
Figure {number} of the paper: thickness (solid) and static–flowing interface (0.01 m/s, dashed) at {slope} deg,
µ(I), with (blue) and without (orange) lateral friction. Heights are exaggerated.
"""


def draw(of):
    """Both figures."""
    for number, (slope, narrow, wide) in FIGURES.items():
        figure, axes = panels(3, 2, (10.0, 7.0), sharex="row", sharey="row")
        for column, (width, times) in enumerate((("w10", narrow), ("w20", wide))):
            for row, time in enumerate(times):
                panel(axes[row, column], of, slope, width, time)
            axes[0, column].set_title(f"{slope}°, {WIDTH_NAME[width]}", fontsize="medium")
            axes[2, column].set_xlabel("distance from the back wall (m)")
            colours = {WIDTH_NAME[width]: {"color": BLUE}, "w = ∞": {"color": ORANGE}}
            key(axes[2, column], colours, loc="center right")
        for row in range(3):
            axes[row, 0].set_ylabel("height (mm)")
        save(
            figure,
            f"paper_{number:02d}_profiles_{slope}deg",
            of,
            CAPTION.format(number=number, slope=slope),
            ("lateral_friction",),
        )


def panel(axes, of, slope, width, time):
    """One time and width, and w = ∞ at the same time."""
    for case, colour in ((f"muI_a{slope}_winf", ORANGE), (f"muI_a{slope}_{width}", BLUE)):
        draw_line(axes, of, case, "thickness_mm", time, color=colour, lw=1.4)
        draw_line(axes, of, case, "static_mm", time, color=colour, lw=1.0, ls="--")
    axes.text(0.98, 0.9, f"t = {time:.2f} s", transform=axes.transAxes, ha="right", va="top")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))


if __name__ == "__main__":
    main(draw)
