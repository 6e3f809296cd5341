"""Figures 5 and 6: relative change of the volume against time.

python -m plots.paper_volume
"""

from plots.paper_style import SLOPE_COLOUR, WIDTH_NAME, main, panels, save

CAPTION = """
Figures 5 and 6 of the paper: relative change of the volume (above; the flow is incompressible, so this is
error) and running sum of the corrections that keep it so (below), µ(I) with lateral friction. The paper's own
simulations lose 2–3 %; its experiments dilate by up to 3 % (w = 10 cm) and 10 % (20 cm), which no
incompressible model can show.
"""


def draw(of):
    """One column per width."""
    figure, axes = panels(2, 2, (9.0, 5.0), sharex=True, sharey="row")
    for column, width in enumerate(("w10", "w20")):
        for slope in (0, 10, 16, 22):
            style = {"color": SLOPE_COLOUR[slope], "label": f"{slope}°", "lw": 1.3}
            for row, name in enumerate(("volume_percent", "correction_percent")):
                axes[row, column].plot(*of.line(f"muI_a{slope}_{width}", name), **style)
        axes[0, column].set_title(WIDTH_NAME[width], fontsize="medium")
        axes[1, column].set(xlabel="time (s)", xlim=(0.0, 2.5))
    axes[0, 0].set_ylabel("change of the volume (%)")
    axes[1, 0].set_ylabel("sum of |corrections| (%)")
    axes[1, 0].legend(frameon=False, fontsize="small", ncols=2)
    save(figure, "paper_05_06_volume", of, CAPTION, ("lateral_friction",))


if __name__ == "__main__":
    main(draw)
