"""Plausibility: right numbers are silent, another convention is named, the impossible is refused."""

import re
from math import cos, radians, tan
from pathlib import Path

import numpy as np
import pytest

from fvcollapse import load_experiment
from fvcollapse.errors import InputError
from fvcollapse.measure.curves import Curve, Scalar
from fvcollapse.measure.experiment import Experiment
from fvcollapse.measure.experiment_keys import settings_from_table
from fvcollapse.measure.plausibility import findings, oddities, refuse_impossible
from fvcollapse.measure.plausibility.finding import ERROR, WARNING

CASES = Path(__file__).parent / "conventions"
SHIPPED = Path(__file__).parents[1] / "runs" / "experiments"
SLOPE, HEIGHT, LENGTH = 22.0, 0.14, 0.2
TIMES = np.arange(0.0, 1.21, 0.05)
PLACES = np.arange(0.005, 0.8, 0.01)
GATE, MM, CM = "counted from the gate", "in mm", "in cm"


def front_at(time):
    """A front that covers half of its way in 0.3 s."""
    return LENGTH + 0.5 * (1.0 - np.exp(-((np.asarray(time) / 0.36) ** 2)))


def thickness_at(time, x):
    """A pile of the area of the column whose back sinks as its front runs."""
    reach = front_at(time)
    power = 2.0 + 58.0 * np.exp(-time / 0.1)
    back = HEIGHT * LENGTH / reach * (power + 1.0) / power
    return back * np.maximum(1.0 - (x / reach) ** power, 0.0)


def experiment(**changes):
    """A plausible experiment in memory.

    Parameters
    ----------
    **changes
        Dotted keys of the settings with `__` for the dot, and `front`, `profiles`, `volume`: functions
        (time, x, value) -> the same of what is measured; None leaves a curve out. `scalars`: rows.
    """
    table = {
        "geometry": {"slope_angle_deg": SLOPE, "height_0": HEIGHT, "length_0": LENGTH},
        "gate": {"speed": 2.3},
        "material": {"mu_1": 0.44},
        "uncertainty": {"front": 0.004, "thickness": 0.0015},
    }
    for name in [name for name in changes if "__" in name]:
        section, _, key = name.partition("__")
        table.setdefault(section, {})[key] = changes.pop(name)
    rows = [(t, x, thickness_at(t, x)) for t in TIMES for x in PLACES]
    time, x, height = (np.array(column) for column in zip(*rows, strict=True))
    curves = {
        "front": (TIMES, None, front_at(TIMES), 0.004),
        "profiles": (time, x, height, 0.0015),
        "volume": (TIMES, None, 0.02 * TIMES, 0.01),
    }
    measured = {}
    for name, (t, place, value, sigma) in curves.items():
        change = changes.get(name, lambda *columns: columns)
        if change is not None:
            t, place, value = change(t, place, value)
            measured[name] = Curve(t, place, value, np.full(len(value), sigma))
    scalars = tuple(Scalar(*row) for row in changes.get("scalars", ()))
    return Experiment(
        Path("beads"), settings_from_table(table, "experiment.toml"), measured, scalars
    )


def only(*scalars, **changes):
    """An experiment of single numbers."""
    bare = {"front": None, "profiles": None, "volume": None}
    return experiment(**bare, scalars=scalars, **changes)


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


def scaled(time=1.0, x=1.0, value=1.0, shift=0.0):
    """A change of a curve: factors of its columns, and a shift of X (for a front its value)."""

    def change(t, place, values):
        if place is None:
            return t * time, None, values * value + shift
        return t * time, place * x + shift, values * value

    return change


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


# -- the impossible ----------------------------------------------------------------------------


def with_value(row, value):
    """A change of a curve: one value."""

    def change(time, x, values):
        values = values.copy()
        values[row] = value
        return time, x, values

    return change


IMPOSSIBLE = [
    ("profiles", 0, 140.0),
    ("profiles", 30, 0.35),
    ("profiles", 70, -3.0),
    ("profiles", 70, -1.0e308),
    ("front", 3, -5.0),
    ("front", 10, 1.0e300),
    ("front", 1, 0.7),
    ("volume", 9, -5.0),
    ("volume", 9, -1.5),
]


@pytest.mark.parametrize(("curve", "row", "value"), IMPOSSIBLE)
def test_impossible_values_are_refused(curve, row, value):
    with pytest.raises(InputError) as caught:
        refuse_impossible(experiment(**{curve: with_value(row, value)}))
    assert caught.value.file == str(Path("beads") / f"{curve}.csv")
    assert f"{value:g}" in caught.value.found
    assert " s" in caught.value.found
    assert "\n" not in str(caught.value)


