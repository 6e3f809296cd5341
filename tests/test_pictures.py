"""The pictures of a result: all there, not blank, cut along the surface, nothing global touched."""

import io
import re
import shutil
import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec

import matplotlib as mpl
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from PIL import Image

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.draw import animation, captions, drawing, figures, grains, look, pictures
from fvcollapse.errors import InputError, OutputError
from fvcollapse.output import run as output

WHAT = ("profiles", "interface", "front", "volume", "speed", "pressure", "animation")
PICTURES = {f"{what}.{'gif' if what == 'animation' else 'png'}" for what in WHAT}
NAMES = PICTURES | {f"{what}.txt" for what in WHAT}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    case = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.2, "time.field_interval": 0.02})
    output.run_case(case, folder, quiet=True, simulate=FakeSimulation)
    return folder


@pytest.fixture
def folder(made, tmp_path):
    """A copy of the run, beside which pictures may go."""
    return shutil.copytree(made, tmp_path / "run")


def test_all_pictures_are_drawn_and_nothing_global_changes(folder, tmp_path):
    before = dict(mpl.rcParams)
    paths = pictures.draw_all(folder / "result.h5", tmp_path / "a" / "b")
    assert {path.name for path in paths} == NAMES
    assert {path.name for path in (tmp_path / "a" / "b").iterdir()} == NAMES
    assert dict(mpl.rcParams) == before
    for path in (path for path in paths if path.name in PICTURES):
        with Image.open(path) as image:
            assert image.width > 600
            assert len(np.unique(np.asarray(image.convert("L")))) > 10, path.name  # not blank


def test_pictures_go_beside_the_result(folder, monkeypatch):
    for name in ("picture", "animation"):
        monkeypatch.setattr(pictures, name, lambda *_: b"picture")  # drawn in the test above
    paths = pictures.draw_all(folder)
    assert {path.parent for path in paths} == {folder / "pictures"}


def test_animation_has_a_frame_per_profile_and_is_smooth(folder):
    result = open_result(folder)
    data = animation.animation(result)
    assert len(data) < 3e6
    with Image.open(io.BytesIO(data)) as image:
        assert image.n_frames == len(result.profiles.time) == 11
        assert image.info["duration"] == pytest.approx(60)
    assert 1.0 / animation.FRAME_TIME >= 15
    assert animation.slow_motion(result) == pytest.approx(0.06 / 0.02)


def test_animation_of_many_profiles_takes_a_part_of_them_evenly(folder, monkeypatch):
    monkeypatch.setattr(animation, "FRAMES_MAX", 6)
    result = open_result(folder)
    assert animation.frame_times(result) == [0, 2, 4, 6, 8, 10]
    assert animation.slow_motion(result) == pytest.approx(0.06 / 0.04)
    with Image.open(io.BytesIO(animation.animation(result))) as image:
        assert image.n_frames == 6


def test_the_speed_between_two_fields_is_theirs_at_their_times_and_between_them_else(folder):
    result = open_result(folder)
    fields = [result.field(j) for j in range(len(result.field_times))]
    scene = animation.Scene(result, fields, 1.0, look.View(0.0))
    for field in (fields[3], fields[7]):
        values, dx, dz = animation.speed_at(scene, field["time"])
        own = grains.quantity(field, "speed")
        assert (dx, dz) == (field["dx"], field["dz"])
        assert values[: own.shape[0], : own.shape[1]] == pytest.approx(own)
    pair = [grains.quantity(field, "speed").max() for field in fields[3:5]]
    middle = animation.speed_at(scene, 0.5 * (fields[3]["time"] + fields[4]["time"]))[0].max()
    assert min(pair) - 1e-12 <= middle <= max(pair) + 1e-12


def test_a_stretched_field_moves_with_its_front():
    ramp = np.arange(8.0)[:, None] * np.ones((1, 2))
    faces = np.concatenate([[[-0.5, -0.5]], 0.5 + ramp])  # the means of two are the ramp
    field = {"u": faces, "w": np.zeros((8, 3))}
    assert animation.stretched(field, 1.0, 8) == pytest.approx(ramp)
    twice = animation.stretched(field, 2.0, 12)
    centres = np.arange(12) + 0.5
    assert twice[:, 0] == pytest.approx(np.clip(centres / 2 - 0.5, 0, 7))


