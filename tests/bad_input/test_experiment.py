"""A malformed experiment folder: one line that names file, key or column, found and allowed."""

import os

import pytest
from experiment_folder import SETTINGS, write_experiment

from fvcollapse import load_experiment
from fvcollapse.errors import InputError

# name: (text appended to experiment.toml, key, words of what is found, of what is allowed)
SETTINGS_REFUSED = {
    "misspelt key": ("[time]\norigen = 0.1", "time.origen", "an unknown key", "time.origin"),
    "misspelt section": ("[geomtry]\nheight_0 = 1", "geomtry", "unknown", "geometry"),
    "effect in an experiment": ("[effects.gate]", "effects", "unknown", "closest"),
    "text for a number": ("[time]\norigin = 'soon'", "time.origin", '"soon"', "a number"),
    "not finite": ("[time]\norigin = nan", "time.origin", "nan", "a number >= -1000"),
    "broken TOML": ("[time\n", "file", "broken TOML", "valid TOML"),
}
# name: (what is replaced in experiment.toml, by what, key, found, allowed)
SETTINGS_CHANGED = {
    "number for the title": ('"a column of beads"', "3", "title", "3", "text"),
    "slope out of range": ("slope_angle_deg = 16", "slope_angle_deg = 40", "deg", "40", "<= 30"),
    "no slope": ("slope_angle_deg = 16", "", "geometry.slope_angle_deg", "no such key", "slope"),
    "no height": ("height_0 = 0.14", "", "geometry.height_0", "no such key", "column"),
    "inf height": ("height_0 = 0.14", "height_0 = inf", "geometry.height_0", "inf", "number > 0"),
    "gate without speed": ("speed = 2.3", "time_constant = 0.1", "time_constant", "0.1", "speed"),
    "negative deviation": ("mu_1 = 0.008", "mu_1 = -0.1", "uncertainty.mu_1", "-0.1", ">= 0"),
    "deviation of zero": (
        "thickness = 0.0015",
        "thickness = 0",
        "uncertainty.thickness",
        "0",
        "> 0",
    ),
    "endless deviation": ("mu_1 = 0.008", "mu_1 = 1e300", "uncertainty.mu_1", "1e+300", "<= 10"),
    "unknown deviation": ("mu_1 = 0.008", "mu1 = 0.1", "uncertainty.mu1", "unknown", "mu_1"),
    "mu_2 below mu_1": ("mu_2 = 0.7", "mu_2 = 0.3", "material.mu_2", "0.3", ">= rheology.mu_1"),
    "mu_1 whose mu_2 is beyond all": (
        "mu_1 = 0.44\nmu_2 = 0.7",
        "mu_1 = 9.9",
        "material.mu_2",
        "10.15 (the stated mu_1 + 0.25, as of glass beads: none stated)",
        "<= 10",
    ),
}
# name: (CSV file, its text, column, words of what is found, of what is allowed)
CURVES_REFUSED = {
    "no header": ("front", "0,0.2\n0.1,0.3\n", "0", "unknown column", "closest column"),
    "misspelt column": ("front", "t_s,x_fornt_m\n0,1\n", "x_fornt_m", "unknown", "x_front_m"),
    "missing column": ("profiles", "t_s,h_m\n0,1\n", "x_m", "no such column", "t_s, x_m, h_m"),
    "column twice": ("front", "t_s,t_s,x_front_m\n0,0,1\n", "t_s", "twice", "once"),
    "nothing": ("front", "", "file", "no rows", "t_s, x_front_m"),
    "header alone": ("front", "t_s,x_front_m\n", "file", "no rows", "rows"),
    "text": ("front", "t_s,x_front_m\n0,far\n", "x_front_m", "'far' in line 2", "finite number"),
    "nan": ("front", "t_s,x_front_m\n0,nan\n", "x_front_m", "'nan' in line 2", "finite number"),
    "inf": ("volume", "t_s,relative_volume_change\n\ninf,0\n", "t_s", "in line 3", "finite"),
    "underscore": ("front", "t_s,x_front_m\n0,1_000\n", "x_front_m", "'1_000' in line 2", "finite"),
    "Arabic digits": (
        "front",
        "t_s,x_front_m\n0,0.\u0662\n",
        "x_front_m",
        "in line 2",
        "finite number",
    ),
    "full-width digits": ("front", "t_s,x_front_m\n0,\uff11\n", "x_front_m", "in line 2", "finite"),
    "beyond the range": (
        "front",
        "t_s,x_front_m\n0,1e999\n",
        "x_front_m",
        "'1e999'",
        "finite number",
    ),
    "empty cell": ("front", "t_s,x_front_m\n0,\n", "x_front_m", "'' in line 2", "finite number"),
    "short row": ("front", "t_s,x_front_m\n0,1\n0.1\n", "row", "1 cells in line 3", "2"),
    "same time": ("front", "t_s,x_front_m\n0,1\n0,2\n", "t_s", "0 after 0 in line 3", "increas"),
    "time goes back": (
        "profiles",
        "t_s,x_m,h_m\n0.1,0,1\n0.2,0,1\n0.1,1,1\n",
        "t_s",
        "0.1 after 0.2 in line 4",
        "in order",
    ),
    "x goes back": (
        "interface",
        "t_s,x_m,z_static_m\n0.1,0.2,1\n0.1,0.1,1\n",
        "x_m",
        "0.1 after 0.2 in line 3",
        "within each time",
    ),
    "negative sigma": (
        "front",
        "t_s,x_front_m,sigma_m\n0,1,0.1\n1,1,-0.1\n",
        "sigma_m",
        "-0.1 in line 3",
        "> 0",
    ),
    "sigma of zero": ("front", "t_s,x_front_m,sigma_m\n0,1,0\n", "sigma_m", "0 in line 2", "> 0"),
    "broken quote": ("front", 't_s,x_front_m\n0,"1\n', "file", "broken CSV", "comma"),
    "unknown scalar": ("scalars", "name,value\nrunuot,1\n", "name", "'runuot'", "runout"),
    "unknown kind": (
        "scalars",
        "name,value,sigma,kind\nrunout,1,0.1,most\n",
        "kind",
        "'most' in line 2",
        "value or upper or lower",
    ),
    "scalar twice": (
        "scalars",
        "name,value\nrunout,1\ntime_stop,2\nrunout,3\n",
        "name",
        "runout (value) twice in line 2",
        "once",
    ),
    "scalar not finite": ("scalars", "name,value\nrunout,inf\n", "value", "'inf'", "finite"),
    "scalar deviation": (
        "scalars",
        "name,value,sigma\nrunout,1,-1\n",
        "sigma",
        "-1 in line 2",
        "> 0",
    ),
}


