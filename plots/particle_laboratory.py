"""The controls of the particle laboratory beside the baseline, from runs/particle_laboratory/curves.csv.

    python -m plots.particle_laboratory

Writes plots/figures/particle_laboratory_<what>.png and captions (.txt); nothing is computed here.
"""

from pathlib import Path

import numpy as np

from fvcollapse.draw.drawing import BLUE, GREY, new_figure, png
from fvcollapse.files.atomic import write_atomic
from runs.table import RUNS, read_table

HERE = Path(__file__).parent
SOURCE = RUNS / "particle_laboratory"
TITLES = {"control_10deg": "10\N{DEGREE SIGN}", "control_16deg": "16\N{DEGREE SIGN}"}
CAPTION = """\
Collapses of 7 mm beads computed grain by grain (grey) and the continuum baseline (blue), {what}.
mu(I) from steady shear and chute flow (0.448, 0.797, I_0 = 0.5), no slip on the bed, back wall 0.5, gate 2.3 m/s;
nothing is tuned. Cells of {cells:g} mm. Front at rest: {front}; final thickness: {thickness} rms.
"""


def profiles(curves, axes, name):
    """Profiles at several times."""
    own = [row for row in curves if row["experiment"] == name and row["observable"] == "profiles"]
    times = sorted({float(row["time"]) for row in own})
    for panel, time in zip(axes, times, strict=True):
        rows = [row for row in own if float(row["time"]) == time]
        x, measured, simulated = columns(rows, "x", "measured", "simulated")
        panel.plot(x, 100.0 * measured, color=GREY, lw=2.5, label="grains")
        panel.plot(x, 100.0 * simulated, color=BLUE, lw=1.2, label="continuum")
        panel.text(0.97, 0.93, f"{time:.2f} s", transform=panel.transAxes, ha="right", va="top")


def fronts(curves, axes, name):
    """Front position over time."""
    own = [row for row in curves if row["experiment"] == name and row["observable"] == "front"]
    time, measured, simulated = columns(own, "time", "measured", "simulated")
    axes.plot(time, measured, color=GREY, lw=2.5, label="grains")
    axes.plot(time, simulated, color=BLUE, lw=1.2, label="continuum")
    axes.set(title=TITLES[name], xlabel="t (s)")


def columns(rows, *names):
    """Columns as arrays."""
    return [np.array([float(row[name]) for row in rows]) for name in names]


def save(figure, name, what):
    """Write the figure and its caption."""
    table = read_table(SOURCE / "validation.csv")
    finest = min(float(row["cell_size"]) for row in table)
    rows = [row for row in table if float(row["cell_size"]) == finest]
    front = ", ".join(
        f"{100 * float(row['front_difference']):+.1f} cm at {TITLES[row['experiment']]}"
        for row in rows
    )
    thickness = " and ".join(f"{1000 * float(row['final_thickness_rms']):.1f} mm" for row in rows)
    caption = CAPTION.format(what=what, cells=1000.0 * finest, front=front, thickness=thickness)
    path = HERE / "figures" / f"particle_laboratory_{name}.png"
    write_atomic(path, png(figure))
    write_atomic(path.with_suffix(".txt"), caption.encode())
    print(path)


def main():
    """Draw both figures."""
    curves = read_table(SOURCE / "curves.csv")
    names = list(TITLES)
    figure = new_figure(9.0, 7.0)
    panels = figure.subplots(6, 2, sharey=True, sharex="col")
    for column, name in zip(panels.T, names, strict=True):
        profiles(curves, column, name)
        column[0].set_title(TITLES[name])
        column[-1].set_xlabel("x (m)")
    for panel in panels[:, 0]:
        panel.set_ylabel("h (cm)")
    panels[0, 0].legend(frameon=False, loc="center right")
    save(figure, "profiles", "thickness at six times")
    figure = new_figure(9.0, 3.2)
    pair = figure.subplots(1, 2)
    for axes, name in zip(pair, names, strict=True):
        fronts(curves, axes, name)
    pair[0].set_ylabel("front at 10.5 mm (m)")
    pair[0].legend(frameon=False)
    save(figure, "fronts", "position of the front")


if __name__ == "__main__":
    main()
