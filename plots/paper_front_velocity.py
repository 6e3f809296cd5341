"""Figures 7–10 and 12–15: front velocity against time.

python -m plots.paper_front_velocity
"""

from fvcollapse.drawing import BLUE, GREEN, GREY, ORANGE
from plots.paper_style import (
    PURPLE,
    SLOPE_COLOUR,
    WIDTH_NAME,
    draw_line,
    key,
    main,
    panels,
    save,
)
from runs.paper.measures import PLATEAU_LEAST

END = 2.0  # s
ABOUT = """
Velocity of the front (5 mm thickness, farthest so far) by local parabolas over 80 ms; before 80 ms the front
is a vertical wall that is read to a cell.
"""


def draw(of):
    """All four figures."""
    walls(of)
    variable_or_constant(of)
    bounds(of)
    slow_phase(of)


def walls(of):
    """Figures 7 and 8: with and without lateral friction."""
    laws = {"without": ("muI_a{slope}_winf", "--"), "with": ("muI_a{slope}_{width}", "-")}
    figure = by_slope(of, laws, (10, 16, 22), ("w10", "w20"), "lateral friction")
    caption = (
        "Figures 7 and 8 of the paper: µ(I) with (solid) and without (dashed) lateral friction."
    )
    save(figure, "paper_07_08_front_walls", of, caption + ABOUT, ("lateral_friction",))


def variable_or_constant(of):
    """Figures 9 and 10: eta_I against a constant 0.4 Pa s."""
    laws = {"0.4 Pa s": ("eta0.4_a{slope}_{width}", "--"), "η_I": ("muI_a{slope}_{width}", "-")}
    figure = by_slope(of, laws, (0, 10, 16, 19, 22), ("winf", "w10"), "viscosity")
    caption = "Figures 9 and 10 of the paper: η_I (solid) against η_c = 0.4 Pa s (dashed)."
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_09_10_front_viscosity", of, caption + ABOUT, groups)


def bounds(of):
    """Figures 12 and 13: eta_I between the bounds of its range."""
    laws = {
        "1 Pa s": ("eta1_a{slope}_{width}", "--"),
        "0.1 Pa s": ("eta0.1_a{slope}_{width}", ":"),
        "η_I": ("muI_a{slope}_{width}", "-"),
    }
    figure = by_slope(of, laws, (10, 16, 22), ("w10", "w20"), "viscosity")
    caption = "Figures 12 and 13 of the paper: η_I (solid), η_c = 0.1 (dotted) and 1 Pa s (dashed)."
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_12_13_front_bounds", of, caption + ABOUT, groups)


def by_slope(of, laws, slopes, widths, name):
    """One panel per width: colours are slopes, line styles are laws {label: (case, line style)}."""
    figure, axes = panels(1, 2, (10.5, 4.2), sharey=True)
    for panel, width in zip(axes[0], widths, strict=True):
        for slope in slopes:
            for case, line in laws.values():
                style = {"color": SLOPE_COLOUR[slope], "ls": line, "lw": 1.3}
                draw_line(
                    panel,
                    of,
                    case.format(slope=slope, width=width),
                    "velocity_m_s",
                    end=END,
                    **style,
                )
        panel.set_title(WIDTH_NAME[width], fontsize="medium")
        panel.set(xlabel="time (s)", xlim=(0.0, END), ylim=(0.0, None))
    axes[0, 0].set_ylabel("front velocity (m/s)")
    colours = {f"{slope}°": {"color": SLOPE_COLOUR[slope]} for slope in slopes}
    lines = {label: {"color": "black", "ls": line} for label, (_, line) in laws.items()}
    key(axes[0, 1], colours, loc="upper right", title="slope")
    key(axes[0, 1], lines, loc="center right", title=name)
    return figure


def slow_phase(of):
    """Figures 14 and 15: what a higher viscosity does at 22 deg."""
    laws = {"0.1": GREY, "0.4": PURPLE, "1": GREEN, "2": ORANGE}
    figure, axes = panels(1, 2, (10.5, 4.2), sharey=True)
    found = 0
    for panel, width in zip(axes[0], ("w10", "w20"), strict=True):
        draw_line(panel, of, f"muI_a22_{width}", "velocity_m_s", end=END, color=BLUE, label="η_I")
        for eta, colour in laws.items():
            case = f"eta{eta}_a22_{width}"
            if (case, 1.0) not in of.scalars:
                continue  # 0.4 Pa s is not in the paper's figures at w = 20 cm
            style = {"color": colour, "lw": 1.3, "label": f"{eta} Pa s"}
            draw_line(panel, of, case, "velocity_m_s", end=END, **style)
            found += mark_plateau(panel, of.row(case), colour)
        panel.set_title(f"22°, {WIDTH_NAME[width]}", fontsize="medium")
        panel.set(xlabel="time (s)", xlim=(0.0, END), ylim=(0.0, None))
        panel.legend(frameon=False, fontsize="small")
    axes[0, 0].set_ylabel("front velocity (m/s)")
    caption = (
        "Figures 14 and 15 of the paper: 22 deg, η_I and constant viscosities. A slow propagation phase "
        f"would be marked by a thick line; the detector finds {found}."
    )
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_14_15_front_slow_phase", of, caption + ABOUT, groups)


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
