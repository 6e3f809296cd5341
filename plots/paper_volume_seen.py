"""What a side view makes of the volume at 22 deg: which effects swell it by as much as measured, and which come back.

python -m plots.paper_volume_seen
"""

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE
from plots.paper_style import FIGURES, PURPLE, SKY, YELLOW, key, main, panels, write_picture
from runs.paper.volume import KINDS, MAIN, WANTED, WIDTHS, name_of
from runs.table import MissingRun, as_line, read_table

WORDS = (  # of the kinds, in their order
    "dilatancy, dense at first (0.64 to 0.585)",
    "dilatancy, dense at first (0.62 to 0.60)",
    "dilatancy, from the critical fraction",
    "view at the wall, 1.2 times faster in the middle",
    "layers below 5 mm not seen",
    "bed read one grain too low",
    "exposure of 20 ms",
    "beads that leave with 0.1 of the speed",
)
COLOURS = (ORANGE, YELLOW, GREEN, PURPLE, GREY, "black", SKY, BLUE)
CAPTION = """
Change of the area that a side view sees at 22 deg, grains of {grains} on a bed without slip: what each effect alone
does. Dots: the largest swelling of the experiments, 3 % (w = 10 cm) and 10 % (20 cm), after which the volume comes
back. Numbers drawn: runs/paper/volume/changes.csv.
"""


def draw(of):
    """One panel per width."""
    lines = {row["case"]: as_line(row) for row in read_table(of.folder / "volume" / "changes.csv")}
    figure, axes = panels(1, 2, (13.0, 4.6), sharex=True, sharey=True)
    for panel, width, wanted in zip(axes[0], WIDTHS, WANTED, strict=False):
        for kind, colour in zip(KINDS, COLOURS, strict=True):
            name = name_of(MAIN, width, kind)
            if name not in lines:
                raise MissingRun(f"{name} is not in the table of the volume")
            panel.plot(*lines[name], color=colour, lw=1.5)
        panel.axhline(100.0 * wanted, color="black", ls=":", lw=1.2)
        panel.set(xlim=(0.0, 2.5), xlabel="time (s)", title=f"w = {100.0 * width:g} cm")
    axes[0, 0].set_ylabel("change of the volume seen (%)")
    styles = {word: {"color": c} for word, c in zip(WORDS, COLOURS, strict=True)}
    key(axes[0, 1], styles, loc="upper left", bbox_to_anchor=(1.02, 1.0))
    words = CAPTION.format(grains=MAIN.partition(";")[0])
    write_picture(figure, "paper_volume_seen", words, FIGURES)


if __name__ == "__main__":
    main(draw)
