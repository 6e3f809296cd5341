"""What a user sees of the objects of Python: figures, tables, labelled arrays, bars and logs."""

import logging
import sys
import types
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_simulation import FakeSimulation

import fvcollapse
from fvcollapse.case.case import Case
from fvcollapse.console import bars
from fvcollapse.draw import grains
from fvcollapse.draw.html import html_table
from fvcollapse.measure.curves import Scalar
from fvcollapse.measure.quantities import CURVES
from fvcollapse.output import run as output
from fvcollapse.output.stored_names import FIELDS, SERIES
from fvcollapse.studies import members
from fvcollapse.studies.converge import converge

EXPERIMENT = Path(__file__).parents[1] / "runs/experiments/example_22deg_w10cm"
PNG = b"\x89PNG"


@pytest.fixture(scope="module")
def result():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        return output.run(Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2}))


@pytest.fixture(scope="module")
def experiment():
    return fvcollapse.load_experiment(EXPERIMENT)


@pytest.mark.parametrize(
    "what", ["profiles", "interface", "front", "volume", "speed", "pressure", "shear_rate"]
)
def test_a_result_draws_itself(result, what):
    figure = result.plot(what, times=(0.1,))
    assert figure._repr_png_().startswith(PNG)
    assert figure.axes[0].has_data()


def test_a_result_shows_its_summary_as_a_table(result):
    html = result._repr_html_()
    for name, value in fvcollapse.output.result.summary_rows(result.summary(), result.case):
        assert f">{name}<" in html.replace("&amp;", "&")
        assert value.split()[0] in html


def test_a_table_holds_text_only():
    html = html_table("a & b", [("<script>", 1)], ("x", "y"))
    assert "<script>" not in html
    assert "&lt;script&gt;" in html
    assert "a &amp; b" in html


def test_a_result_becomes_labelled_arrays(result):
    pytest.importorskip("xarray")
    tree = result.to_xarray()
    assert set(tree["series"].data_vars) == set(SERIES) - {"time"}
    runout = tree["series"]["runout"]
    assert runout.dims == ("time",)
    assert runout.attrs["units"] == "m"
    np.testing.assert_array_equal(runout, result.runout)
    np.testing.assert_array_equal(tree["series"]["time"], result.time)
    np.testing.assert_array_equal(tree["profiles"]["thickness"], result.profiles.thickness)
    assert tree["profiles"]["thickness"].dims == ("time", "x")
    fields = tree["fields"]
    assert set(FIELDS) <= set(fields.data_vars)
    for index in range(len(result.field_times)):
        stored, seen = result.field(index), fields.isel(time=index)
        for name in FIELDS:
            values, shape = np.asarray(seen[name]), stored[name].shape
            np.testing.assert_array_equal(values[tuple(map(slice, shape))], stored[name])
            assert np.isfinite(values).sum() == stored[name].size
    dx = result.field(0)["dx"]
    assert fields["x_node"].values[:2] == pytest.approx([0.0, dx])
    assert fields["x"].values[0] == pytest.approx(0.5 * dx)
    assert fields["u"].dims == ("time", "x_node", "z")
    assert tree.attrs["trust"] == result.trust.verdict
    assert "fields" not in result.to_xarray(fields=False)


