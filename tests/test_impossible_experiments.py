"""What no collapse can show is refused, and inputs that users had are judged as they were meant."""

import re
from pathlib import Path

import numpy as np
import pytest
from plausible_experiment import (
    CASES,
    GATE,
    PLACES,
    TIMES,
    experiment,
    scaled,
)

from fvcollapse import load_experiment
from fvcollapse.errors import InputError
from fvcollapse.measure.plausibility import findings, oddities, refuse_impossible
from fvcollapse.measure.plausibility.finding import WARNING


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
