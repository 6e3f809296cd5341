"""Experiment folders: what is read, what is absent, the case they make."""

import math
import tomllib

import pytest
from experiment_folder import SETTINGS, write_experiment

from fvcollapse import load_experiment
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.case.grammar import key_table
from fvcollapse.errors import CaseError, InputError
from fvcollapse.measure.experiment import read_settings, strip_truth
from fvcollapse.measure.experiment_keys import CASE_KEYS, Settings
from fvcollapse.measure.experiment_template import experiment_template
from fvcollapse.measure.uncertainty import DEFAULTS

# measurements that suit a column of any size
STOP_ALONE = dict.fromkeys(("front", "profiles", "volume", "interface")) | {
    "scalars": "name,value,sigma,kind\ntime_stop,1.4,0.1,upper\n"
}
BARE = "[geometry]\nslope_angle_deg = 5\nheight_0 = 0.1\nlength_0 = 0.3\n"


@pytest.fixture
def experiment(tmp_path):
    return load_experiment(write_experiment(tmp_path / "beads"))


# -- what is read --------------------------------------------------------------------------------


def test_curves_and_scalars_are_read(experiment):
    assert experiment.name == "beads"
    assert experiment.settings.title == "a column of beads"
    assert list(experiment.curves) == ["front", "profiles", "volume", "interface"]
    profiles = experiment.curves["profiles"]
    assert profiles.time.tolist() == [0.0, 0.0, 0.1, 0.1]
    assert profiles.x.tolist() == [0.1, 0.15, 0.1, 0.3]
    assert profiles.value.tolist() == [0.14, 0.139, 0.13, -0.001]
    assert experiment.curves["front"].x is None
    runout, stop = experiment.scalars
    assert (runout.name, runout.value, runout.sigma, runout.kind) == ("runout", 0.6, 0.02, "value")
    assert (stop.kind, stop.sigma) == ("upper", DEFAULTS["time_stop"].value)
    assert experiment.time_end == 0.2


def test_uncertainty_comes_from_column_then_settings_then_default(experiment):
    curves = experiment.curves
    assert curves["volume"].sigma.tolist() == [0.002, 0.004]
    assert set(curves["profiles"].sigma) == {0.0015}
    assert set(curves["front"].sigma) == {DEFAULTS["front"].value}
    assert experiment.standard_deviation("mu_1") == 0.008
    assert experiment.standard_deviation("mu_2") == DEFAULTS["mu_2"].value
    assert experiment.standard_deviation("speed", 2.3) == pytest.approx(0.23)


def test_columns_in_any_order_and_a_byte_order_mark(tmp_path):
    folder = write_experiment(
        tmp_path, front="\ufeffsigma_m, x_front_m, t_s\r\n0.1, 0.2, 0\r\n", profiles=None
    )
    experiment = load_experiment(folder / "experiment.toml")
    assert experiment.curves["front"].value.tolist() == [0.2]
    assert experiment.curves["front"].sigma.tolist() == [0.1]
    assert "profiles" not in experiment.curves


def test_every_deviation_has_a_key_a_unit_and_a_reason():
    keys = key_table(Settings)
    for name, default in DEFAULTS.items():
        assert keys[f"uncertainty.{name}"].unit == default.unit
        assert default.value > 0.0
        assert default.reason
    measured = {path.rpartition(".")[2] for path in keys if path.split(".")[0] != "uncertainty"}
    assert measured - set(DEFAULTS) == {"title", "source", "origin"}  # the origin's is `time`