def test_labelled_arrays_become_a_file_that_xarray_opens(result, tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    result.to_xarray().to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    with xarray.open_datatree(tmp_path / "run.nc", engine="h5netcdf") as tree:
        np.testing.assert_array_equal(tree["series"]["x_99"], result.x_99)


def test_observations_draw_and_label_themselves(result):
    pytest.importorskip("xarray")
    seen = fvcollapse.observe(result)
    assert seen.plot()._repr_png_().startswith(PNG)
    assert "time of arrest" in seen._repr_html_()
    tree = seen.to_xarray()
    assert set(tree.children) == set(CURVES)
    np.testing.assert_array_equal(tree["front"]["front"], seen.front[:, 1])
    thickness = tree["profiles"]["thickness"]
    assert thickness.shape == (len(result.profiles.time), len(result.profiles.x))
    np.testing.assert_array_equal(np.ravel(thickness), seen.profiles[:, 2])
    assert tree.attrs["runout"] == seen.scalars["runout"]


def test_an_experiment_draws_and_labels_itself(experiment, result):
    pytest.importorskip("xarray")
    assert experiment.plot()._repr_png_().startswith(PNG)
    lines = [len(axes.lines) for axes in experiment.plot().axes]
    overlaid = experiment.plot(fvcollapse.observe(result, experiment))
    assert [len(axes.lines) for axes in overlaid.axes] > lines
    html = experiment._repr_html_()
    assert "45 points, t = 0 to 1.8 s" in html
    front = experiment.curves["front"]
    tree = experiment.to_xarray()
    np.testing.assert_array_equal(tree["front"]["front"], front.value)
    np.testing.assert_array_equal(tree["front"]["sigma"], front.sigma)
    assert tree["profiles"]["x"].attrs["units"] == "m"


def test_an_experiment_shows_what_was_measured_only(experiment, result):
    bare = replace(experiment, curves={"front": experiment.curves["front"]}, scalars=())
    assert [axes.get_ylabel() for axes in bare.plot().axes] == ["front position (cm)"]
    numbers = replace(experiment, curves={}, scalars=(Scalar("runout", 0.475, 0.005, "value"),))
    (axes,) = numbers.plot().axes
    assert "runout: 47.5 ± 0.5 cm" in axes.texts[0].get_text()
    front, words = numbers.plot(fvcollapse.observe(result, numbers)).axes
    assert "measured runout" in front.get_legend_handles_labels()[1]
    assert "simulated: " in words.texts[0].get_text()


def test_results_and_observations_print_as_one_short_line(result):
    assert repr(result) == (
        "<Result: slope 22°, channel 10 cm wide, t = 0 to 0.2 s, complete, trust: look at it>"
    )
    assert repr(fvcollapse.observe(result)).startswith("<Observations: front of ")
    assert "\n" not in repr(fvcollapse.observe(result))


def test_round_off_of_the_volume_is_no_curve(result):
    (axes,) = (axes for axes in result.plot("volume").axes if "error" in axes.get_ylabel())
    low, high = axes.get_ylim()
    assert low <= -0.01 < 0.01 <= high


def test_ticks_of_a_colour_bar_do_not_overlap():
    ticks = grains.ticks_of("speed", 1.05)
    places = [float(grains.norm("speed", 1.05)(value)) for value in ticks]
    assert len(ticks) > 3
    assert np.diff(places).min() > grains.APART
    assert ticks[-1] <= 1.05


def test_without_xarray_the_error_says_what_installs_it(result, experiment, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    for given in (result, fvcollapse.observe(result), experiment):
        with pytest.raises(ImportError, match=r"pip install 'fvcollapse\[notebook\]'"):
            given.to_xarray()


def test_a_convergence_study_in_one_call(monkeypatch, tmp_path):
    def simulated(case, folder, quiet=True, force=False):
        output.run_case(case, folder, quiet=quiet, simulate=FakeSimulation)

    monkeypatch.setattr("fvcollapse.studies.refinement.run_member", simulated)
    assert members.run_member is not simulated
    case = Case().replace(**{"time.end": 0.1})
    study = converge(case, [0.035, 0.03, 0.02], tmp_path / "study")
    assert study.records["runout"]["cell_size"] == [0.035, 0.03, 0.02]
    assert (tmp_path / "study" / "converge.json").exists()
    assert "runout at 10 mm" in study.table()
    assert "runout at 10 mm (m)" in study._repr_html_()
    assert study.plot()._repr_png_().startswith(PNG)


@pytest.mark.parametrize(("kernel", "quiet", "shown"), [(1, False, 1), (1, True, 0), (0, False, 0)])
def test_bars_are_shown_in_notebooks(kernel, quiet, shown, monkeypatch):
    shell = types.SimpleNamespace(kernel=None) if kernel else types.SimpleNamespace()
    module = types.SimpleNamespace(get_ipython=lambda: shell)
    monkeypatch.setitem(sys.modules, "IPython", module)
    assert bars.is_shown(quiet) == bool(shown)


def test_a_run_shows_a_bar_if_it_is_asked_to(monkeypatch, capsys):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    monkeypatch.setattr(bars, "in_notebook", lambda: True)
    case = Case().replace(**{"grid.cell_size": 0.03, "time.end": 0.05})
    output.run(case)
    assert capsys.readouterr().err == ""
    output.run(case, quiet=False)
    assert "0.050/0.050 s" in capsys.readouterr().err


def test_what_is_logged_reaches_the_logger_of_the_package(monkeypatch, tmp_path, caplog):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    with caplog.at_level(logging.INFO, "fvcollapse"):
        output.run(Case().replace(**{"grid.cell_size": 0.03, "time.end": 0.05}), tmp_path)
    assert any("start from t = 0" in record.getMessage() for record in caplog.records)
    assert {record.name for record in caplog.records} == {"fvcollapse.run"}
