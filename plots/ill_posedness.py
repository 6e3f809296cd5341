"""What refinement does to shear bands, thickness, velocity and static-flowing interface (the paper's section IX).

    python -m plots.ill_posedness RESULT RESULT RESULT …

takes results of one collapse on several grids, with the mu(I) law and, if wanted, with the partially
regularised one; runs/convergence/README.md has the commands. Writes plots/figures/ill_posedness.png, the numbers
(.csv) and the caption (.txt).
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import fvcollapse
from runs.table import write_table

FIGURE = Path(__file__).parent / "figures" / "ill_posedness"
TIME = 0.5  # s
NAMES = {"mu_I": "µ(I)", "mu_I_regularised": "regularised µ(I)"}
CAPTION = """Shear rate at t = 0.5 s, {case}, on grids of different cell size; white lines enclose what the
criterion of Barker et al. (2015) calls ill-posed. Differences between the grids: ill_posedness.csv.
"""


def frame(result):
    """Index of the field nearest to TIME, and of the profile."""
    field = int(np.argmin(np.abs(result.field_times - TIME)))
    profile = int(np.argmin(np.abs(result.profiles.time - TIME)))
    return field, profile


def ill_posed_cells(result, field):
    """Mask (nx, nz) of the cells where the law is ill-posed, from the stored fields."""
    from fvcollapse.step.ill_posedness import is_ill_posed
    from fvcollapse.step.quantities import local_slopes
    from fvcollapse.step.rheology import material

    law = material(result.case)
    rate, pressure = field["shear_rate"], field["pressure"]
    mask = np.zeros(rate.shape, bool)
    for cell in np.argwhere((rate > 0.0) & (pressure > 0.0)):
        i, k = cell
        mask[i, k] = is_ill_posed(*local_slopes(rate[i, k], pressure[i, k], law))
    return mask


def row(result, finest):
    """Numbers of one result, beside the finest of the same law."""
    _, profile = frame(result)
    _, best = frame(finest)
    time, fraction = result.series["time"], result.series["ill_posed_fraction"]
    flowing = (time > 0.1) & (time < 1.0)
    x, reference = finest.profiles.x, finest.profiles.thickness[best]

    def difference(values, of):
        here = np.interp(x, result.profiles.x, values, right=0.0)
        return np.trapezoid(np.abs(here - of), x) / np.trapezoid(reference, x)

    static = finest.profiles.static_height[best]
    return {
        "law": result.case.rheology.law,
        "cell_size_m": result.case.grid.cell_size,
        "ill_posed_fraction": round(float(fraction[flowing].mean()), 4),
        "largest_shear_rate_per_s": round(float(largest_rate(result)), 1),
        "max_speed_m_per_s": round(float(np.interp(TIME, time, result.series["max_speed"])), 4),
        "thickness_l1": round(float(difference(result.profiles.thickness[profile], reference)), 5),
        "interface_l1": round(float(difference(result.profiles.static_height[profile], static)), 5),
    }


def largest_rate(result):
    """99.9th percentile of the shear rate of the cells with grains, 1/s."""
    rate = result.field(frame(result)[0])["shear_rate"]
    return np.quantile(rate[rate > 0.0], 0.999)


def draw(results):
    """One panel per result."""
    laws = sorted({result.case.rheology.law for result in results})
    sizes = sorted({result.case.grid.cell_size for result in results}, reverse=True)
    figure, panels = plt.subplots(
        len(sizes), len(laws), figsize=(5.2 * len(laws), 1.5 * len(sizes)), squeeze=False,
        sharex=True, sharey=True, layout="constrained",
    )  # fmt: skip
    for result in results:
        axes = panels[sizes.index(result.case.grid.cell_size), laws.index(result.case.rheology.law)]
        image = draw_rate(axes, result)
    for axes in panels.flat:
        axes.set_visible(axes.has_data())
    figure.colorbar(image, ax=panels, label="shear rate (1/s)")
    figure.supxlabel("distance from the back wall (m)")
    figure.supylabel("height above the bed (m)")
    figure.savefig(FIGURE.with_suffix(".png"), dpi=130)


def draw_rate(axes, result):
    """Shear rate of one result, the ill-posed region outlined."""
    field = result.field(frame(result)[0])
    rate = np.where(field["shear_rate"] > 0.0, field["shear_rate"], np.nan)
    nx, nz = rate.shape
    dx = field["dx"]
    dz = field["dz"]
    image = axes.pcolormesh(
        dx * np.arange(nx + 1),
        dz * np.arange(nz + 1),
        rate.T,
        norm=LogNorm(0.1, 300.0),
        cmap="viridis",
    )
    mask = ill_posed_cells(result, field)
    axes.contour(
        dx * (np.arange(nx) + 0.5),
        dz * (np.arange(nz) + 0.5),
        mask.T,
        [0.5],
        colors="w",
        linewidths=0.5,
    )
    axes.set_title(
        f"{NAMES[result.case.rheology.law]}, {1e3 * result.case.grid.cell_size:g} mm", fontsize=9
    )
    axes.set_xlim(0.0, 0.8)
    axes.set_ylim(0.0, 0.1)
    return image


if __name__ == "__main__":
    opened = [fvcollapse.open_result(path) for path in sys.argv[1:]]
    finest = {}
    for result in sorted(opened, key=lambda result: -result.case.grid.cell_size):
        finest[result.case.rheology.law] = result
    rows = [row(result, finest[result.case.rheology.law]) for result in opened]
    draw(opened)
    write_table(FIGURE.with_suffix(".csv"), rows)
    g = opened[0].case.geometry
    FIGURE.with_suffix(".txt").write_text(
        CAPTION.format(case=f"{g.slope_angle_deg:g} deg, w = {100 * g.channel_width:g} cm")
    )
