"""Section IX: what refining the grid does to shear rate, profile and interface.

python -m plots.paper_refinement
"""

from matplotlib.colors import LogNorm

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import YELLOW, main, panels, save
from plots.paper_viscosity_field import as_grid

GRIDS = {1.0: ORANGE, 1.5: YELLOW, 2.0: GREEN, 3.0: BLUE}  # refinement: colour
NORM = LogNorm(1.0, 100.0)
CAPTION = """
Section IX of the paper: 22 deg, w = 10 cm, t = 0.48 s, grids of different cell size. Left: shear rate with
µ(I); right: with its partial regularisation, which is well-posed. Below: thickness (solid) and static–flowing
interface (dashed), µ(I). "bands": maxima of the shear rate per column.
"""


def draw(of):
    """Fields above, profiles below."""
    figure, axes = panels(5, 2, (11.0, 9.0))
    for column, law in enumerate(("muI", "regularised")):
        for row, factor in enumerate(GRIDS):
            panel = axes[row, column]
            if (f"{law}_a22_w10", factor) not in of.scalars:
                panel.set_visible(False)
                continue
            image = field(panel, of, f"{law}_a22_w10", factor)
    figure.colorbar(image, ax=axes[:4], label="shear rate (1/s)")
    below(axes[4, 0], of, 0.48)
    below(axes[4, 1], of, 0.96)
    save(figure, "paper_section_9_refinement", of, CAPTION, ("lateral_friction", "refinement"))


def field(axes, of, case, factor):
    """Shear rate on one grid."""
    _, columns = of.columns(case, "shear_per_s", factor)
    x, z, rate = as_grid(columns)
    image = axes.pcolormesh(x, 1e3 * z, rate.T, norm=NORM, cmap="viridis", shading="nearest")
    bands = of.row(case, factor)["bands_0.48"]
    name = "µ(I)" if case.startswith("muI") else "regularised"
    size = of.cell_size(case, factor)
    axes.set_title(f"{name}, {size:.3g} mm cells, bands {bands:.2f}", fontsize="small")
    axes.set(xlim=(0.25, 0.55), ylim=(0.0, 80.0), ylabel="height (mm)")
    return image


def below(axes, of, time):
    """Profiles and interfaces of all grids at one time."""
    for factor, colour in GRIDS.items():
        for quantity, line in (("thickness_mm", "-"), ("static_mm", "--")):
            curve = of.line("muI_a22_w10", quantity, time, refinement=factor)
            label = f"{of.cell_size('muI_a22_w10', factor):.3g} mm" if line == "-" else None
            axes.plot(curve.at, curve.values, color=colour, ls=line, lw=1.1, label=label)
    axes.set(xlabel="distance from the back wall (m)", ylabel="height (mm)")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    axes.set_title(f"µ(I), t = {time:.2f} s", fontsize="small")
    axes.legend(frameon=False, fontsize="small")


if __name__ == "__main__":
    main(draw)
