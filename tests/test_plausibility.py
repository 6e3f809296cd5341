"""Plausibility: right numbers are silent, another convention is named, the impossible is refused."""

from math import cos, radians, tan
from pathlib import Path

import numpy as np
import pytest
from plausible_experiment import (
    GATE,
    HEIGHT,
    LENGTH,
    SLOPE,
    experiment,
    only,
    scaled,
)

from fvcollapse import load_experiment
from fvcollapse.measure.plausibility import findings
from fvcollapse.measure.plausibility.finding import ERROR, WARNING

SHIPPED = Path(__file__).parents[1] / "runs" / "experiments"


# -- what is right is silent -------------------------------------------------------------------


def test_a_plausible_experiment_is_silent():
    assert list(findings(experiment())) == []


@pytest.mark.parametrize("slope", [0.0, 0.04, 5.0, 16.0, 30.0])
def test_every_slope_is_silent(slope):
    assert list(findings(experiment(geometry__slope_angle_deg=slope))) == []


@pytest.mark.parametrize(
    "folder",
    [path.parent for path in sorted(SHIPPED.rglob("experiment.toml"))],
    ids=lambda folder: folder.name,
)
def test_shipped_experiments_are_silent(folder):
    assert list(findings(load_experiment(folder))) == []


# -- a convention is named ---------------------------------------------------------------------


MM, CM = "in mm", "in cm"
LEVEL = cos(radians(SLOPE))
CONVENTIONS = {
    "front in cm": ({"front": scaled(value=100)}, ERROR, "x_front_m", CM),
    "front in mm": ({"front": scaled(value=1000)}, ERROR, "x_front_m", MM),
    "heights in cm": ({"profiles": scaled(value=100)}, ERROR, "h_m", CM),
    "heights in mm": ({"profiles": scaled(value=1000)}, ERROR, "h_m", MM),
    "heights in km": ({"profiles": scaled(value=0.001)}, ERROR, "h_m", "the column"),
    "X of profiles in mm": ({"profiles": scaled(x=1000)}, ERROR, "x_m", MM),
    "X of profiles in dm": ({"profiles": scaled(x=10)}, ERROR, "x_m", "in dm"),
    "column in cm": (
        {"geometry__height_0": 14.0, "geometry__length_0": 20.0},
        ERROR,
        "x_front_m",
        "the column of experiment.toml in cm",
    ),
    "all from the gate": (
        {"front": scaled(shift=-LENGTH), "profiles": scaled(shift=-LENGTH)},
        ERROR,
        "x_front_m",
        GATE,
    ),
    "profiles from the gate": ({"profiles": scaled(shift=-LENGTH)}, ERROR, "x_m", GATE),
    "vertical heights": ({"profiles": scaled(value=1 / LEVEL)}, WARNING, "h_m", "vertically"),
    "horizontal X of the front": ({"front": scaled(value=LEVEL)}, WARNING, "x_front_m", "cos of"),
    "horizontal X of profiles": ({"profiles": scaled(x=LEVEL)}, WARNING, "x_m", "cos of"),
    "times in ms": ({"front": scaled(time=1000), "volume": None}, ERROR, "t_s", "in ms"),
    "frames, 25 a second": (
        {"front": lambda t, x, value: (np.arange(len(t)) * 1.0, x, value), "volume": None},
        WARNING,
        "t_s",
        "frame numbers",
    ),
    "times without dimension": (
        {"front": scaled(time=(9.81 / HEIGHT) ** 0.5)},
        WARNING,
        "t_s",
        "divided by sqrt(height_0/g)",
    ),
    "times in minutes": ({"front": scaled(time=1 / 60)}, ERROR, "x_front_m", "minutes"),
    "profiles in ms": (
        {"front": None, "volume": None, "profiles": scaled(time=1000)},
        ERROR,
        "t_s",
        "in ms",
    ),
    "volume in per cent": ({"volume": scaled(value=100)}, ERROR, "relative_volume_change", "cent"),
    "volume ratio": ({"volume": scaled(shift=1.0)}, ERROR, "relative_volume_change", "V/V0"),
    "slope in radians": (
        {"geometry__slope_angle_deg": radians(SLOPE)},
        WARNING,
        "geometry.slope_angle_deg",
        "22.0 deg",
    ),
    "repose in radians": (
        {"material__repose_angle_deg": radians(23.7)},
        ERROR,
        "material.repose_angle_deg",
        "in radians (23.7 deg)",
    ),
    "repose as a tangent": (
        {"material__repose_angle_deg": tan(radians(23.7))},
        ERROR,
        "material.repose_angle_deg",
        "a tangent (23.7 deg)",
    ),
    "repose of other grains": (
        {"material__repose_angle_deg": 35.0},
        WARNING,
        "material.repose_angle_deg",
        "",
    ),
    "angles exchanged": (
        {"material__repose_angle_deg": 26.0, "material__avalanche_angle_deg": 23.0},
        WARNING,
        "material.avalanche_angle_deg",
        "exchanged",
    ),
    "friction in degrees": (
        {"material__mu_wall": 8.0},
        WARNING,
        "material.mu_wall",
        f"{tan(radians(8.0)):.3f}",
    ),
    "grains in mm": ({"material__grain_diameter": 0.7}, ERROR, "material.grain_diameter", MM),
    "density in g/cm3": (
        {"material__density_grain": 2.5},
        WARNING,
        "material.density_grain",
        "g/cm3",
    ),
    "gate in mm/s": ({"gate__speed": 2300.0}, WARNING, "gate.speed", "mm/s"),
    "front of 5 m": ({"front__thickness": 5.0}, ERROR, "front.thickness", "in mm"),
}


