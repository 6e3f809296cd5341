"""Files that somebody else has made: results, checkpoints, labels, names; each fault is one line, and leads nowhere."""

import shutil

import h5py
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from same_result import differences

from fvcollapse import open_result
from fvcollapse.__main__ import main
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError
from fvcollapse.output import run as output
from fvcollapse.output.checkpoint import read_checkpoint

CASE = Case().replace(**{"grid.cell_size": 0.035, "time.end": 0.02, "time.field_interval": 0.01})


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        output.run_case(CASE, folder, quiet=True)
    return folder


@pytest.fixture
def folder(finished, monkeypatch, tmp_path):
    monkeypatch.setattr(output, "Simulation", FakeSimulation)
    return shutil.copytree(finished, tmp_path / "run")


def put(path, name, values, **options):
    """Replace a data set, or an attribute where the name has a point."""
    with h5py.File(path, "r+") as file:
        if "." in name:
            item, _, key = name.rpartition(".")
            del file[item or "/"].attrs[key]
            file[item or "/"].attrs[key] = values
            return
        if name in file:
            del file[name]
        file.create_dataset(name, data=values, **options)


def values_of(path, name):
    with h5py.File(path, "r") as file:
        return file[name][()]


# -- results: types, shapes, values ------------------------------------------------------------------

