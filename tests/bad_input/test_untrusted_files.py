"""Files that somebody else has made: results, checkpoints, labels, names; each fault is one line, and leads nowhere."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from blind_suite import CLASSES, make_wedges
from experiment_folder import write_experiment
from fake_simulation import FakeSimulation
from mutated.values import DEEP_LIST
from same_result import differences

from fvcollapse import load_experiment, open_result
from fvcollapse.__main__ import main
from fvcollapse.blind import forms, outside
from fvcollapse.blind.labels import LABELS_FORMAT
from fvcollapse.blind.make import make
from fvcollapse.blind.seal import SEAL_FORMAT, canonical, label_digest, seal_digest
from fvcollapse.case.case import Case, case_from_text, load_case
from fvcollapse.diagnosis import diagnose as diagnosis
from fvcollapse.errors import CaseError, InputError
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


# -- nesting, bytes --------------------------------------------------------------------------------------

NESTED = {
    "deep list": (f"geometry.polygon = {DEEP_LIST}", "geometry.polygon"),
    "deep list in an unknown key": (f"geometry.unknown = {DEEP_LIST}", "geometry.unknown"),
    "30 levels of a name": (".".join("a" * 30) + " = 1", "a.a"),
    "100 000 levels of a name": (".".join("a" * 100_000) + " = 1", "file"),
    "100 000 quoted levels": (".".join(['"a"'] * 100_000) + " = 1", "file"),
    "100 000 levels of a header": ("[" + " . ".join("a" * 100_000) + "]", "file"),
    "100 000 levels inside": ("x = {" + ".".join("a" * 100_000) + " = 1}", "file"),
    "deep table": ("time = " + "{a = " * 300 + "1" + "}" * 300, "time"),
}


@pytest.mark.parametrize("name", NESTED)
def test_deep_nesting_is_one_line(tmp_path, capsys, name):
    text, key = NESTED[name]
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(CaseError, match="levels|parts|broken TOML") as caught:
        load_case(path)
    assert caught.value.key.startswith((key, "file"))
    assert main(["run", str(path), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == f"{caught.value}\n"
    experiment = write_experiment(tmp_path / "experiment")
    (experiment / "experiment.toml").write_text(text)
    with pytest.raises(InputError, match="levels|parts|broken TOML"):
        load_experiment(experiment)


@pytest.mark.parametrize("key", ["geometry.polygon", "geometry", "no.key", "time.end"])
@pytest.mark.parametrize("value", [DEEP_LIST, "{" + ".".join("a" * 60_000) + " = 1}"])
def test_deep_nesting_in_an_override(key, value):
    with pytest.raises(CaseError) as caught:
        case_from_text("", "case", [f"{key}={value}"])
    assert caught.value.exit_status == 2


@pytest.mark.parametrize("option", ["run", "sweep", "import"])
def test_a_byte_that_is_no_text_on_the_command_line(tmp_path, option):
    """As the system hands it over, to a new process."""
    (tmp_path / "case.toml").write_text("")
    (tmp_path / "curve.csv").write_text("0,1\n1,2\n")
    arguments = {
        "run": [b"run", b"case.toml", b"--set", b"rheology.law=mu_\xff"],
        "sweep": [
            b"sweep",
            b"case.toml",
            b"--out",
            b"out",
            b"--vary",
            b"rheology.law=mu_\xff,mu_I",
        ],
        "import": [b"import-curves", b"--front", b"curve.csv", b"--out", b"out"]
        + [b"--set", b"title=caf\xe9"],
    }
    command = [sys.executable.encode(), b"-m", b"fvcollapse", *arguments[option]]
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, check=False, env={"PYTHONPATH": str(root)}
    )
    assert done.returncode == 2, done.stderr
    assert done.stderr.count(b"\n") == 1
    assert b"UTF-8" in done.stderr


# -- names -----------------------------------------------------------------------------------------------

NAMES = {
    "long": "e" * 240,
    "long in UTF-8": "é" * 40,
    "no text": b"caf\xe9",
    "line break": "a\nb",
    "escape": "a\x1b[31mb",
}


@pytest.mark.parametrize("name", NAMES)
def test_names_of_experiments_are_refused_before_any_run(tmp_path, monkeypatch, capsys, name):
    monkeypatch.setattr(diagnosis, "analyse", lambda *_, **__: pytest.fail("computed"))
    word = NAMES[name]
    folder = tmp_path / (word if isinstance(word, str) else word.decode("utf-8", "surrogateescape"))
    write_experiment(folder)
    with pytest.raises(InputError, match="folder: found (a|the) name"):
        load_experiment(folder)
    assert main(["diagnose", str(folder), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_longest_name_of_an_experiment(tmp_path):
    assert load_experiment(write_experiment(tmp_path / ("e" * 200))).name == "e" * 200


# -- sealed cases ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sealed")
    with pytest.MonkeyPatch.context() as patch:
        make_wedges(patch, folder / "suite")
    return folder


@pytest.mark.parametrize("name", ["../victim", "/victim", "case_1/../../victim", "case_", "case_①"])
def test_names_of_cases_cannot_leave_the_folder(tmp_path, monkeypatch, capsys, name):
    (tmp_path / "victim").mkdir()
    label = {"cause": "none", "unknown_kind": None, "effects": {}, "experiments": {}}
    entry = {"salt": "00" * 16, "seed": 1, "attempt": 0, "label": label}
    plan = {"format": LABELS_FORMAT, "format_version": 1, "solver": "x", "cases": {name: entry}}
    (tmp_path / "cases.labels.json").write_text(json.dumps(plan))
    hashes = {name: {"label": label_digest(entry), "data": "0" * 64}}
    seal = {"format": SEAL_FORMAT, "cases": hashes, "seal": seal_digest(hashes)}
    with pytest.raises(InputError, match="case_<digits>"):
        make(1, tmp_path / "cases")
    assert list((tmp_path / "cases").iterdir()) == []
    (tmp_path / "cases" / "SEAL.json").write_text(json.dumps(seal))
    (tmp_path / "answers.json").write_text("{}")
    command = ["blind", "score", str(tmp_path / "cases"), str(tmp_path / "answers.json")]
    assert main([*command, "--labels", str(tmp_path / "cases.labels.json")]) == 2
    assert "case_<digits>" in capsys.readouterr().err
    assert list((tmp_path / "victim").iterdir()) == []


def change_label(**keys):
    return lambda entry: entry["label"].update(keys)


def change_run(**keys):
    return lambda entry: next(iter(entry["label"]["experiments"].values())).update(keys)


LABELS = {
    "experiment outside": (
        lambda entry: entry["label"]["experiments"].update({"../../x": {}}),
        "experiments",
    ),
    "no experiment": (change_label(experiments={}), "experiments"),
    "short salt": (lambda entry: entry.update(salt="00"), "salt"),
    "salt that is no number": (lambda entry: entry.update(salt="z" * 32), "salt"),
    "negative seed": (lambda entry: entry.update(seed=-1), "seed"),
    "no label": (lambda entry: entry.update(label=None), "label"),
    "unknown cause": (change_label(cause="magic"), "cause"),
    "kind of no unknown": (change_label(unknown_kind="clock"), "unknown_kind"),
    "unknown effect": (
        change_label(effects={"magic": {"closure": 0, "section": {}, "quantiles": {}}}),
        "effects",
    ),
    "unknown closure": (
        change_label(effects={"gate": {"closure": 9, "section": {}, "quantiles": {}}}),
        "closure",
    ),
    "case that is none": (change_run(case="geometry.height_0 = -1"), "height_0"),
    "unknown force": (change_run(forces=[{"kind": "magic"}]), "kind"),
    "force without its number": (change_run(forces=[{"kind": "linear_drag"}]), "forces"),
    "unknown reading": (change_run(readings=[{"kind": "magic"}]), "kind"),
    "noise that is text": (change_run(noise="loud"), "noise"),
}


@pytest.mark.parametrize("name", LABELS)
def test_labels_are_refused_before_any_run(sealed, tmp_path, name):
    plan = json.loads((sealed / "suite.labels.json").read_text())
    change, key = LABELS[name]
    change(plan["cases"]["case_001"])
    labels = tmp_path / "labels.json"
    labels.write_text(json.dumps(plan))
    with pytest.raises(InputError) as caught:
        make(len(CLASSES), tmp_path / "suite", labels)
    assert "case_001" in f"{caught.value.file} {caught.value.key}"
    assert key in caught.value.key
    assert not list(tmp_path.glob("*.runs"))


def test_forms_know_every_force_and_every_wrong_reading():
    known = {
        form.__struct_config__.tag
        for form in forms.Run.__annotations__["forces"].__args__[0].__args__
    }
    assert known == set(outside.FORCES)
    known = {
        form.__struct_config__.tag
        for form in forms.Run.__annotations__["readings"].__args__[0].__args__
    }
    assert known == set(outside.READINGS)


JSONS = {
    "NaN": '{"format": NaN}',
    "infinity": '{"format": -Infinity}',
    "number beyond a float": '{"format": 1e999}',
    "name twice": '{"format": 1, "format": 2}',
    "deep": '{"format": ' + "[" * 300 + "]" * 300 + "}",
    "deeper than any parser": '{"format": ' + "[" * 100000,
    "lone surrogate": '{"format": "\\ud800"}',
    "lone surrogate in a name": '{"\\ud800": 1}',
    "list": "[]",
    "integer of thousands of digits": '{"format": ' + "9" * 5000 + "}",
}


@pytest.mark.parametrize("name", JSONS)
def test_json_that_no_later_step_can_take_is_one_line(sealed, tmp_path, name, capsys):
    (tmp_path / "bad.json").write_text(JSONS[name])
    bad, labels = str(tmp_path / "bad.json"), str(sealed / "suite.labels.json")
    for answers, truth in ((bad, labels), (bad, bad)):
        command = ["blind", "score", str(sealed / "suite"), answers, "--labels", truth]
        assert main(command) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert "bad.json" in error


def test_canonical_text_takes_what_was_read(sealed):
    plan = json.loads((sealed / "suite.labels.json").read_text())
    assert canonical(plan)
