"""What the runout at 22 deg without lateral friction depends on.

python -m plots.paper_sensitivity
"""

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import GREY, main, panels, save
from runs.table import LABELS, read_table

FRONTS = {"10mm": GREEN, "5mm": BLUE, "1mm": ORANGE}
PAPER = 1.6  # m
CAPTION = """
Runout at 22 deg without lateral friction, read at 10, 5 and 1 mm thickness: the reference and grids 1.5 and 2
times finer above, then one change each. Bars: the grid uncertainty of the reference. Grey: 1.6 m, what the
paper reports.
"""


def draw(of):
    """One row per change, the reference and the grids above."""
    reference = "muI_a22_winf"
    entries = [("reference", reference, 1.0)]
    entries += [
        (f"cells {of.cell_size(reference, r):.3g} mm", reference, r)
        for r in (1.5, 2.0)
        if (reference, r) in of.scalars
    ]
    changes = read_table(of.folder / "sensitivity" / LABELS)
    entries += [(row["label"], row["case"], 1.0) for row in changes]
    figure, axes = panels(1, 1, (8.5, 6.4))
    panel = axes[0, 0]
    panel.axvline(PAPER, color=GREY, lw=3.0, alpha=0.4)
    for front, colour in FRONTS.items():
        column = f"runout_{front}_m"
        error = of.value(reference, column).uncertainty
        values = [of.row(case, factor)[column] for _, case, factor in entries]
        rows = range(len(entries))
        panel.axvline(values[0], color=colour, lw=0.8, ls=":")
        style = {"color": colour, "fmt": "o", "ms": 4, "capsize": 2, "lw": 1.0}
        panel.errorbar(values, rows, xerr=error, label=front.replace("mm", " mm"), **style)
    panel.set_yticks(range(len(entries)), [label for label, _, _ in entries], fontsize="small")
    panel.set_ylim(len(entries) - 0.5, -0.5)
    panel.set_xlabel("runout from the back wall (m)")
    panel.legend(frameon=False, fontsize="small", title="thickness")
    save(figure, "paper_sensitivity", of, CAPTION, ("lateral_friction", "sensitivity"))


if __name__ == "__main__":
    main(draw)