def test_mp4_needs_ffmpeg_and_holds_all_frames(folder, monkeypatch, tmp_path):
    result, as_mp4 = open_result(folder), look.Look(animation="mp4")
    ffmpeg = shutil.which("ffmpeg") or (
        find_spec("imageio_ffmpeg") and import_module("imageio_ffmpeg").get_ffmpeg_exe()
    )
    if ffmpeg:
        film = tmp_path / "film.mp4"
        film.write_bytes(animation.animation(result, as_mp4))
        command = [ffmpeg, "-i", film, "-map", "0:v", "-f", "null", "-"]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stderr
        shown = len(result.profiles.time) + round(animation.LAST / animation.FRAME_TIME)
        assert re.findall(r"frame= *(\d+)", said)[-1] == str(shown)
        assert "16.67 fps" in said
    monkeypatch.setattr(animation.shutil, "which", lambda name: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(InputError, match="no ffmpeg"):
        animation.animation(result, as_mp4)


@pytest.mark.parametrize("kind", [pytest.param("pdf", marks=pytest.mark.slow), "svg"])
def test_pictures_in_other_formats(folder, tmp_path, kind):
    """Those of PDF are the same each time; SVG numbers its parts at random."""
    chosen = look.Look(format=kind, animation="none", fields=("viscosity",), dpi=60)

    paths = pictures.draw_all(folder, tmp_path / "made", chosen)
    first = {path.name: path.read_bytes() for path in paths}
    wanted = {"profiles", "interface", "front", "volume", "viscosity"}
    assert set(first) == {f"{what}.{end}" for what in wanted for end in (kind, "txt")}
    beginning = b"%PDF" if kind == "pdf" else b"<?xml"
    assert all(data.startswith(beginning) for name, data in first.items() if name.endswith(kind))
    if kind == "pdf":
        result = open_result(folder)
        for what in ("front", "viscosity"):
            assert pictures.picture(result, what, chosen) == first[f"{what}.pdf"]


def test_upright_pictures_have_gravity_pointing_down(folder):
    result = open_result(folder)
    slope = np.radians(result.case.geometry.slope_angle_deg)
    assert slope > 0.3
    along, upright = look.View(slope), look.View(slope, upright=True)
    turned = upright.rotation().transform(along.gravity())
    assert turned == pytest.approx([0.0, -1.0])
    assert upright.gravity() == pytest.approx(turned)
    (x_0, z_0), (x_1, z_1) = upright.limits(2.0, 0.1)
    assert z_0 == pytest.approx(-2.0 * np.sin(slope))  # the bed falls to the right
    assert (x_0, z_1) == pytest.approx((0.0, 0.1 * np.cos(slope)))
    assert x_1 == pytest.approx(2.0 * np.cos(slope) + 0.1 * np.sin(slope))


def test_times_are_the_nearest_stored_ones_and_the_caption_says_them(folder):
    result, wanted = open_result(folder), look.Look(times=(0.041, 0.1, 0.101))
    times = result.field_times
    assert times[drawing.chosen_times(result, times, (), wanted.times)] == pytest.approx(
        [0.04, 0.1]
    )
    text = captions.caption(result, "speed", wanted)
    assert "t = 0.04, 0.1 s" in text
    assert "follow the root of the value" in text
    assert "equal scales" in " ".join(text.split())
    assert len(figures.draw(result, "speed", wanted).axes) == 3  # two panels and the colours


def test_a_front_that_runs_back_is_explained(folder):
    result = open_result(folder)
    assert "No grain runs back" not in captions.caption(result, "front", look.Look())
    result.series["front_position"][-1] = result.series["front_position"].max() - 0.05
    text = captions.caption(result, "front", look.Look())
    assert "50 mm behind its farthest place" in text
    assert "No grain runs back" in text
    words = [text.get_text() for text in figures.draw_front(result).axes[0].texts]
    assert any("thinner than 5 mm" in text for text in words)


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["--fields", "sped"], "field: found sped"),
        (["--times", "0.1", "99"], "--times: found 99"),
        (["--times", "-1"], "--times: found -1"),
        (["--animation", "mp4"], "--animation mp4: found no ffmpeg"),
    ],
)
def test_a_refused_plot_leaves_nothing(folder, tmp_path, monkeypatch, capsys, words, found):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    before = sorted(folder.iterdir())
    assert main(["plot", str(folder), "--out", str(tmp_path / "drawn"), *words]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert found in told
    assert main(["plot", str(folder), *words]) == 2
    assert sorted(folder.iterdir()) == before
    assert not (tmp_path / "drawn").exists()


def test_a_field_that_is_not_there_is_refused(folder, tmp_path):
    with pytest.raises(InputError, match="found cohesion; allowed: speed, .*viscosity"):
        pictures.draw_all(folder, tmp_path, look.Look(fields=("cohesion",)))
    assert {path.name for path in tmp_path.iterdir()} == {"run"}


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
    grains.draw_grains(axes, field, "pressure", 1.0, look.View(0.0))
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
