"""The set-ups of the synthetic experiments, and what the laboratory states of them.

Every label has the same statement: set-up, material as the laboratory believes it, and standard deviations.
"""

from math import inf
from typing import NamedTuple

from fvcollapse.blind.measurement import Errors

BELIEVED = {  # what the laboratory states of its grains and of the gate
    "rheology.mu_1": 0.44,
    "rheology.mu_2": 0.70,
    "rheology.I_0": 0.279,
    "boundary.mu_bed": inf,
    "boundary.mu_back_wall": 0.30,
    "gate.speed": 2.3,
    "geometry.height_0": 0.14,
    "geometry.length_0": 0.20,
    "front.thickness": 0.005,
}
# standard deviations: of what belongs to all runs of a case, and of what is set up anew for each
MATERIAL_SD = {
    "rheology.mu_1": 0.015,
    "rheology.mu_2": 0.03,
    "rheology.I_0": 0.056,
    "boundary.mu_back_wall": 0.05,
}
SET_UP_SD = {
    "geometry.slope_angle_deg": 0.2,
    "geometry.height_0": 0.0014,
    "geometry.length_0": 0.0015,
    "gate.speed": 0.1,
}
ERRORS = Errors(
    thickness=0.0012,
    front=0.005,
    relative_volume=0.005,
    interface=0.0025,
    scale=SET_UP_SD["geometry.height_0"] / BELIEVED["geometry.height_0"],
    offset=SET_UP_SD["geometry.length_0"],
    time=0.005,
)


class SetUp(NamedTuple):
    """One experiment: slope [deg], channel width [m], last frame [s], last place on the film [m]."""

    slope: float
    width: float
    end: float
    reach: float


SET_UPS = {
    "slope00_width10": SetUp(0.0, 0.10, 0.80, 0.70),
    "slope10_width10": SetUp(10.0, 0.10, 1.00, 0.90),
    "slope16_width10": SetUp(16.0, 0.10, 1.32, 1.20),
    "slope16_width05": SetUp(16.0, 0.05, 1.32, 1.20),
    "slope16_width20": SetUp(16.0, 0.20, 1.32, 1.20),
    "slope20_width10": SetUp(20.0, 0.10, 1.68, 1.60),
}
DESIGNS = (  # the experiments of a case
    ("slope10_width10", "slope16_width10", "slope20_width10"),
    ("slope16_width05", "slope16_width10", "slope16_width20"),
    ("slope00_width10", "slope16_width10", "slope16_width20"),
    ("slope10_width10", "slope16_width05"),
    ("slope16_width10",),
)


def settings_text(name):
    """`experiment.toml` of a set-up; nothing in it depends on a label."""
    set_up = SET_UPS[name]
    return f"""title = "synthetic collapse, {set_up.slope:g} deg, w = {100 * set_up.width:g} cm"
source = "fvcollapse blind"

[geometry]
slope_angle_deg = {set_up.slope}
height_0 = {BELIEVED["geometry.height_0"]}
length_0 = {BELIEVED["geometry.length_0"]}
channel_width = {set_up.width}

[gate]
speed = {BELIEVED["gate.speed"]}

[material]
mu_1 = {BELIEVED["rheology.mu_1"]}
mu_2 = {BELIEVED["rheology.mu_2"]}
I_0 = {BELIEVED["rheology.I_0"]}
mu_back_wall = {BELIEVED["boundary.mu_back_wall"]}

[uncertainty]
thickness = {ERRORS.thickness}
front = {ERRORS.front}
relative_volume = {ERRORS.relative_volume}
interface = {ERRORS.interface}
time = {ERRORS.time}
slope_angle_deg = {SET_UP_SD["geometry.slope_angle_deg"]}
height_0 = {SET_UP_SD["geometry.height_0"]}
length_0 = {SET_UP_SD["geometry.length_0"]}
speed = {SET_UP_SD["gate.speed"]}
mu_1 = {MATERIAL_SD["rheology.mu_1"]}
mu_2 = {MATERIAL_SD["rheology.mu_2"]}
I_0 = {MATERIAL_SD["rheology.I_0"]}
mu_back_wall = {MATERIAL_SD["boundary.mu_back_wall"]}

[front]
thickness = {BELIEVED["front.thickness"]}
"""