def refused(folder, file, key, found, allowed):
    with pytest.raises(InputError) as caught:
        load_experiment(folder)
    error = caught.value
    assert error.exit_status == 2
    assert error.file.endswith(file)
    assert "\n" not in str(error)
    assert key in error.key
    assert found in error.found
    assert allowed in error.allowed


@pytest.mark.parametrize("name", SETTINGS_REFUSED)
def test_settings_are_refused(tmp_path, name):
    text, key, found, allowed = SETTINGS_REFUSED[name]
    folder = write_experiment(tmp_path, SETTINGS + text)
    refused(folder, "experiment.toml", key, found, allowed)


@pytest.mark.parametrize("name", SETTINGS_CHANGED)
def test_changed_settings_are_refused(tmp_path, name):
    old, new, key, found, allowed = SETTINGS_CHANGED[name]
    assert old in SETTINGS
    folder = write_experiment(tmp_path, SETTINGS.replace(old, new))
    refused(folder, "experiment.toml", key, found, allowed)


@pytest.mark.parametrize("name", CURVES_REFUSED)
def test_curves_are_refused(tmp_path, name):
    file, text, column, found, allowed = CURVES_REFUSED[name]
    folder = write_experiment(tmp_path, **{file: text})
    refused(folder, f"{file}.csv", column, found, allowed)


def test_bytes_that_are_no_text_are_refused(tmp_path):
    folder = write_experiment(tmp_path)
    (folder / "volume.csv").write_bytes(b"t_s,\xff\n")
    refused(folder, "volume.csv", "file", "not UTF-8 at offset 4", "UTF-8")


def test_folder_without_settings_or_measurements_is_refused(tmp_path):
    refused(tmp_path / "none", "experiment.toml", "file", "no such file", "a readable TOML file")
    nothing = dict.fromkeys(("front", "profiles", "volume", "interface", "scalars"))
    write_experiment(tmp_path / "bare", **nothing)
    refused(tmp_path / "bare", "bare", "folder", "no measurement", "front.csv")


def test_misspelt_file_is_not_passed_over(tmp_path):
    folder = write_experiment(tmp_path, profile="t_s,x_m,h_m\n0,0,1\n")
    refused(folder, "profile.csv", "file", "a name that is not read", "profiles.csv")
    (folder / "profile.csv").rename(folder / "pixels.csv")  # the experimenter's own business
    load_experiment(folder)


@pytest.mark.parametrize(
    "name",
    [
        "profiles.CSV",
        "Profiles.csv",
        "profiles.csv.txt",
        "profiles.txt",
        "profiles.xlsx",
        "PROFILES.csv.gz",
    ],
)
def test_another_ending_is_not_passed_over(tmp_path, name):
    folder = write_experiment(tmp_path)
    (folder / "profiles.csv").rename(folder / name)
    refused(folder, name, "file", "a name that is not read", "profiles.csv")


@pytest.mark.parametrize(
    "name", ["front.txt", "profiles.csv~", ".profiles.csv.swp", "front.csv.bak"]
)
def test_sources_and_copies_beside_a_file_are_no_business(tmp_path, name):
    folder = write_experiment(tmp_path)
    (folder / name).write_text("0 1\n")
    load_experiment(folder)


def test_what_is_no_file_is_not_passed_over(tmp_path):
    folder = write_experiment(tmp_path, volume=None, profiles=None)
    path = folder / "profiles.csv"
    path.symlink_to(folder / "gone.csv")
    refused(folder, "profiles.csv", "file", "a link to nothing", "a CSV file")
    path.unlink()
    path.symlink_to(path)
    refused(folder, "profiles.csv", "file", "symbolic links", "a CSV file")
    path.unlink()
    path.mkdir()
    refused(folder, "profiles.csv", "file", "a folder", "a CSV file")
    path.rmdir()
    os.mkfifo(path)  # without a writer
    refused(folder, "profiles.csv", "file", "a named pipe", "a CSV file")
    path.unlink()
    path.symlink_to(folder / "front.csv")
    with pytest.raises(InputError, match="h_m|x_front_m"):
        load_experiment(folder)


def test_settings_from_a_pipe_are_not_waited_for(tmp_path):
    folder = write_experiment(tmp_path)
    (folder / "experiment.toml").unlink()
    os.mkfifo(folder / "experiment.toml")
    refused(
        folder, "experiment.toml", "file", "a named pipe, not a regular file", "a readable TOML"
    )
