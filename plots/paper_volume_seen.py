"""What a side view makes of the volume at 22 deg: which effects swell it by as much as measured, and which come back.

python -m plots.paper_volume_seen
"""

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE
from plots.paper_style import PURPLE, SKY, YELLOW, key, main, panels, write_picture
from runs.table import MissingRun, as_line, read_table

GRAINS = "0.44, 0.69; no slip"  # in the names of the table
WANTED = {"w = 10 cm": 3.0, "w = 20 cm": 10.0}  # %, largest swelling of the experiments
KINDS = {  # in the names of the table: words, colour
    "K = 5, b = 0.2, 0.64 to 0.585; grains": ("dilatancy, dense at first (0.64 to 0.585)", ORANGE),
    "K = 4, 0.62 to 0.60; grains": ("dilatancy, dense at first (0.62 to 0.60)", YELLOW),
    "K = 4, from 0.60; grains": ("dilatancy, from the critical fraction", GREEN),
    "ratio 1.2; from the wall": ("view at the wall, 1.2 times faster in the middle", PURPLE),
    "plain; from 5 mm on": ("layers below 5 mm not seen", GREY),
    "plain; bed 0.7 mm too low": ("bed read one grain too low", "black"),
    "plain; exposed for 20 ms": ("exposure of 20 ms", SKY),
    "plain; beads that leave with 0.1 of the speed": (
        "beads that leave with 0.1 of the speed",
        BLUE,
    ),
}
CAPTION = """
Change of the area that a side view sees at 22 deg, grains of {grains} on a bed without slip: what each effect alone
does. Dots: the largest swelling of the experiments, 3 % (w = 10 cm) and 10 % (20 cm), after which the volume comes
back. Numbers drawn: runs/paper/volume/changes.csv.
"""


def draw(of):
    """One panel per width."""
    lines = {row["case"]: as_line(row) for row in read_table(of.folder / "volume" / "changes.csv")}
    figure, axes = panels(1, 2, (13.0, 4.6), sharex=True, sharey=True)
    for panel, (width, wanted) in zip(axes[0], WANTED.items(), strict=True):
        for kind, (_, colour) in KINDS.items():
            name = f"{GRAINS}; {width}; {kind}"
            if name not in lines:
                raise MissingRun(f"{name} is not in the table of the volume")
            panel.plot(*lines[name], color=colour, lw=1.5)
        panel.axhline(wanted, color="black", ls=":", lw=1.2)
        panel.set(xlim=(0.0, 2.5), xlabel="time (s)", title=width)
    axes[0, 0].set_ylabel("change of the volume seen (%)")
    styles = {words: {"color": colour} for words, colour in KINDS.values()}
    key(axes[0, 1], styles, loc="upper left", bbox_to_anchor=(1.02, 1.0))
    words = CAPTION.format(grains=GRAINS.partition(";")[0])
    write_picture(figure, "paper_volume_seen", words)


if __name__ == "__main__":
    main(draw)
