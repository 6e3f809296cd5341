"""Published measurements as experiment folders: the part `convert` of the study.

--data is the folder of the published data (lab/mangeney2010, lab/lajeunesse2005_digitised). Writes
mangeney2010_0deg, lajeunesse2005/a<aspect ratio>, and, from what one paper says of its slopes in words,
martin2017/<slope>_<width> into --tables.
"""

import math
import re

from fvcollapse.case.grammar import toml_value
from fvcollapse.files.atomic import write_atomic
from fvcollapse.measure.curves import Scalar, curve_text, scalars_text
from fvcollapse.measure.digitised import settings_text
from fvcollapse.measure.experiment import SETTINGS, load_experiment
from runs.table import read_table

READ_OFF = 0.005  # m; stated uncertainty of what was read off the paper
PIXELS = 0.015  # relative reading error of a digitised point
# relative scatter about power laws of the aspect ratio a, in the points themselves
SCATTER_RUNOUT = 0.059  # about 1.83 a, 0.35 < a < 3
SCATTER_RUNOUT_TALL = 0.145  # about 2.68 a^(2/3), a > 3
SCATTER_HEIGHT = 0.052  # about 0.91 a^(1/3), a > 0.9; lower columns keep their height
SAME_ASPECT = 0.03  # relative; a runout and a height this close are taken for one experiment
CHANNEL_AREA = 0.0064  # m2 of column; the figures give ratios only, so the size is an assumption
CHANNEL_WIDTH = 0.045  # m
BEAD = 0.00115  # m
# Martin et al. 2017 of slope [deg] and width [m]: runout at most [m], whole mass stopped at most at [s]
MARTIN = {
    (10, 0.10): (0.70, 1.00),
    (10, 0.20): (0.70, 1.02),
    (22, 0.10): (1.60, 1.76),
    (22, 0.20): (1.60, 1.80),
}
SALTATION = 0.02  # m; error of the runout stated there
# s; a film shows no motion long before nothing is faster than 1 mm/s: in the reference collapse of this
# solver (runs/collapse_22deg_w10cm.toml) the front is in place at 1.76 s, and that speed reached at 2.40 s
LAST_GRAINS = 0.6
REASON = re.compile(r"(?<=standard deviation of )(\w+) \(.*\)$")


def convert(options):
    """Convert everything."""
    lab = options.data / "lab"
    mangeney(lab / "mangeney2010", options.tables)
    lajeunesse(lab / "lajeunesse2005_digitised", options.tables)
    martin(options.tables)


def mangeney(data, out):
    """The collapse on the horizontal: runout and final height."""
    given = {row["quantity"]: row["value"] for row in read_table(data / "theta0_rigid.csv")}
    height, length = float(given["h0"]), float(given["r0"])
    runout = length + float(given["r_f (runout measured from gate)"])
    settings = {
        "title": "Mangeney et al. 2010, horizontal rough bed",
        "source": (
            "runout and final height as read off Mangeney et al. (2010, J. Geophys. Res. 115, "
            "F03040) in alexander-busch/ADWELL, CreateScalingFigures.m, +-5 mm, the runout there "
            "from the gate; width, gate speed and glued bed (no slip) from Martin et al. "
            "(2017, Phys. Fluids 29, 013301), who model the same channel; the thickness that "
            "defines the front is not stated"
        ),
        "geometry.slope_angle_deg": float(given["slope"]),
        "geometry.height_0": height,
        "geometry.length_0": length,
        "geometry.channel_width": 0.10,
        "gate.speed": 2.3,
        "material.grain_diameter": 0.7e-3,  # 0.6 to 0.8 mm
        "material.density_grain": float(given["grain density"]),
        "material.solid_fraction": float(given["initial volume fraction"]),
        "material.repose_angle_deg": float(given["repose angle"]),
        "material.avalanche_angle_deg": float(given["avalanche angle"]),
    }
    final = float(given["h_f (max deposit thickness)"])
    values = measured(runout=(runout, READ_OFF), final_height=(final, READ_OFF))
    write(out / "mangeney2010_0deg", settings, values)


