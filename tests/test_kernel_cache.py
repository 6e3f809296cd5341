"""Compiled kernels on the disk: several processes may save and read at once, and none gets the kernel of another."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fvcollapse.files.kernel_cache import KernelCache, KernelFiles
from fvcollapse.step import geometry

SAVERS, KEYS = 4, 25


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Makes the files of one kernel, as another process sees them; with another version of the sources if asked."""
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path))

    def made(version="a"):
        kept = KernelCache(geometry.wetted_edge.py_func)
        kept._impl.locator.ensure_cache_path()
        kept._cache_file._version = version
        return kept._cache_file

    return made


def test_what_is_saved_is_loaded(files):
    files().save(("key", 1), "kernel")
    assert files().load(("key", 1)) == "kernel"
    assert files().load(("key", 2)) is None
    files().save(("key", 1), "compiled again")
    assert files().load(("key", 1)) == "compiled again"


def test_of_many_that_save_at_once_each_finds_its_kernels(files):
    def save(saver):
        for n in range(KEYS):
            files().save((saver, n), f"kernel {saver} {n}")

    with ThreadPoolExecutor(SAVERS) as threads:
        list(threads.map(save, range(SAVERS)))
    for saver in range(SAVERS):
        for n in range(KEYS):
            assert files().load((saver, n)) == f"kernel {saver} {n}"


def test_the_index_names_a_kernel_only_when_it_is_there(files, monkeypatch):
    written = []

    def save_index(self, entries):
        written.append([self._load_data(name) for name in entries.values()])
        original(self, entries)

    original = KernelFiles._save_index
    monkeypatch.setattr(KernelFiles, "_save_index", save_index)
    files().save("key", "kernel")
    assert written == [["kernel"]]


def test_kernels_of_earlier_sources_are_neither_read_nor_kept(files):
    for key in ("one", "two"):
        files("earlier").save(key, "earlier kernel")
    assert files("later").load("one") is None
    files("later").save("one", "later kernel")
    assert files("later").load("one") == "later kernel"
    assert files("later").load("two") is None
    assert len(list(Path(files()._cache_path).glob("*.nbc"))) == 1


def test_a_kernel_that_two_processes_name_otherwise_is_kept_once(files, monkeypatch):
    files().save("key", "kernel")
    monkeypatch.setattr(KernelFiles, "_data_name_of", lambda self, key: self._data_name(7))
    files().save("key", "the same kernel")
    assert files().load("key") == "the same kernel"
    assert len(list(Path(files()._cache_path).glob("*.nbc"))) == 1


def test_a_kernel_that_another_process_removed_is_compiled_again(files):
    first = files()
    first.save("key", "kernel")
    first._remove_data()
    assert files().load("key") is None
    files().save("key", "kernel")
    assert files().load("key") == "kernel"
