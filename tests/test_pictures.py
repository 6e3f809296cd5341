"""The pictures of a result: all there, not blank, cut along the surface, nothing global touched."""

import io

import matplotlib as mpl
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from PIL import Image

from fvcollapse import open_result
from fvcollapse.case.case import Case
from fvcollapse.draw import drawing, pictures
from fvcollapse.errors import InputError, OutputError
from fvcollapse.output import run as output

NAMES = {
    "profiles.png",
    "interface.png",
    "speed.png",
    "pressure.png",
    "front.png",
    "volume.png",
    "animation.gif",
}


@pytest.fixture
def folder(monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2, "time.field_interval": 0.02})
    output.run_case(case, tmp_path / "run", quiet=True)
    return tmp_path / "run"


def test_all_pictures_are_drawn_and_nothing_global_changes(folder, tmp_path):
    before = dict(mpl.rcParams)
    paths = pictures.draw_all(folder / "result.h5", tmp_path / "a" / "b")
    assert {path.name for path in paths} == NAMES
    assert {path.name for path in (tmp_path / "a" / "b").iterdir()} == NAMES
    assert dict(mpl.rcParams) == before
    for path in paths:
        with Image.open(path) as image:
            assert image.width > 600
            assert len(np.unique(np.asarray(image.convert("L")))) > 10, path.name  # not blank


def test_pictures_go_beside_the_result(folder, monkeypatch):
    for name in ("png", "animation"):
        monkeypatch.setattr(pictures, name, lambda _: b"picture")  # drawn in the test above
    paths = pictures.draw_all(folder)
    assert {path.parent for path in paths} == {folder / "pictures"}


def test_animation_has_a_frame_per_field_and_plays_in_slow_motion(folder):
    result = open_result(folder)
    data = pictures.animation(result)
    assert len(data) < 3e6
    with Image.open(io.BytesIO(data)) as image:
        assert image.n_frames == len(result.field_times) == 11
        assert image.info["duration"] == pytest.approx(1000 * 0.02 * pictures.SLOW_MOTION, abs=10)


def test_animation_of_many_fields_takes_a_part_of_them(folder, monkeypatch):
    monkeypatch.setattr(pictures, "FRAMES_MAX", 4)
    with Image.open(io.BytesIO(pictures.animation(open_result(folder)))) as image:
        assert image.n_frames == 4


def test_grains_are_cut_along_the_surface():
    """A surface that halves the cells: the picture is coloured up to it, not to the cell edges."""
    nx, nz, size = 10, 8, 0.1
    z = size * np.arange(nz + 1)
    field = {
        "level_set": np.tile(z - 0.45, (nx + 1, 1)),
        "pressure": np.ones((nx, nz)),
        "dx": size,
        "dz": size,
    }
    figure = drawing.new_figure(5.0, 5.0)
    axes = figure.add_axes([0.0, 0.0, 1.0, 1.0])
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    axes.axis("off")
    drawing.draw_grains(axes, field, "pressure", 1.0)
    figure.set_layout_engine("none")
    figure.canvas.draw()
    column = np.asarray(figure.canvas.buffer_rgba())[::-1, 300, :3].astype(int)
    coloured = (column.min(axis=1) < 128).mean()
    assert coloured == pytest.approx(0.45, abs=0.01)


def test_pictures_of_a_run_of_no_duration(monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    output.run_case(Case().replace(**{"time.end": 0.0}), tmp_path, quiet=True)
    assert len(pictures.draw_all(tmp_path)) == len(NAMES)


def test_pictures_of_a_broken_result_and_in_an_unwritable_place(folder, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        pictures.draw_all(folder, tmp_path / "file" / "pictures")
    with pytest.raises(InputError):
        pictures.draw_all(tmp_path / "file")
