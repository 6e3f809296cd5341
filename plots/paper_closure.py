"""The older closure (21) against the sink (19): fronts, interface and velocity in columns.

python -m plots.paper_closure
"""

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import PURPLE, draw_line, main, panels, save

CLOSURES = {
    "w = ∞": ("muI_a{slope}_winf", ORANGE),
    "sink (19)": ("muI_a{slope}_w10", BLUE),
    "(21), h = 5 cm": ("older_a{slope}_w10", GREEN),
    "(21), h = 2.5 cm": ("older25mm_a{slope}_w10", PURPLE),
}
SLOPES = (0, 10, 16, 19, 22)
CAPTION = """
Lateral friction as a sink of momentum (19) and as an increase of µ1 and µ2 by µ_w h/w (21), w = 10 cm, beside
none. Above left: runout (5 mm) against slope. Above right: front at 22 deg. Below: static–flowing interface at
0.48 s, 22 deg, and velocity along the bed at 0.48 s, 22 deg, X = 0.25 m.
"""


def draw(of):
    """Four panels."""
    figure, axes = panels(2, 2, (10.5, 7.0))
    for label, (name, colour) in CLOSURES.items():
        cases = [name.format(slope=slope) for slope in SLOPES]
        points = [of.value(case, "runout_5mm_m") for case in cases]
        values, errors, _ = zip(*points, strict=True)
        style = {"color": colour, "label": label}
        axes[0, 0].errorbar(SLOPES, values, errors, capsize=3, marker="o", ms=4, lw=1.2, **style)
        steep = cases[-1]
        draw_line(axes[0, 1], of, steep, "front_m", end=2.0, lw=1.3, **style)
        draw_line(axes[1, 0], of, steep, "static_mm", 0.48, lw=1.3, **style)
        line = of.line(steep, "u_m_s", 0.48, 0.25)
        axes[1, 1].plot(line.values, 1e3 * line.at, marker="o", ms=3, lw=1.2, **style)
    axes[0, 0].set(xlabel="slope (°)", ylabel="runout (m)")
    axes[0, 1].set(xlabel="time (s)", ylabel="front (m)", xlim=(0.0, 2.0))
    axes[1, 0].set(xlabel="distance from the back wall (m)", ylabel="interface (mm)")
    axes[1, 0].set(xlim=(0.0, None), ylim=(0.0, None))
    axes[1, 1].set(xlabel="velocity along the bed (m/s)", ylabel="height (mm)")
    axes[0, 0].legend(frameon=False, fontsize="small")
    save(figure, "paper_closure_21", of, CAPTION, ("lateral_friction", "older_closure"))


if __name__ == "__main__":
    main(draw)