def martin(out):
    """Collapses on slopes, of which only bounds are printed."""
    for (slope, width), (runout, stop) in MARTIN.items():
        settings = {
            "title": f"Martin et al. 2017, {slope} deg, w = {100 * width:g} cm",
            "source": (
                "bounds in the text and the axes of Martin et al. (2017, Phys. Fluids 29, 013301): "
                "at 10 deg the deposit lies within 0.7 m (figure 3), at 22 deg 1.6 m is much "
                "larger than the observed runout (section VII); the latest time that is shown is "
                "when the whole mass has stopped; +-2 cm from jumping beads. No curve is supplied"
            ),
            "geometry.slope_angle_deg": float(slope),
            "geometry.height_0": 0.14,
            "geometry.length_0": 0.20,
            "geometry.channel_width": width,
            "gate.speed": 2.3,
            "material.grain_diameter": 0.7e-3,
            "material.density_grain": 2500.0,
            "material.solid_fraction": 0.62,
        }
        bounds = [
            Scalar("runout", runout, SALTATION, "upper"),
            Scalar("time_stop", stop, LAST_GRAINS, "upper"),
        ]
        folder = out / "martin2017" / f"martin2017_{slope}deg_w{100 * width:g}cm"
        write(folder, settings, bounds)


def lajeunesse(data, out):
    """Beads in a channel: one folder per aspect ratio, with runout, final height or both."""
    runouts = points(data / "runout_planestrain.csv", "dL_over_L0")
    heights = points(data / "height_planestrain.csv", "Hf_over_L0")
    for aspect, ratio in runouts.items():
        near = min(heights, key=lambda other: abs(math.log(other / aspect)))
        final = heights.pop(near) if abs(math.log(near / aspect)) < SAME_ASPECT else None
        channel_column(out, aspect, ratio, final)
    for aspect, final in heights.items():
        channel_column(out, aspect, None, final)


def channel_column(out, aspect, runout_ratio, height_ratio):
    """One column of beads in the channel 45 mm wide."""
    length = math.sqrt(CHANNEL_AREA / aspect)
    settings = {
        "title": f"Lajeunesse et al. 2005, channel, aspect ratio {aspect:g}",
        "source": (
            "digitised from the figures of Lajeunesse, Monnier & Homsy (2005, Phys. Fluids 17, "
            "103302) reproduced in kks32/phd-thesis, Chapter2: ratios to the length of the column. "
            f"The size is an assumption: a column of {CHANNEL_AREA:g} m2. The standard deviations "
            f"are those of the reading ({100 * PIXELS:g} %) and of the scatter of the points about "
            "power laws of the aspect ratio. mu_1 is the tangent of the angle of repose"
        ),
        "geometry.slope_angle_deg": 0.0,
        "geometry.height_0": aspect * length,
        "geometry.length_0": length,
        "geometry.channel_width": CHANNEL_WIDTH,
        "material.grain_diameter": BEAD,
        "material.mu_1": math.tan(math.radians(22.0)),
        "material.mu_wall": math.tan(math.radians(24.8)),
        "material.repose_angle_deg": 22.0,
        "material.avalanche_angle_deg": 27.4,
    }
    runout = height = None
    if runout_ratio is not None:
        distance = runout_ratio * length
        scatter = SCATTER_RUNOUT if aspect < 3.0 else SCATTER_RUNOUT_TALL
        runout = (length + distance, math.hypot(PIXELS, scatter) * distance)
    if height_ratio is not None:
        scatter = SCATTER_HEIGHT if aspect > 0.7 else 0.0
        height = (height_ratio * length, math.hypot(PIXELS, scatter) * height_ratio * length)
    values = measured(runout=runout, final_height=height)
    write(out / "lajeunesse2005" / f"a{aspect:.2f}", settings, values)


def points(path, name):
    """{aspect ratio: value} of a digitised figure."""
    return {float(row["a_H0_over_L0"]): float(row[name]) for row in read_table(path)}


def measured(**pairs):
    """The `Scalar`s of (value, standard deviation), without those that are None."""
    return [Scalar(name, *pair, "value") for name, pair in pairs.items() if pair is not None]


def write(folder, settings, scalars, curves=None):
    """Write an experiment folder, and read it back; `curves`: {name: rows of `curves.curve_text`}."""
    rounded = {
        name: float(f"{value:.6g}") if isinstance(value, float) else value
        for name, value in settings.items()
    }
    stated = [f"{name}={toml_value(value)}" for name, value in rounded.items()]
    text = settings_text(stated, folder / SETTINGS)
    folder.mkdir(parents=True, exist_ok=True)
    write_atomic(folder / SETTINGS, stated_lines(text).encode())
    write_atomic(folder / "scalars.csv", scalars_text(scalars).encode())
    for name, rows in (curves or {}).items():
        write_atomic(folder / f"{name}.csv", curve_text(name, rows).encode())
    load_experiment(folder)
    print(folder)


def stated_lines(text):
    """The text without the keys that are not stated, empty sections, and reasons for defaults of [uncertainty]."""
    lines = [REASON.sub(r"\1", line) for line in text.splitlines() if not line.startswith("#")]
    sections = "\n".join(lines).strip().split("\n\n")
    return "\n\n".join(section for section in sections if "=" in section) + "\n"
