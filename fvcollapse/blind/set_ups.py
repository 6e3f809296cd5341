"""The set-ups of the synthetic experiments, and what a laboratory states of them.

Every experiment of a laboratory has the same statement of its material; how well the set-up is known, and whether its
errors are common to all experiments, is one of the `STATEMENTS`.
"""

from collections.abc import Mapping
from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from fvcollapse.blind.measurement import Errors

BELIEVED = {  # what the laboratory states of its grains and of the gate
    "rheology.mu_1": 0.44,
    "rheology.mu_2": 0.70,
    "rheology.I_0": 0.279,
    "boundary.mu_bed": inf,
    "boundary.mu_back_wall": 0.30,
    "gate.speed": 2.3,
    "front.thickness": 0.005,
}
# standard deviations: of what belongs to all runs of a laboratory
MATERIAL_SD = {
    "rheology.mu_1": 0.015,
    "rheology.mu_2": 0.03,
    "rheology.I_0": 0.056,
    "boundary.mu_back_wall": 0.05,
}


class Statement(NamedTuple):
    """What is stated of a set-up.

    Attributes
    ----------
    sd : dict
        Case key -> standard deviation.
    time : float
        Standard deviation of the clock [s].
    common : bool
        Whether all experiments share their errors.
    material : float
        Standard deviations of the material, relative to `MATERIAL_SD`.
    """

    sd: dict[str, float]
    time: float
    common: bool
    material: float = 1.0


STATEMENTS = {
    "careful": Statement(  # every experiment is set up anew and measured well
        {
            "geometry.slope_angle_deg": 0.2,
            "geometry.height_0": 0.0014,
            "geometry.length_0": 0.0015,
            "gate.speed": 0.1,
        },
        0.005,
        False,
    ),
    "one_tank": Statement(  # one tank, gate and camera for all, not well known
        {
            "geometry.slope_angle_deg": 0.4,
            "geometry.height_0": 0.005,
            "geometry.length_0": 0.003,
            "gate.speed": 0.3,
        },
        0.010,
        True,
    ),
    "exact": Statement(  # no laboratory is drawn with it: a quarter of the errors of a careful one
        {
            "geometry.slope_angle_deg": 0.05,
            "geometry.height_0": 0.00035,
            "geometry.length_0": 0.000375,
            "gate.speed": 0.025,
        },
        0.00125,
        False,
        0.25,
    ),
}
LABORATORIES = ("careful", "one_tank")  # statements that worlds are drawn with


class SetUp(NamedTuple):
    """One experiment: slope [deg], channel width, last frame [s], last place on the film, column, gate [m/s]; in m."""

    slope: float
    width: float
    end: float
    reach: float
    height: float = 0.14
    length: float = 0.20
    speed: float = BELIEVED["gate.speed"]

    def stated(self) -> dict[str, float]:
        """Case keys that are stated of this set-up."""
        return BELIEVED | {
            "gate.speed": self.speed,
            "geometry.slope_angle_deg": self.slope,
            "geometry.height_0": self.height,
            "geometry.length_0": self.length,
        }


SET_UPS = {
    "slope00_width10": SetUp(0.0, 0.10, 0.80, 0.70),
    "slope10_width10": SetUp(10.0, 0.10, 1.00, 0.90),
    "slope16_width10": SetUp(16.0, 0.10, 1.32, 1.20),
    "slope16_width05": SetUp(16.0, 0.05, 1.32, 1.20),
    "slope16_width20": SetUp(16.0, 0.20, 1.32, 1.20),
    "slope20_width10": SetUp(20.0, 0.10, 1.68, 1.60),
    "slope04_width07": SetUp(4.0, 0.07, 0.84, 0.75),
    "slope08_width14": SetUp(8.0, 0.14, 0.96, 0.85),
    "slope13_width07": SetUp(13.0, 0.07, 1.20, 1.05),
    "slope13_width14": SetUp(13.0, 0.14, 1.20, 1.05),
    "slope13_width07_tall": SetUp(13.0, 0.07, 1.24, 1.10, 0.18, 0.15),
    "slope18_width14": SetUp(18.0, 0.14, 1.48, 1.40),
}
USUAL_HEIGHT = 0.14  # m, of the columns that are not tall
CONTROL = "control_"  # before the name of the set-up of a control
TRAINING_DESIGNS = (  # the experiments of a case
    ("slope10_width10", "slope16_width10", "slope20_width10"),
    ("slope16_width05", "slope16_width10", "slope16_width20"),
    ("slope00_width10", "slope16_width10", "slope16_width20"),
    ("slope10_width10", "slope16_width05"),
    ("slope16_width10",),
)
BLIND_DESIGNS = (
    ("slope04_width07", "slope13_width07", "slope18_width14"),
    ("slope08_width14", "slope13_width14", "slope18_width14"),
    ("slope13_width07", "slope13_width07_tall"),
    ("slope04_width07", "slope13_width14"),
    ("slope13_width14",),
)


