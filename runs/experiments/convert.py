"""Published measurements as experiment folders.

    python runs/experiments/convert.py --data FOLDER

FOLDER holds the published data (lab/mangeney2010, lab/lajeunesse2005_digitised). Writes
runs/experiments/mangeney2010_0deg and runs/experiments/lajeunesse2005/a<aspect ratio>; `--out` takes
them elsewhere.
"""

import argparse
import csv
import math
from pathlib import Path

from fvcollapse.curves import Scalar, scalars_text
from fvcollapse.digitised import settings_text
from fvcollapse.experiment import SETTINGS, load_experiment
from fvcollapse.files import write_atomic

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


def main():
    """Convert what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder of the published data")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    arguments = parser.parse_args()
    mangeney(arguments.data / "lab" / "mangeney2010", arguments.out)
    lajeunesse(arguments.data / "lab" / "lajeunesse2005_digitised", arguments.out)


def mangeney(data, out):
    """The collapse on the horizontal: runout and final height."""
    given = {row["quantity"]: row["value"] for row in table(data / "theta0_rigid.csv")}
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
    write(out / "mangeney2010_0deg", settings, runout=(runout, READ_OFF), height=(final, READ_OFF))


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
    write(out / "lajeunesse2005" / f"a{aspect:.2f}", settings, runout, height)


def table(path):
    """Rows of a CSV file as dictionaries."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def points(path, name):
    """{aspect ratio: value} of a digitised figure."""
    return {float(row["a_H0_over_L0"]): float(row[name]) for row in table(path)}


def write(folder, settings, runout=None, height=None):
    """Write an experiment folder, and read it back."""
    scalars = [
        Scalar(name, *pair, "value")
        for name, pair in (("runout", runout), ("final_height", height))
        if pair is not None
    ]
    rounded = {
        name: float(f"{value:.6g}") if isinstance(value, float) else value
        for name, value in settings.items()
    }
    text = settings_text([f"{name}={value}" for name, value in rounded.items()], folder / SETTINGS)
    folder.mkdir(parents=True, exist_ok=True)
    write_atomic(folder / SETTINGS, stated_lines(text).encode())
    write_atomic(folder / "scalars.csv", scalars_text(scalars).encode())
    load_experiment(folder)
    print(folder)


def stated_lines(text):
    """The text without the keys that are not stated, and without empty sections."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    sections = "\n".join(lines).strip().split("\n\n")
    return "\n\n".join(section for section in sections if "=" in section) + "\n"


if __name__ == "__main__":
    main()
