"""Figure 18: pressure against depth, computed, hydrostatic and by equation 22.

python -m plots.paper_pressure
"""

from fvcollapse.draw.drawing import BLUE, GREY, ORANGE
from plots.paper_style import WIDTH_NAME, main, panels, percent, save

STATIONS = (0.1, 0.25, 0.4, 0.6)  # m
MODELS = {
    "computed": {"color": "black", "marker": "o", "ms": 4, "ls": "none"},
    "hydrostatic": {"color": ORANGE, "ls": "--"},
    "equation_22": {"color": BLUE},
}
SPEED_STATIC = 0.01  # m/s
CAPTION = """
Figure 18 of the paper: pressure against depth at 22 deg, t = 1.5 s, in four columns of cells: computed
(points), hydrostatic (dashed) and equation 22 (line). Grey: slower than 0.01 m/s, where the last term of (22)
is left out. In the titles the rms misfit over the flowing part, layers thicker than 1 cm, relative to the rms
pressure, of the hydrostatic pressure and of (22).
"""


def draw(of):
    """One row per law and width."""
    rows = [(law, width) for width in ("w10", "winf") for law in ("muI", "eta0.4")]
    figure, axes = panels(4, 4, (11.0, 10.0))
    for line, (law, width) in zip(axes, rows, strict=True):
        case = f"{law}_a22_{width}"
        for panel, x in zip(line, STATIONS, strict=True):
            column(panel, of, case, x)
        near, better = (of.value(case, f"misfit_{name}_1.5") for name in ("hydrostatic", "22"))
        name = "η_I" if law == "muI" else "0.4 Pa s"
        misfits = f"{percent(near)} and {percent(better)}"
        line[0].set_title(f"{name}, {WIDTH_NAME[width]}: {misfits}", fontsize="medium", loc="left")
        line[0].set_ylabel("depth (mm)")
    for panel in axes[-1]:
        panel.set_xlabel("pressure (Pa)")
    axes[0, 3].legend(frameon=False, fontsize="small", loc="lower left")
    save(figure, "paper_18_pressure", of, CAPTION, ("lateral_friction", "viscosity"))


def column(axes, of, case, x):
    """One column of cells, the surface on top."""
    lines = {
        name: of.line(case, f"pressure_{name}_{unit}", 1.5, x).values
        for name, unit in (("depth", "m"), ("speed", "m_s"), *((name, "Pa") for name in MODELS))
    }
    depth = 1e3 * lines["depth"]
    for name, style in MODELS.items():
        axes.plot(lines[name], depth, label=name.replace("_", " "), **style)
    still = lines["speed"] <= SPEED_STATIC
    if still.any():
        axes.axhspan(depth[still].min(), depth.max(), color=GREY, alpha=0.15, lw=0)
    axes.set(xlim=(0.0, None), ylim=(depth.max() + 1.0, 0.0))
    axes.text(0.95, 0.9, f"X = {x:g} m", transform=axes.transAxes, ha="right", va="top")


if __name__ == "__main__":
    main(draw)
