"""The slow phase of the front at 22 deg: what has one, what comes near, and what the paper computed.

python -m plots.paper_slow_phase
"""

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import key, main, panels, write_picture
from runs.table import MissingRun, as_line, read_table, to_float

FRONTS = {"1mm": ORANGE, "5mm": BLUE, "10mm": GREEN}
LINES = (":", "--", "-")  # from coarse to fine
LEAST_TIME = 0.15  # s; a shorter phase is none
TITLES = {
    "0.38, 0.64; no slip; mu(I); w = 10 cm": "µ1, µ2 = 0.38, 0.64; no slip; µ(I)",
    "0.42, 0.67; no slip; mu(I); w = 10 cm": "0.42, 0.67; no slip; µ(I)",
    "0.38, 0.64; no slip; 1 Pa s; w = 10 cm": "0.38, 0.64; no slip; 1 Pa s",
    "0.48, 0.73; slides; 1 Pa s; w = 10 cm": "0.48, 0.73 (Table I); grains slide; 1 Pa s",
}
CAPTION = """
Speed of the front at 22 deg (tan = 0.404), w = 10 cm, read where the mass is 1, 5 and 10 mm thick, over whole cells in
at least 80 ms. Above: µ(I) on a bed without slip. Below: a constant viscosity, with the friction of chutes on the same
bed and as in the paper. Thick: slow phases of at least 0.15 s on the finest grid. Cells of {cells} mm (dotted, dashed,
solid). Numbers drawn: runs/paper/slow_phase.
"""


def draw(of):
    """One panel per combination."""
    folder = of.folder / "slow_phase"
    curves, phases = read_table(folder / "speeds.csv"), read_table(folder / "phases.csv")
    found = {row["name"]: row for row in phases}
    figure, axes = panels(2, 2, (10.5, 7.0), sharex=True, sharey=True)
    cells = set()
    for panel, (name, title) in zip(axes.flat, TITLES.items(), strict=True):
        rows = [row for row in curves if row["case"] == name]
        if not rows:
            raise MissingRun(f"{name} is not in the tables of the slow phase")
        sizes = sorted({float(row["cell_size_mm"]) for row in rows}, reverse=True)
        cells |= set(sizes)
        for row in rows:
            line = as_line(row)
            fine = sizes.index(float(row["cell_size_mm"])) - len(sizes)
            style = {"color": FRONTS[row["quantity"].split("_")[1]], "ls": LINES[fine]}
            panel.plot(line.at, line.values, lw=1.3 if fine == -1 else 0.8, **style)
        mark_phases(panel, found[f"{name}; {sizes[-1]:g} mm"])
        panel.set_title(title, fontsize="medium")
        panel.set(xlim=(0.0, 2.4), ylim=(0.0, None))
    for row in axes:
        row[0].set_ylabel("front velocity (m/s)")
    for panel in axes[1]:
        panel.set_xlabel("time (s)")
    key(axes[0, 1], {mm.replace("mm", " mm"): {"color": c} for mm, c in FRONTS.items()})
    words = ", ".join(f"{size:g}" for size in sorted(cells, reverse=True))
    write_picture(figure, "paper_slow_phase", CAPTION.format(cells=words))


def mark_phases(axes, row):
    """A thick line along each slow phase that counts."""
    for mm, colour in FRONTS.items():
        start, duration, speed = (
            to_float(row[f"{what}_{mm}_{unit}"])
            for what, unit in (("start", "s"), ("phase", "s"), ("speed", "m_s"))
        )
        if duration >= LEAST_TIME:
            axes.plot([start, start + duration], [speed] * 2, color=colour, lw=6.0, alpha=0.4)


if __name__ == "__main__":
    main(draw)
