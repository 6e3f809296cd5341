"""Aluminium bars: a collapse in two dimensions, without walls, whose friction was measured (Bui et al. 2008).

The bars, 1.0 and 1.5 mm thick, stand 0.10 m high and 0.20 m long; one wall is taken away at once. mu_1 = tan 19.8 deg
is measured, mu_2 and I_0 are not: those of discs in simulations and those of glass beads stand for them. The bed of
the experiment is not described; here it holds the bars.
"""

import math

import numpy as np

from fvcollapse.case.case import Case
from fvcollapse.measure.pile import front_position
from runs.comparison.tables import table
from runs.study import run_cached
from runs.table import write_table

AT = np.arange(0.05, 0.401, 0.05)  # m from the back wall
FRONT = 0.0015  # thickness at the front, m
SET_UP = {
    "geometry.slope_angle_deg": 0.0,
    "geometry.height_0": 0.10,
    "geometry.length_0": 0.20,
    "geometry.channel_width": math.inf,
    "gate.speed": math.inf,
    "boundary.mu_bed": math.inf,
    "boundary.mu_back_wall": 0.0,
    "grid.cell_size": 0.004,
    "rheology.mu_1": math.tan(math.radians(19.8)),
    "rheology.grain_diameter": 0.00125,
    "rheology.density_grain": 2650.0,
    "rheology.density_bulk": 2150.0,
    "front.thickness": FRONT,
    "time.end": 1.2,
    "time.output_interval": 0.02,
}
LAWS = {
    "mu(I) of discs: 0.60, 0.40": {"rheology.mu_2": 0.60, "rheology.I_0": 0.40},
    "mu(I) of beads: 0.62, 0.279": {"rheology.mu_2": 0.62, "rheology.I_0": 0.279},
    "mu(I) as the default: 0.73, 0.279": {"rheology.mu_2": 0.73, "rheology.I_0": 0.279},
    "Drucker-Prager, 0.02 Pa s": {
        "rheology.law": "drucker_prager",
        "rheology.mu_2": 0.60,
        "rheology.viscosity": 0.02,
    },
}
EFFECTS = {
    "without": None,
    "thickness": {"length": 1.65},
    "nonlocal": {"length": 1.65, "closure": "nonlocal"},
}


def bars(options):
    """Write bars.csv and bars_profiles.csv: deposit, front and failure line, computed less measured; both curves."""
    folder = options.data / "lab" / "bui2008_aluminium_bars"
    surface, failure = table(folder / "deposit_surface.csv"), table(folder / "failure_line.csv")
    cases = {
        (law, effect): Case().replace(**SET_UP, **keys, **{"effects.thin_layer": EFFECTS[effect]})
        for law, keys in LAWS.items()
        for effect in EFFECTS
    }
    results = run_cached(cases, options)
    measured = np.interp(AT, surface["x_m"], surface["h_m"])
    rows = [row_of("measured", "", measured, surface["x_m"][-1], "", "")]
    curves = curve_rows("measured", "", "deposit", surface["x_m"], surface["h_m"])
    curves += curve_rows("measured", "", "failure line", failure["x_m"], failure["h_m"])
    for (law, effect), result in results.items():
        x, h = result.profiles.x, result.profiles.thickness[-1]
        still = never_moved(result.profiles)
        wet = h > 0.0
        curves += curve_rows(law, effect, "deposit", x[wet], h[wet])
        curves += curve_rows(law, effect, "failure line", x[wet], still[wet])
        gap = np.interp(surface["x_m"], x, h) - surface["h_m"]
        deep = np.interp(failure["x_m"], x, still) - failure["h_m"]
        front = front_position(x, h, FRONT)
        rows.append(row_of(law, effect, np.interp(AT, x, h), front, rms(gap), rms(deep)))
    write_table(options.tables / "bars.csv", rows)
    write_table(options.tables / "bars_profiles.csv", curves)
    for row in rows:
        print("  ".join(str(value) for value in row.values()))


def row_of(law, effect, thickness, front, gap, deep):
    """One row, lengths in mm."""
    heights = {
        f"h_at_{x:.2f}_m": round(1e3 * float(h), 1) for x, h in zip(AT, thickness, strict=True)
    }
    return {
        "law": law,
        "thin_layer": effect,
        **heights,
        "front": round(1e3 * float(front), 1),
        "rms_deposit": gap and round(1e3 * gap, 2),
        "rms_failure_line": deep and round(1e3 * deep, 1),
    }


def curve_rows(law, effect, curve, x, height):
    """Rows of a curve, lengths in m."""
    first = {"law": law, "thin_layer": effect, "curve": curve}
    return [
        first | {"x": round(float(at), 4), "height": round(float(z), 5)}
        for at, z in zip(x, height, strict=True)
    ]


def never_moved(profiles):
    """Height (n,) below which the grains stayed slower than 0.01 m/s, m: the lowest static-flowing interface."""
    return profiles.static_height.min(axis=0)


def rms(gap):
    """Root mean square."""
    return float(np.sqrt(np.mean(gap**2)))
