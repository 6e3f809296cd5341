"""Figure 11: shapes and field of eta_I when the front is fastest.

python -m plots.paper_viscosity_field
"""

import numpy as np
from matplotlib.colors import LogNorm

from fvcollapse.draw.drawing import ORANGE
from plots.paper_style import main, panels, save

SLOPES = (0, 10, 16, 22)
NORM = LogNorm(0.05, 2.0)
CAPTION = """
Figure 11 of the paper: field of η_I (equation 6) in the flowing part (faster than 0.01 m/s), w = 10 cm, at the
time of the largest front velocity, surface with η_I (black) and with η_c = 0.4 Pa s (orange, dashed) at its own
time. Static part white.
"""


def draw(of):
    """One panel per slope."""
    figure, axes = panels(2, 2, (10.5, 3.3))
    for panel, slope in zip(axes.flat, SLOPES, strict=True):
        time, columns = of.columns(f"muI_a{slope}_w10", "peak_eta_Pa_s")
        x, z, eta = as_grid(columns)
        image = panel.pcolormesh(x, z, eta.T, norm=NORM, cmap="viridis", shading="nearest")
        for case, style in (
            (f"muI_a{slope}_w10", {"color": "black"}),
            (f"eta0.4_a{slope}_w10", {"color": ORANGE, "ls": "--"}),
        ):
            line = of.line(case, "peak_thickness_mm")
            panel.plot(line.at, 1e-3 * line.values, lw=1.2, **style)
        mean = of.value(f"muI_a{slope}_w10", "eta_mean_Pa_s")
        panel.set_title(
            f"{slope}°, t = {time:.2f} s, mean {mean.value:.2f} ± {mean.uncertainty:.2f} Pa s",
            fontsize="medium",
        )
        panel.set(xlim=(0.0, 0.75), ylim=(0.0, 0.15), aspect="equal")
    for panel in axes[1]:
        panel.set_xlabel("distance from the back wall (m)")
    for panel in axes[:, 0]:
        panel.set_ylabel("height (m)")
    figure.colorbar(image, ax=axes, label="η_I (Pa s)", shrink=0.9)
    groups = ("lateral_friction", "viscosity")
    save(figure, "paper_11_viscosity_field", of, CAPTION, groups)


def as_grid(columns):
    """Abscissae, heights and values (nx, nz) of a field kept by columns {x: Line}."""
    x = np.array(sorted(columns))
    high = max(columns.values(), key=lambda line: len(line.at))
    values = np.full((len(x), len(high.at)), np.nan)
    for row, place in zip(values, x, strict=True):
        row[: len(columns[place].values)] = columns[place].values
    return x, high.at, values


if __name__ == "__main__":
    main(draw)