CHANGES = {
    "text for numbers": ("series/runout", lambda values: values.astype("S1"), "type |S1"),
    "text for places": ("profiles/x", lambda values: values.astype("S4"), "type |S4"),
    "complex numbers": ("series/x_99", lambda values: values.astype(complex), "type complex128"),
    "truth values": ("series/runout", lambda values: values > 0.0, "type bool"),
    "not a number": ("series/max_speed", lambda values: values * np.nan, "not finite"),
    "infinite": ("profiles/thickness", lambda values: values + np.inf, "not finite"),
    "too short": ("series/runout", lambda values: values[:2], "shape (2,)"),
    "a dimension more": ("series/runout", lambda values: values[:, None], "shape ("),
    "a number for a series": ("series/runout", lambda values: values[0], "shape ()"),
    "times backwards": ("series/time", lambda values: values[::-1], "after"),
    "time stands still": ("series/time", lambda values: values * 0.0, "0 after 0"),
    "time before the start": ("series/time", lambda values: values - 5.0, "the value -5"),
    "time beyond the end": ("series/time", lambda values: values * 1e3, "20"),
    "places out of order": ("profiles/x", lambda values: values[::-1], "after"),
    "grains below the bed": ("profiles/thickness", lambda values: values - 1.0, "the value -1"),
    "no time step": ("steps/dt", lambda values: -values, "the value -0.0"),
    "runout that falls": ("series/runout", lambda values: values[::-1], "after"),
    "more than all grains": ("series/detached_volume", lambda values: values + 1.5, "1.5"),
    "energy below nothing": ("series/kinetic_energy", lambda values: -values - 1.0, "the value -"),
    "volume below nothing": ("series/relative_volume", lambda values: values - 2.0, "the value -2"),
    "static above the surface": (
        "profiles/static_height",
        lambda values: values + 1.0,
        "m above the surface",
    ),
    "field of another shape": ("fields/1/u", lambda values: values[1:], "float64 of shape"),
    "field of text": ("fields/0/pressure", lambda values: values.astype("S2"), "|S2 of shape"),
    "cells without size": ("fields/0.dx", lambda values: 0.0, "cells without size"),
    "field of no time": ("fields/1.time", lambda values: np.nan, "not finite"),
    "fields of one time": ("fields/1.time", lambda values: 0.0, "0"),
    "version of the future": (".format_version", lambda values: 99, "another version"),
    "not a truth value": (".complete", lambda values: 3, "no truth value"),
    "case of other bytes": (".case", lambda values: np.bytes_(b"law = \xbc"), "no text"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_result_that_is_none_is_refused_by_name(folder, name, capsys):
    path, change, found = CHANGES[name]
    values = None if "." in path else values_of(folder / "result.h5", path)
    put(folder / "result.h5", path, change(values))
    with pytest.raises(InputError) as caught:
        open_result(folder)
    assert caught.value.file.endswith("result.h5")
    assert caught.value.key == path.lstrip(".")
    assert found in caught.value.found
    assert main(["plot", str(folder)]) == 2
    assert capsys.readouterr().err == f"{caught.value}\n"


def test_a_field_that_is_not_finite_is_refused_when_it_is_read(folder):
    values = values_of(folder / "result.h5", "fields/1/u")
    values[0, 0] = np.nan
    put(folder / "result.h5", "fields/1/u", values)
    result = open_result(folder)
    result.field(0)
    with pytest.raises(InputError, match="fields/1/u: found a value that is not finite"):
        result.field(1)


def test_a_flipped_byte_in_the_stored_case_is_one_line(folder, capsys):
    """As HDF5 gives it: a text with a lone surrogate."""
    with h5py.File(folder / "result.h5", "r+") as file:
        data = file.attrs["case"].encode()
        del file.attrs["case"]
        spoilt = data.replace(b'"mu_I"', b'"mu_\xbc"')
        file.attrs.create("case", spoilt, dtype=h5py.string_dtype("utf-8"))
    with pytest.raises(InputError, match="case: found no text in UTF-8"):
        open_result(folder)
    assert main(["plot", str(folder)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


# -- links and storage ---------------------------------------------------------------------------------


@pytest.fixture
def secret(tmp_path):
    path = tmp_path / "secret.h5"
    with h5py.File(path, "w") as file:
        file["x"] = np.linspace(0.0, 1.0, 1000)
    return path


def with_external_link(file, name, secret):
    file[name] = h5py.ExternalLink(str(secret), "/x")


def with_soft_link(file, name, secret):
    file["elsewhere"] = h5py.ExternalLink(str(secret), "/x")
    file[name] = h5py.SoftLink("/elsewhere")


def with_external_storage(file, name, secret):
    storage = [(str(secret), 0, h5py.h5f.UNLIMITED)]
    file.create_dataset(name, shape=(10,), dtype="f8", external=storage)


def with_virtual_data(file, name, secret):
    layout = h5py.VirtualLayout(shape=(10,), dtype="f8")
    layout[:] = h5py.VirtualSource(str(secret), "x", shape=(1000,))[:10]
    file.create_virtual_dataset(name, layout)


def with_values_that_are_not_there(file, name, secret):
    file.create_dataset(name, shape=(10**12,), dtype="f8", chunks=(1000,))


def with_a_group_in_itself(file, name, secret):
    file[name] = file["profiles"]


LEADING_OUT = [
    with_external_link,
    with_soft_link,
    with_external_storage,
    with_virtual_data,
    with_values_that_are_not_there,
    with_a_group_in_itself,
]


@pytest.mark.parametrize("spoil", LEADING_OUT)
@pytest.mark.parametrize("name", ["profiles/x", "series/runout", "fields/0/u", "more"])
@pytest.mark.parametrize("which", ["result.h5", "checkpoint.h5"])
def test_nothing_leads_out_of_a_file(folder, secret, spoil, name, which):
    with h5py.File(folder / which, "r+") as file:
        if name in file:
            del file[name]
        spoil(file, name, secret)
    with pytest.raises(InputError) as caught:
        open_result(folder) if which == "result.h5" else read_checkpoint(folder / which)
    assert any(word in caught.value.found for word in ("link", "another file", "virtual", "bytes"))


def test_a_field_is_not_read_through_a_link(folder, secret):
    """The field is looked at again when it is read."""
    result = open_result(folder)
    with h5py.File(folder / "result.h5", "r+") as file:
        del file["fields/0"]
        file["fields/0"] = h5py.ExternalLink(str(secret), "/")
    with pytest.raises(InputError, match="fields/0: found a link"):
        result.field(0)


def test_a_pipe_is_no_result(tmp_path):
    import os

    os.mkfifo(tmp_path / "result.h5")
    with pytest.raises(InputError, match="a named pipe"):
        open_result(tmp_path / "result.h5")


# -- checkpoints -----------------------------------------------------------------------------------------

CHECKPOINTS = {
    "text for the velocity": ("state/u", lambda values: values.astype("S8")),
    "complex velocity": ("state/w", lambda values: values.astype(complex)),
    "velocity that is not finite": ("state/u", lambda values: values * np.nan),
    "surface that is not finite": ("state/level_set", lambda values: values + np.inf),
    "state of no cells": ("state/level_set", lambda values: values[:1]),
    "time that is not finite": ("state.time", lambda values: np.nan),
    "fraction of a step": ("state.step", lambda values: 1.5),
    "another step": ("state.step", lambda values: 1),
    "no grains": ("state.volume_0", lambda values: 0.0),
    "text for a scalar": ("state.dt", lambda values: "x"),
    "series that is not finite": ("series/runout", lambda values: values * np.nan),
    "what ParaView needs is text": (
        "paraview/0/coordinates",
        lambda values: values.astype("S4"),
    ),
    "field that is not finite": ("fields/0/pressure", lambda values: values * np.nan),
}


@pytest.mark.parametrize("name", CHECKPOINTS)
def test_a_checkpoint_that_is_none_is_not_used(folder, tmp_path, name, capsys):
    """The run starts from t = 0, says so, and ends as if nothing had been there."""
    whole = (folder / "result.h5").rename(tmp_path / "whole.h5")
    path, change = CHECKPOINTS[name]
    values = None if "." in path else values_of(folder / "checkpoint.h5", path)
    put(folder / "checkpoint.h5", path, change(values))
    output.run_case(CASE, folder, resume=True, quiet=True)
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "checkpoint not usable, the run starts from t = 0" in error
    assert path in error
    assert differences(whole, folder / "result.h5") == []


def test_a_checkpoint_in_single_precision_marches(folder):
    """The kernels take one type: what is read is that type, whatever the file holds."""
    values = values_of(folder / "checkpoint.h5", "state/u").astype("f4")
    put(folder / "checkpoint.h5", "state/u", values)
    assert read_checkpoint(folder / "checkpoint.h5").state.u.dtype == np.float64
