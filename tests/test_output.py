"""What a run leaves in its folder: names, shapes, units, growth, log, summary."""

import shutil

import h5py
import numpy as np
import pytest
from fake_simulation import FakeSimulation, height, length

import fvcollapse
from fvcollapse import open_result
from fvcollapse.case.case import Case, case_from_text
from fvcollapse.measure.quantities import SCALAR_UNITS
from fvcollapse.output import run as output
from fvcollapse.output import stored_names
from fvcollapse.output.extract import rounded
from fvcollapse.output.record_layout import lowest

SERIES = [
    "time",
    "front_position",
    "front_velocity",
    "runout",
    "runout_1mm",
    "runout_10mm",
    "x_99",
    "max_thickness",
    "detached_volume",
    "relative_volume",
    "volume_correction",
    "kinetic_energy",
    "potential_energy",
    "work_bulk",
    "work_bed",
    "work_back_wall",
    "work_lateral",
    "work_gate",
    "loss_time",
    "loss_advection",
    "loss_surface",
    "energy_outflow",
    "numerical_loss",
    "max_speed",
    "ill_posed_fraction",
    "negative_pressure_cells",
]
FIELDS = ["level_set", "u", "w", "pressure", "shear_rate", "viscosity", "inertial_number"]


@pytest.fixture(scope="module")
def case():
    return Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.3})


