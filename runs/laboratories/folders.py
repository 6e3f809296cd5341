"""Measured collapses whose cause is known, as experiment folders: the part `folders` of the study.

--data is the folder of the published data (lab/alfarizki2023_wet_beads, lab/bui2008_aluminium_bars,
particles/narrow_slot). Writes alfarizki2023/<diameter>_<water>, bui2008_bars and narrow_slot/<case> into --experiments.
"""

import math
from statistics import mean, stdev

import numpy as np

from fvcollapse.measure.curves import Scalar
from runs.experiments.convert import measured, write
from runs.table import read_table

# -- wet beads: Alfarizki & Viridi 2023 --------------------------------------------------------------
DIAMETERS, WATER = (6, 10), {0: "dry", 5: "wet5"}  # mm; per cent of the grains' mass
RULER = 0.001  # m; the table has whole millimetres
TANK = {"height_0": 0.14, "length_0": 0.10}  # m
HEIGHT_SD = 0.02  # m; the height is not stated and follows from the area of the deposits
REPOSE_SD = 0.05  # of the friction: the surface of a deposit is no test of the angle of repose

# -- aluminium bars: Bui et al. 2008 -----------------------------------------------------------------
AT_REST = 1.0  # s, ten times sqrt(height_0 / g): a stand-in, since only the deposit was measured
BARS_FRICTION = math.tan(math.radians(19.8))
BARS_THICKNESS, BARS_FRONT = (
    0.002,
    0.006,
)  # m, standard deviations of the digitised surface and its end

# -- slot of three grains: a public particle code ----------------------------------------------------
GRAIN, SLOT = 0.003, 0.009  # m
SLIDING = 0.16  # friction of two grains, and of a grain with floor and walls
SLOT_CASES = {  # case of the data: rolling friction and nominal aspect ratio
    "mur0_a2": "without rolling friction",
    "mur0_a4": "without rolling friction",
    "mur0.1_a2": "rolling friction 0.1",
    "mur0.1_a4": "rolling friction 0.1",
}
SLOT_END = 0.8  # s after the release
SLOT_FRICTION_SD = (
    0.05  # the friction is reported for "these beads", not for which rolling friction
)


def folders(options):
    """Convert everything."""
    wet_beads(options.data / "lab" / "alfarizki2023_wet_beads", options.experiments)
    bars(options.data / "lab" / "bui2008_aluminium_bars", options.experiments)
    narrow_slot(options.data / "particles" / "narrow_slot", options.experiments)


def wet_beads(data, out):
    """Dry and wetted beads in the same tank: run-out and final height, means of five repeats."""
    runs = read_table(data / "runs.csv")
    angles = readings(runs, None, 0, "top_angle_deg")
    for diameter in DIAMETERS:
        for water, word in WATER.items():
            settings = {
                "title": f"Alfarizki & Viridi 2023, beads of {diameter} mm, {water} % water",
                "source": (
                    "run-out and final height from the authors' table (bachelor thesis, ITB Bandung, in "
                    "nawafalfa/final-year-project), means of five repeats; standard deviations are those of the mean, "
                    "and a millimetre of reading. height_0 is not stated: 14 +- 2 cm follow from the area of the "
                    "deposits, the same for all runs of the tank. mu_1 is the tangent of the top angle of the dry "
                    "deposits (ten runs). Width, gate (lifted by hand), bed friction and density are not stated. The "
                    "time of the collapse is left out: neither its start nor its end is defined"
                ),
                "geometry.slope_angle_deg": 0.0,
                **{f"geometry.{name}": value for name, value in TANK.items()},
                "material.grain_diameter": 0.001 * diameter,
                "material.mu_1": math.tan(math.radians(mean(angles))),
                "uncertainty.height_0": HEIGHT_SD,
                "uncertainty.mu_1": REPOSE_SD,
                **{f"common.{name}": True for name in ("slope_angle_deg", *TANK, "time")},
            }
            fronts = readings(runs, diameter, water, "front_from_back_wall_m")
            heights = readings(runs, diameter, water, "final_height_m")
            values = measured(runout=of_repeats(fronts), final_height=of_repeats(heights))
            write(out / "alfarizki2023" / f"d{diameter:02}mm_{word}", settings, values)


def readings(runs, diameter, water, quantity):
    """Values of a quantity over the repeats; `diameter` None: of all that are converted."""
    sizes = DIAMETERS if diameter is None else (diameter,)
    return [
        float(row["value"])
        for row in runs
        if row["quantity"] == quantity
        and int(row["water_percent_of_grain_mass"]) == water
        and int(row["grain_diameter_mm"]) in sizes
    ]