def set_up_of(name: str) -> SetUp:
    """The `SetUp` of an experiment or a control."""
    return SET_UPS[name.removeprefix(CONTROL)]


def errors_of(set_up: SetUp, statement: str, quality: float) -> Errors:
    """The `Errors` of the film of a set-up; `quality` multiplies the errors of single readings."""
    sd = STATEMENTS[statement].sd
    return Errors(
        thickness=0.0012 * quality,
        front=0.005 * quality,
        relative_volume=0.005 * quality,
        interface=0.0025 * quality,
        scale=sd["geometry.height_0"] / set_up.height,
        offset=sd["geometry.length_0"],
        time=STATEMENTS[statement].time,
    )


VARIED = {  # case keys of a set-up that a laboratory can change
    "geometry.slope_angle_deg": "slope",
    "geometry.channel_width": "width",
    "geometry.height_0": "height",
    "gate.speed": "speed",
}


def varied(set_up: SetUp, changes: Mapping[str, float]) -> SetUp:
    """The `SetUp` with other values of `VARIED` {case key: value}; it is filmed as long as such a collapse takes."""
    fields = {VARIED[key]: value for key, value in changes.items() if key in VARIED}
    other = set_up._replace(**fields)
    if (other.slope, other.height) == (set_up.slope, set_up.height):
        return other
    before, after = (film_of(one.slope, one.height) for one in (set_up, other))
    run = (set_up.reach - set_up.length) * after[1] / before[1]
    return other._replace(
        end=round(set_up.end * after[0] / before[0], 2), reach=round(set_up.length + run, 2)
    )


def film_of(slope: float, height: float) -> tuple[float, float]:
    """Last frame [s], and last place from the gate on [m], of a film of a collapse.

    Between the films of the known set-ups, and beyond them in proportion; a column of another height falls and runs in
    proportion to the root of its height, and to its height.
    """
    films = {one.slope: one for one in SET_UPS.values() if one.height == USUAL_HEIGHT}
    slopes = np.array(sorted(films))
    after = int(np.clip(np.searchsorted(slopes, slope), 1, len(slopes) - 1))
    first, last = (films[each] for each in slopes[after - 1 : after + 1])
    part = (slope - first.slope) / (last.slope - first.slope)
    end = first.end + part * (last.end - first.end)
    run = first.reach - first.length + part * (last.reach - first.reach)
    return end * sqrt(height / USUAL_HEIGHT), run * height / USUAL_HEIGHT


def material_sd(statement: str) -> dict[str, float]:
    """{case key: standard deviation} of the material by a statement."""
    return {key: STATEMENTS[statement].material * sd for key, sd in MATERIAL_SD.items()}


def settings_text(set_up: SetUp, statement: str, quality: float = 1.0) -> str:
    """`experiment.toml` of an experiment or a control; nothing in it depends on what is hidden."""
    stated, material = STATEMENTS[statement], material_sd(statement)
    errors, common = errors_of(set_up, statement, quality), str(stated.common).lower()
    return f"""title = "synthetic collapse, {set_up.slope:g} deg, w = {100 * set_up.width:g} cm"
source = "fvcollapse blind"

[geometry]
slope_angle_deg = {set_up.slope}
height_0 = {set_up.height}
length_0 = {set_up.length}
channel_width = {set_up.width}

[gate]
speed = {set_up.speed}

[material]
mu_1 = {BELIEVED["rheology.mu_1"]}
mu_2 = {BELIEVED["rheology.mu_2"]}
I_0 = {BELIEVED["rheology.I_0"]}
mu_back_wall = {BELIEVED["boundary.mu_back_wall"]}

[uncertainty]
thickness = {errors.thickness:.6g}
front = {errors.front:.6g}
relative_volume = {errors.relative_volume:.6g}
interface = {errors.interface:.6g}
time = {errors.time}
slope_angle_deg = {stated.sd["geometry.slope_angle_deg"]}
height_0 = {stated.sd["geometry.height_0"]}
length_0 = {stated.sd["geometry.length_0"]}
speed = {stated.sd["gate.speed"]}
mu_1 = {material["rheology.mu_1"]}
mu_2 = {material["rheology.mu_2"]}
I_0 = {material["rheology.I_0"]}
mu_back_wall = {material["boundary.mu_back_wall"]}

[common]
slope_angle_deg = {common}
height_0 = {common}
length_0 = {common}
speed = {common}
time = {common}

[front]
thickness = {BELIEVED["front.thickness"]}
"""
