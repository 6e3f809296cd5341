"""Damage of a file is seen before HDF5 opens it, which may otherwise search in it for ever."""

import h5py
import numpy as np
import pytest

from fvcollapse.errors import InputError
from fvcollapse.files.hdf5 import build_image, reading
from fvcollapse.files.hdf5_digest import LENGTH, is_damaged

FLIPS = 200


def fill(file):
    file.attrs["format"] = "test"
    file.attrs["case"] = "a text " * 40
    file.create_dataset("values", data=np.linspace(0.0, 1.0, 100), compression="gzip")


@pytest.fixture(scope="module")
def image():
    return build_image(fill)


@pytest.fixture
def path(tmp_path, image):
    path = tmp_path / "file.h5"
    path.write_bytes(image)
    return path


def texts(path):
    with reading(path, "test") as file:
        return file.attrs["case"], file["values"][-1]


def test_a_sound_file_is_read_by_us_and_by_others(path):
    assert not is_damaged(path)
    assert texts(path) == ("a text " * 40, 1.0)
    with h5py.File(path, "r") as file:
        assert file.attrs["format"] == "test"


def test_every_byte_that_is_damaged_is_seen(path, image):
    rng = np.random.default_rng(3)
    for place in rng.integers(len(image) - LENGTH, size=FLIPS):
        damaged = bytearray(image)
        damaged[place] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="its digest is not that of its content"):
            texts(path)


def test_a_file_that_another_program_changed_is_read(path):
    with h5py.File(path, "r+") as file:
        file.attrs["case"] = "another text"
    assert texts(path) == ("another text", 1.0)


def test_a_file_without_a_digest_is_read(path, image):
    path.write_bytes(image[:-LENGTH])
    assert texts(path) == ("a text " * 40, 1.0)


@pytest.mark.parametrize("length", [0, 10, LENGTH])
def test_a_short_file_is_refused_in_one_line(length, path, image):
    path.write_bytes(image[-length:] if length else b"")
    with pytest.raises(InputError, match="file: found"):
        texts(path)