@pytest.mark.parametrize("name", CONVENTIONS)
def test_another_convention_is_named(name):
    changes, severity, key, words = CONVENTIONS[name]
    found = list(findings(experiment(**changes)))
    assert found
    first = min(found, key=lambda each: (each.severity != severity, each.key != key))
    assert (first.severity, first.key) == (severity, key)
    assert words in first.likely
    assert first.allowed
    assert {each.severity for each in found} == {severity} or severity == ERROR


VALUES = {
    "runout from the gate": (("runout", 0.1, 0.006, "value"), ERROR, GATE),
    "upper bound behind the gate": (("runout", 0.1, 0.006, "upper"), ERROR, GATE),
    "runout in mm": (("runout", 700.0, 6.0, "value"), ERROR, "mm or cm instead"),
    "runout in cm": (("runout", 70.0, 0.6, "value"), ERROR, "mm or cm instead"),
    "runout in dm": (("runout", 17.0, 0.06, "value"), WARNING, "in cm or dm"),
    "height in cm": (("final_height", 8.0, 0.2, "value"), ERROR, CM),
    "negative height": (("final_height", -0.1, 0.002, "value"), ERROR, ""),
    "arrest before the start": (("time_stop", -1.0, 0.1, "value"), ERROR, ""),
    "arrest in ms": (("time_stop", 1400.0, 100.0, "value"), ERROR, "in ms"),
    "arrest in frames": (("time_stop", 70.0, 1.0, "value"), WARNING, "frame number"),
    "velocity in cm/s": (("peak_front_velocity", 120.0, 3.0, "value"), ERROR, "cm/s"),
    "velocity backwards": (("peak_front_velocity", -1.0, 0.1, "value"), ERROR, ""),
    "deviation of nothing": (("runout", 0.6, 1.0e300, "value"), ERROR, ""),
    "deviation in mm": (("runout", 0.6, 6.0, "value"), WARNING, "in mm"),
}


@pytest.mark.parametrize("name", VALUES)
def test_a_single_number_in_another_convention(name):
    scalar, severity, words = VALUES[name]
    found = list(findings(only(scalar)))
    assert [each.severity for each in found if words in each.likely][:1] == [severity]


@pytest.mark.parametrize(
    "scalar",
    [
        ("runout", 0.33, 0.006, "value"),  # from the gate as well: nothing shows it
        ("runout", 1.6, 0.02, "upper"),
        ("runout", 0.0, 0.02, "lower"),
        ("final_height", 0.142, 0.002, "value"),
        ("time_stop", 0.0, 0.1, "value"),
        ("time_stop", 7.0, 0.1, "value"),
        ("time_stop", 500.0, 0.6, "upper"),
        ("peak_front_velocity", 1.3, 0.1, "value"),
    ],
)
def test_single_numbers_that_are_right_are_silent(scalar):
    assert list(findings(only(scalar))) == []


def test_bounds_follow_one_another():
    lower, upper = ("runout", 2.0, 0.1, "lower"), ("runout", 1.0, 0.1, "upper")
    (found,) = findings(only(lower, upper))
    assert (found.severity, found.found) == (ERROR, "1 as the upper bound")
    assert "2" in found.allowed
    value = ("runout", 1.2, 0.1, "value")
    assert list(findings(only(value, ("runout", 1.0, 0.1, "upper")))) == []  # two deviations
    (found,) = findings(only(value, ("runout", 0.3, 0.02, "upper")))
    assert found.severity == ERROR


def test_runout_from_the_gate_beside_a_front_from_the_wall():
    (found,) = findings(experiment(scalars=[("runout", 0.5, 0.006, "value")]))
    assert (found.severity, found.key) == (WARNING, "runout")
    assert GATE in found.likely
