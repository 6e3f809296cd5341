"""The steady front of a layer of beads on a rough plane at 21 deg (Pouliquen 1999), in units of the layer behind it.

The layer is released at once and flows as a whole. Its front is compared when it has gone far enough to be steady.
Constants are those with which others computed the experiment: mu_1, mu_2 = 0.35, 0.56, I_0 = 0.4, beads of 0.5 mm. The
length of thin layers follows from them, 5 beta d/(2 I_0 sqrt(solid fraction cos(slope))), beta = 0.136. Where velocity
is uniform along the front and inertia is small, its shape also follows from dh/dx = tan(slope) - mu of the mean
velocity, which is the third column.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

from fvcollapse.case.case import Case
from runs.comparison.tables import table
from runs.study import run_cached
from runs.table import write_table

SLOPE, LAYER, BEAD = 21.0, 0.0116, 0.0005  # deg, m, m
MU_1, MU_2, I_0, FRACTION, BETA = 0.35, 0.56, 0.4, 0.6, 0.136
COSINE = math.cos(math.radians(SLOPE))
LENGTH = 5.0 * BETA / (2.0 * I_0 * math.sqrt(FRACTION * COSINE))  # diameters, of thin_layer
FRONT = 2.0 * BEAD  # thickness at the front, m
TIMES = (1.5, 2.25, 3.0)  # s
AT = (2.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0)  # layers behind the front
SET_UP = {
    "geometry.slope_angle_deg": SLOPE,
    "geometry.height_0": LAYER,
    "geometry.length_0": 1.0,
    "geometry.channel_width": math.inf,
    "gate.speed": math.inf,
    "boundary.mu_bed": math.inf,
    "boundary.mu_back_wall": 0.0,
    "rheology.mu_1": MU_1,
    "rheology.mu_2": MU_2,
    "rheology.I_0": I_0,
    "rheology.grain_diameter": BEAD,
    "rheology.density_bulk": 2500.0 * FRACTION,
    "numerics.film_thickness": BEAD,
    "front.thickness": FRONT,
    "time.end": TIMES[-1],
    "time.output_interval": 0.1,
    "time.field_interval": TIMES[-1],
}
EFFECTS = {"without": None, "thin_layer": {"length": LENGTH}}
CELLS = (8,)  # over the layer


def steady_front(options):
    """Write steady_front.csv: thickness at some places behind the front, of beads, of the model and of the theory."""
    data = options.data / "lab" / "pouliquen1999_front_digitised" / "front_theta21.csv"
    rows = [row_of(name, "", *of) for name, of in measured(data).items()]
    rows.append(row_of("dh/dx = tan(slope) - mu", "", *theory()))
    cases = {
        (effect, cells): Case().replace(
            **SET_UP, **{"grid.cell_size": LAYER / cells, "effects.thin_layer": of}
        )
        for effect, of in EFFECTS.items()
        for cells in CELLS
    }
    results = run_cached(cases, options)
    for (effect, cells), result in results.items():
        for time in TIMES:
            name = f"model, {effect}, {cells} cells"
            rows.append(row_of(name, time, *profile_behind(result.profiles, time)))
    write_table(options.tables / "steady_front.csv", rows)
    for row in rows:
        print("  ".join(str(value) for value in row.values()))


def measured(path):
    """{series: (distance behind the front, thickness)} of the beads, both in layers."""
    columns = table(path)
    series = np.asarray(columns["series"])
    return {
        f"beads, {name}": (
            -columns["x_over_hinf"][series == name],
            columns["h_over_hinf"][series == name],
        )
        for name in dict.fromkeys(series)
    }


def theory():
    """Distance behind the front and thickness of the front of uniform velocity, in layers."""
    steady = I_0 * (math.tan(math.radians(SLOPE)) - MU_1) / (MU_2 - math.tan(math.radians(SLOPE)))

    def slope(_, h):
        number = steady / h**1.5  # I of a layer of thickness h with the velocity of the whole one
        return math.tan(math.radians(SLOPE)) - (MU_1 + (MU_2 - MU_1) / (1.0 + I_0 / number))

    reach = AT[-1] + 5.0
    found = solve_ivp(
        lambda x, h: -slope(x, h), (0.0, reach), [1e-3], dense_output=True, max_step=0.1
    )
    x = np.linspace(0.0, reach, 500)
    return x, found.sol(x)[0]


def profile_behind(profiles, time):
    """Distance behind the front and thickness of a run, in layers."""
    now = int(np.argmin(np.abs(profiles.time - time)))
    h, x = profiles.thickness[now], profiles.x
    front = x[np.flatnonzero(h >= FRONT)[-1]]
    behind = x <= front
    return (front - x[behind])[::-1] / LAYER, h[behind][::-1] / LAYER


def row_of(name, time, distance, thickness):
    """One row; no value beyond the ends of a profile."""
    order = np.argsort(distance)
    found = np.interp(AT, distance[order], thickness[order], left=np.nan, right=np.nan)
    return {"profile": name, "time": time} | {
        f"h_at_{at:g}": "" if math.isnan(h) else round(float(h), 3)
        for at, h in zip(AT, found, strict=True)
    }