def of_repeats(values):
    """Mean of repeats and its standard deviation, that of the reading included."""
    return mean(values), math.hypot(stdev(values) / math.sqrt(len(values)), RULER)


def bars(data, out):
    """A stack of aluminium bars, released at once: the surface of the deposit."""
    surface = np.array(
        [(float(row["x_m"]), float(row["h_m"])) for row in read_table(data / "deposit_surface.csv")]
    )
    settings = {
        "title": "Bui et al. 2008, aluminium bars, two-dimensional, deposit",
        "source": (
            "surface of the deposit of Bui, Fukagawa, Sako & Ohno (2008, Int. J. Numer. Anal. Meth. Geomech. 32, "
            "1537) as digitised in LandslideSIM/MaterialPointSolver.jl after Wyser et al. (2020, Geosci. Model Dev. "
            f"13, 6265). It is at rest; {AT_REST:g} s is a stand-in. No lateral walls; one wall is removed at once. "
            "mu_1 = tan 19.8 deg was measured; diameter (1.0 and 1.5 mm bars) from memory of the paper. The friction "
            "of the flat bed is not stated. The run-out is the end of the surface, 1.5 mm thick"
        ),
        "geometry.slope_angle_deg": 0.0,
        "geometry.height_0": 0.10,
        "geometry.length_0": 0.20,
        "material.grain_diameter": 0.00125,
        "material.density_grain": 2650.0,
        "material.mu_1": BARS_FRICTION,
        "material.repose_angle_deg": 19.8,
        "front.thickness": 0.0015,
        "uncertainty.thickness": BARS_THICKNESS,
    }
    values = [Scalar("runout", round(surface[-1, 0], 3), BARS_FRONT, "value")]
    write(out / "bui2008_bars", settings, values, {"profiles": at_time(AT_REST, surface)})


def narrow_slot(data, out):
    """Beads between lateral walls three grains apart, computed grain by grain with two rolling frictions."""
    columns = {row["case"]: row for row in read_table(data / "summary.csv")}
    bins = read_table(data / "deposit_profiles.csv")
    for name, words in SLOT_CASES.items():
        front = float(columns[name]["front_h_half_d_m"])
        rows = [
            (float(row["x_m"]), float(row["h_solid_over_0.6_m"]))
            for row in bins
            if row["case"] == name
        ]
        surface = pairwise(np.array([row for row in rows if row[0] < front]))
        write(
            out / "narrow_slot" / name,
            slot_settings(columns[name], words),
            measured(runout=(front, GRAIN)),
            {"profiles": at_time(SLOT_END, surface)},
        )


def slot_settings(column, words):
    """Set-up of a column of the narrow slot, a row of the published summary."""
    return {
        "title": f"beads of 3 mm in a slot of 9 mm, {words}, aspect ratio {column['nominal_aspect']}",
        "source": (
            "deposit 0.8 s after the release, computed with LAMMPS (three-dimensional, grain by grain), "
            "SueHeir/dirt, SPH_glass_sphere_calibration/07_column_collapse: volume of the grains over 0.6, means "
            "of two bins of one grain each, up to the front (half a grain thick); beyond it single grains lie. "
            "Sliding friction 0.16 of grains, flat floor and walls; mu_1 and mu_2 as reported for these beads, "
            "for which rolling friction is not said. Standard deviations: half a grain of thickness, a grain "
            "of the front. The height is that of the settled grains at a solid fraction of 0.6"
        ),
        "geometry.slope_angle_deg": 0.0,
        "geometry.height_0": float(column["H0_at_phi_0.6_m"]),
        "geometry.length_0": 0.024,
        "geometry.channel_width": SLOT,
        "material.grain_diameter": GRAIN,
        "material.density_grain": 2500.0,
        "material.solid_fraction": 0.6,
        "material.mu_1": 0.38,
        "material.mu_2": 0.48,
        "material.mu_bed": SLIDING,
        "material.mu_back_wall": SLIDING,
        "material.mu_wall": SLIDING,
        "front.thickness": 0.5 * GRAIN,
        "uncertainty.thickness": 0.5 * GRAIN,
        "uncertainty.mu_1": SLOT_FRICTION_SD,
        "uncertainty.mu_2": SLOT_FRICTION_SD,
    }


def pairwise(points):
    """Means of two neighbours each, of points (n, 2); an odd last one is left out."""
    whole = points[: len(points) // 2 * 2]
    return 0.5 * (whole[0::2] + whole[1::2])


def at_time(time, surface):
    """Rows of profiles.csv of a surface (n, 2) at one time."""
    return np.column_stack([np.full(len(surface), time), surface])