@pytest.fixture(scope="module")
def made(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    output.run_case(case, folder, quiet=True, simulate=FakeSimulation)
    return folder


@pytest.fixture
def folder(made, monkeypatch, tmp_path):
    """A copy of the run; further ones are by formula, too."""
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    return shutil.copytree(made, tmp_path, dirs_exist_ok=True)


def test_names_shapes_units(case, folder):
    with h5py.File(folder / "result.h5") as file:
        assert file.attrs["format"] == "fvcollapse-result"
        assert file.attrs["format_version"] == 1
        assert file.attrs["complete"]
        assert file.attrs["code_version"] == fvcollapse.__version__
        assert case_from_text(file.attrs["case"]) == case
        n = len(file["series/time"])
        assert {name: file["series"][name].shape for name in SERIES} == dict.fromkeys(SERIES, (n,))
        assert set(file["series"]) == set(SERIES)
        assert {data.shape for data in file["steps"].values()} == {(n - 1,)}
        assert set(file["steps"]) == set(stored_names.STEPS)
        m, nx = len(file["profiles/time"]), len(file["profiles/x"])
        assert file["profiles/thickness"].shape == file["profiles/static_height"].shape == (m, nx)
        assert sorted(file["fields"], key=int) == ["0", "1", "2", "3"]
        for index, group in file["fields"].items():
            assert group.attrs["time"] == pytest.approx(0.1 * int(index))
            nx, nz = group["pressure"].shape
            assert group["level_set"].shape == (nx + 1, nz + 1)
            assert group["u"].shape == (nx + 1, nz)
            assert group["w"].shape == (nx, nz + 1)
            assert set(group) == set(FIELDS)
        missing = []
        file.visititems(lambda name, data: missing.extend(lacks_attributes(name, data)))
        assert missing == []


def lacks_attributes(name, data):
    """The name of a dataset without units or description."""
    if isinstance(data, h5py.Dataset) and not (
        data.attrs.get("units") and data.attrs.get("description")
    ):
        return [name]
    return []


def test_profiles_are_padded_to_the_last_width(case, folder):
    result = open_result(folder)
    x, thickness = result.profiles.x, result.profiles.thickness
    assert x[-1] > 1.5 * length(case, 0.0)  # the domain has grown
    for time, h in zip(result.profiles.time, thickness, strict=True):
        np.testing.assert_allclose(h, np.maximum(height(case, time, x), 0.0), atol=1e-12)
    widths = [result.field(index)["pressure"].shape[0] for index in range(4)]
    assert widths == sorted(widths)
    assert widths[0] < widths[-1] == len(x) - 1


def test_series_follow_the_pile(case, folder):
    result = open_result(folder)
    tip = np.array([length(case, time) for time in result.time])
    top = np.array([height(case, time, 0.0) for time in result.time])
    np.testing.assert_allclose(result.front_position, tip * (1 - 0.005 / top), atol=0.002)
    np.testing.assert_allclose(result.max_thickness, top)
    assert (np.diff(result.runout) >= 0.0).all()
    assert abs(result.relative_volume).max() < 1e-2  # the tip of the triangle is cut off the grid
    long, rate, area = tip[0], 5.0, case.geometry.height_0 * case.geometry.length_0
    front_rate = rate * (1.0 - 0.005 * long / area)  # of L (1 - 0.005/h) with h = 2 A/L
    window = np.exp(-0.1)  # one-sided at the start: the mean of the first 20 ms
    assert result.front_velocity[0] == pytest.approx(window * front_rate, rel=0.02)
    assert (np.diff(result.volume_correction) >= 0.0).all()


def test_run_in_memory_is_the_run_in_a_folder(case, folder):
    result = output.run(case)
    stored = open_result(folder / "result.h5")
    assert result.path is None
    for name in SERIES:
        np.testing.assert_array_equal(result.series[name], stored.series[name])
    np.testing.assert_array_equal(result.field(-1)["u"], stored.field(3)["u"])
    with pytest.raises(AttributeError, match="no nonsense"):
        result.nonsense  # noqa: B018
    with pytest.raises(IndexError):
        result.field(4)


def test_summary_table_is_aligned_text(folder):
    result = open_result(folder)
    lines = result.summary_table().splitlines()
    values = [line.rindex("  ") for line in lines]
    assert len(set(values)) == 1
    text = "\n".join(lines)
    for words in ("10 mm", "5 mm", "1 mm", "x_99", "peak front", "not at rest", "capped", "wall"):
        assert words in text
    summary = result.summary()
    assert summary["steps"] == len(result.steps["dt"])
    assert summary["capped_steps"] == summary["steps"] // 7


def test_log_tells_the_run(folder):
    text = (folder / "run.log").read_text()
    for words in (
        "mu_1 = 0.48",
        "start from t = 0",
        "checkpoint at t = 0.3",
        "capped step",
        "done",
    ):
        assert words in text
    assert text.count("WARNING capped step") <= 20


def test_no_temporary_file_is_left(folder):
    names = {path.name for path in folder.iterdir()}
    assert names == {"result.h5", "result.xdmf", "checkpoint.h5", "run.log"}


def test_case_with_thousands_of_output_times(monkeypatch, tmp_path):
    """HDF5 attributes beyond 64 KB need the newer format."""
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    times = (10.0 + np.random.default_rng(0).random(6000)).tolist()
    case = Case().replace(**{"grid.cell_size": 0.03, "time.end": 0.01, "time.output_times": times})
    output.run_case(case, tmp_path, quiet=True)
    assert open_result(tmp_path).case.time.output_times == tuple(times)


def test_run_of_no_duration(monkeypatch):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    result = output.run(Case().replace(**{"grid.cell_size": 0.03, "time.end": 0.0}))
    assert result.time.tolist() == [0.0]
    assert len(result.steps["dt"]) == 0
    assert result.summary()["arrest_time"] == 0.0
    assert result.summary_table()


def test_observe_takes_the_threshold_and_origin_of_an_experiment(case, folder):
    result = fvcollapse.open_result(folder)

    class Experiment:
        front_thickness = 0.02
        time_origin = 0.05

    plain, matched = fvcollapse.observe(result), fvcollapse.observe(result, Experiment())
    np.testing.assert_array_equal(plain.front[:, 1], result.front_position)
    assert matched.front[0, 0] == -0.05
    assert (matched.front[:, 1] < plain.scalars["runout"]).all()
    assert matched.scalars["runout"] == matched.front[:, 1].max()
    assert plain.scalars["time_stop"] is None
    assert plain.profiles.shape == (result.profiles.thickness.size, 3)
    names = {row[0] for row in plain.rows()}
    assert names == {
        "front", "thickness", "volume", "static_height", *SCALAR_UNITS,
    }  # fmt: skip


def test_a_result_holds_no_references_which_differ_between_equal_runs(folder):
    """Dimension scales of HDF5 are such; `to_xarray` names the dimensions in their place."""
    with h5py.File(folder / "result.h5") as file:
        objects = [file]
        file.visititems(lambda _, found: objects.append(found))
        assert len(objects) > 20
        for found in objects:
            assert not {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS"} & set(found.attrs)


def test_an_extract_may_round_an_erodible_layer_that_is_gone():
    """A layer of 2.74983 mm that is gone is stored as 2.75040 mm below its surface."""
    case = Case().replace(**{"effects.erodible_bed.thickness": 0.00274983})
    gone = float(rounded(np.array([-0.00274983]))[0])
    assert gone < -0.00274983
    assert lowest(case) <= gone
