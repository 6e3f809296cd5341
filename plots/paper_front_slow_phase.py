"""Figures 14 and 15: what a higher viscosity does to the front velocity at 22 deg.

python -m plots.paper_front_slow_phase
"""

from fvcollapse.draw.drawing import BLUE, GREEN, GREY, ORANGE
from plots.paper_style import (
    ABOUT_VELOCITY,
    END,
    PURPLE,
    WIDTH_NAME,
    draw_line,
    finish_velocity,
    main,
    panels,
    save,
)
from runs.table import VELOCITY

PLATEAU_LEAST = 0.15  # s; as in the statements: a shorter slow phase is none
LAWS = {  # law: colour; 0.4 Pa s was not run at w = 20 cm
    "w10": {"muI": BLUE, "eta0.1": GREY, "eta0.4": PURPLE, "eta1": GREEN, "eta2": ORANGE},
    "w20": {"muI": BLUE, "eta0.1": GREY, "eta1": GREEN, "eta2": ORANGE},
}
CAPTION = """
Figures 14 and 15 of the paper: 22 deg, η_I and constant viscosities. A slow propagation phase of at least
{least} s would be marked by a thick line; the detector finds {found}.
"""


def draw(of):
    """One panel per width."""
    figure, axes = panels(1, 2, (10.5, 4.2), sharey=True)
    found = 0
    for panel, (width, laws) in zip(axes[0], LAWS.items(), strict=True):
        for law, colour in laws.items():
            case = f"{law}_a22_{width}"
            label = "η_I" if law == "muI" else f"{law.removeprefix('eta')} Pa s"
            style = (
                {"lw": 2.2} if law == "muI" else {"lw": 1.2, "ls": "--" if "0.4" in law else "-"}
            )
            draw_line(panel, of, case, VELOCITY, end=END, color=colour, label=label, **style)
            found += mark_plateau(panel, of.row(case), colour)
        finish_velocity(panel, f"22°, {WIDTH_NAME[width]}")
        panel.legend(frameon=False, fontsize="small")
    axes[0, 0].set_ylabel("front velocity (m/s)")
    caption = CAPTION.format(least=PLATEAU_LEAST, found=found or "none")
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_14_15_front_slow_phase", of, caption + ABOUT_VELOCITY, groups)


def mark_plateau(axes, row, colour):
    """A thick line along the slow phase; 1 if there is one that counts."""
    start, duration, velocity = (
        row[f"plateau_{name}"] for name in ("start_s", "duration_s", "velocity_m_s")
    )
    if duration < PLATEAU_LEAST:
        return 0
    axes.plot([start, start + duration], [velocity] * 2, color=colour, lw=6.0, alpha=0.4)
    return 1


if __name__ == "__main__":
    main(draw)