def test_a_height_below_the_bed_is_told_and_noise_is_not():
    (found,) = oddities(experiment(profiles=with_value(79, -0.009)))
    assert "wrong zero" in found.likely
    assert "eroded" in found.likely
    noise = 0.0015 * np.random.default_rng(1).standard_normal(len(TIMES) * len(PLACES))
    assert not oddities(experiment(profiles=lambda t, x, value: (t, x, value + noise)))


@pytest.mark.parametrize("moment", [1.0e300, -1.0e300, 1.0e5])
def test_absurd_times_are_refused(moment):
    late = experiment(front=lambda t, x, value: (np.append(t[:-1], moment), x, value))
    with pytest.raises(InputError, match="t_s: found"):
        refuse_impossible(late)


def test_a_slow_gate_and_a_closed_one_set_the_pace():
    slow = scaled(time=8.0)
    curves = {"front": slow, "profiles": slow, "volume": slow}
    assert [each.key for each in findings(experiment(**curves))] == ["t_s"]
    assert list(findings(experiment(gate__speed=0.05, **curves))) == []
    assert list(findings(load_experiment(CASES / "closed_gate"))) == []


def test_the_clock_of_the_experiment_counts():
    """t = 0 of the film 0.4 s before the gate: nothing moves at first."""
    later = {
        name: lambda t, x, value: (t + 0.4, x, value) for name in ("front", "profiles", "volume")
    }
    assert list(findings(experiment(time__origin=-0.4, **later))) == []
    early = {
        name: lambda t, x, value: (t - 0.4, x, value) for name in ("front", "profiles", "volume")
    }
    assert list(findings(experiment(time__origin=0.4, **early))) == []
    assert list(findings(experiment(**early)))


# -- the inputs that users met -----------------------------------------------------------------


def test_x_from_the_gate_is_told_at_once():
    line = "front.csv: x_front_m: found 0 at t = 0 s, behind the gate; allowed: >= length_0 = 0.2 m"
    with pytest.raises(InputError, match=re.escape(line)) as caught:
        load_experiment(CASES / "x_from_gate")
    assert GATE in caught.value.allowed


def test_angles_in_radians_are_told_at_once():
    with pytest.raises(InputError, match=r"repose_angle_deg: found 0.415 deg beside mu_1 = 0.44"):
        load_experiment(CASES / "radians")


def copied(folder, name, **files):
    """A copy of an experiment; `files`: CSV file -> file of the case that takes its place."""
    folder.mkdir()
    for file in ("experiment.toml", "front.csv", "profiles.csv"):
        text = (CASES / name / files.get(file.partition(".")[0], file)).read_text(encoding="utf-8")
        (folder / file).write_text(text, encoding="utf-8")
    return folder


def test_friction_in_degrees_is_told(tmp_path):
    folder = copied(tmp_path / "beads", "radians", experiment="friction_in_degrees.toml")
    with pytest.raises(
        InputError, match=r"material.mu_1: found 23.7; allowed: a number >= 0 and <= 10"
    ):
        load_experiment(folder)


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("profiles.csv", "x_m: found 0.07 after 0.09 in line 59"),
        ("profiles_duplicate_x.csv", "x_m: found 0.11 after 0.11 in line 61"),
        ("profiles_nan.csv", "h_m: found 'NaN' in line 57"),
        ("profiles_empty_cell.csv", "h_m: found '' in line 57"),
    ],
)
def test_disorder_is_refused_with_its_line(tmp_path, file, words):
    with pytest.raises(InputError, match=words):
        load_experiment(copied(tmp_path / "beads", "disorder", profiles=file))


def test_a_rough_surface_is_read_as_it_is_and_a_negative_height_is_told(tmp_path):
    rough = copied(tmp_path / "rough", "disorder", profiles="profiles_rough_surface.csv")
    assert list(findings(load_experiment(rough))) == []
    low = copied(tmp_path / "low", "disorder", profiles="profiles_negative_h.csv")
    (found,) = findings(load_experiment(low))
    assert (found.severity, found.found) == (WARNING, "-0.0042 at t = 0.4 s, x = 0.43 m")
    assert "wrong zero of the heights" in found.likely


def test_impossible_heights_are_refused(tmp_path):
    for name in ("profiles", "scalars"):
        folder = tmp_path / name
        folder.mkdir()
        for file in ("experiment.toml", f"{name}.csv"):
            (folder / file).write_text((CASES / "impossible_heights" / file).read_text())
        with pytest.raises(
            InputError, match=f"{name}.csv: (h_m: found 140 at t = 0 s|sigma: found 0)"
        ):
            load_experiment(folder)