def test_keys_of_an_experiment_are_listed(capsys):
    assert main(["keys", "--experiment"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + len(key_table(Settings))
    (thickness,) = (line for line in lines if line.startswith("uncertainty.thickness"))
    assert thickness.split()[1] == f"{DEFAULTS['thickness'].value:g}"
    assert DEFAULTS["thickness"].reason in thickness
    assert any(line.split()[:2] == ["uncertainty.speed", "10"] for line in lines)


def test_front_may_be_unstated(tmp_path):
    experiment = load_experiment(write_experiment(tmp_path, BARE))
    assert experiment.front_thickness is None
    assert experiment.time_origin == 0.0
    base = Case().replace(**{"front.thickness": 0.002})
    assert experiment.case(base).front.thickness == 0.002


def test_a_folder_of_experiments_names_what_is_inside(tmp_path):
    for name in ("beads", "sand"):
        write_experiment(tmp_path / name)
    with pytest.raises(
        InputError, match="no experiment.toml, but experiments in it; allowed: beads, sand$"
    ):
        load_experiment(tmp_path)


def test_a_folder_of_groups_of_experiments_names_the_groups(tmp_path):
    for name in ("lab/beads", "lab/sand", "tall/column"):
        write_experiment(tmp_path / name)
    with pytest.raises(InputError) as refused:
        load_experiment(tmp_path)
    assert refused.value.allowed == "lab/ (2 in it), tall/ (1 in it)"
    write_experiment(tmp_path / "steps")
    with pytest.raises(InputError) as refused:
        load_experiment(tmp_path)
    assert refused.value.allowed == "steps; lab/ (2 in it), tall/ (1 in it)"


def test_a_template_names_all_keys_that_are_missing(tmp_path):
    (tmp_path / "experiment.toml").write_text(experiment_template(), encoding="utf-8")
    with pytest.raises(InputError) as refused:
        load_experiment(tmp_path)
    assert refused.value.key == "geometry.slope_angle_deg, geometry.height_0, geometry.length_0"


# -- the truth is not read -----------------------------------------------------------------------


TRUTHS = [
    '[truth]\ncause = "gate"\n',
    "[truth]\nthis is no TOML at all = = [[[\n",
    '[ "truth" ]\ncause = 1\n[truth.inner]\nx = 2\n[[truth.list]]\ny = 3\n',
    "[truth]\nvalues = [\n  [1, 2],\n  3,\n]\n",
    "['truth'] # hidden\nx = 1\n",
]


@pytest.mark.parametrize("truth", TRUTHS)
def test_truth_is_stripped_before_parsing(tmp_path, truth):
    plain = read_settings(write_experiment(tmp_path / "a") / "experiment.toml")
    text = SETTINGS.replace("[material]", f"{truth}[material]") + truth
    assert strip_truth(text) == SETTINGS
    hidden = load_experiment(write_experiment(tmp_path / "b", text))
    assert hidden.settings == plain
    assert "truth" not in repr((hidden.settings, hidden.curves, hidden.scalars))


@pytest.mark.parametrize(
    "truth", ['truth = "gate"\n', 'truth.cause = "gate"\n', "truth = {a = 1}\n"]
)
def test_truth_as_a_key_is_dropped(tmp_path, truth):
    experiment = load_experiment(write_experiment(tmp_path / "a", truth + SETTINGS))
    assert experiment.settings == load_experiment(write_experiment(tmp_path / "b")).settings


def test_settings_without_truth_are_left_alone():
    assert strip_truth(SETTINGS) == SETTINGS
    assert tomllib.loads(strip_truth("a = '''\n[x]\n'''\n")) == {"a": "[x]\n"}


# -- the case ------------------------------------------------------------------------------------


def test_baseline_is_the_defaults_and_what_the_experiment_says(experiment):
    case = experiment.case()
    changes = {
        "geometry.slope_angle_deg": 16,
        "geometry.channel_width": 0.1,
        "rheology.mu_1": 0.44,
        "rheology.mu_2": 0.7,
        "boundary.mu_bed": 0.5,
        "front.thickness": 0.0105,
    }
    assert case == Case().replace(**changes)
    assert case.effects.lateral_friction is None


def test_absent_means_no_walls_no_gate_no_slip(tmp_path):
    case = load_experiment(write_experiment(tmp_path, BARE)).case()
    assert case.geometry.channel_width == math.inf
    assert case.gate.speed == math.inf
    assert case.boundary.mu_bed == math.inf
    assert case.boundary.mu_back_wall == Case().boundary.mu_back_wall
    assert case.rheology == Case().rheology


def test_set_up_goes_on_top_of_what_the_user_believes(experiment):
    base = Case().replace(
        **{
            "rheology.mu_1": 0.3,
            "rheology.I_0": 0.4,
            "grid.cell_size": 0.02,
            "geometry.slope_angle_deg": 3,
            "effects.lateral_friction": {},
        }
    )
    case = experiment.case(base)
    assert case.rheology.mu_1 == 0.44
    assert case.rheology.I_0 == 0.4
    assert case.grid.cell_size == 0.02
    assert case.geometry.slope_angle_deg == 16
    assert case.effects.lateral_friction is not None


def test_every_key_of_the_set_up_reaches_the_case():
    settings, case = key_table(Settings), key_table(Case)
    assert set(CASE_KEYS) <= set(settings)
    assert {name for name, _ in CASE_KEYS.values()} <= set(case)
    assert all(settings[own].unit == case[name].unit for own, (name, _) in CASE_KEYS.items())


def test_bulk_density_follows_from_the_solid_fraction(tmp_path):
    text = BARE + "[material]\nsolid_fraction = 0.6\ndensity_grain = 2000\n"
    assert load_experiment(write_experiment(tmp_path, text)).case().rheology.density_bulk == 1200
    text += "density_bulk = 1100\n"
    assert load_experiment(write_experiment(tmp_path, text)).case().rheology.density_bulk == 1100


@pytest.mark.parametrize(("height", "length"), [(0.01, 0.4), (8.0, 20.0), (0.4, 0.01)])
def test_columns_of_any_size_have_a_baseline(tmp_path, height, length):
    text = BARE.replace("0.1", str(height)).replace("0.3", str(length))
    case = load_experiment(write_experiment(tmp_path, text, **STOP_ALONE)).case()
    assert case.geometry.height_0 == height
    assert 4 <= height / case.grid.cell_size <= 160


def test_run_lasts_to_the_last_measurement(tmp_path):
    late = "t_s,x_front_m\n0.0,0.2\n4.0,0.5\n"
    text = SETTINGS + "[time]\norigin = 0.25\n"
    experiment = load_experiment(write_experiment(tmp_path, text, front=late))
    assert experiment.case().time.end == 4.25
    assert experiment.case(Case().replace(**{"time.end": 9.0})).time.end == 9.0


def test_base_that_does_not_fit_names_the_experiment(tmp_path):
    low = SETTINGS.replace("height_0 = 0.14", "height_0 = 0.02")
    experiment = load_experiment(write_experiment(tmp_path, low, **STOP_ALONE))
    with pytest.raises(CaseError, match=r"experiment.toml: grid.cell_size: found 0.006"):
        experiment.case(Case())
