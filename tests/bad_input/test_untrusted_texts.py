"""Texts from elsewhere: nesting, bytes, names, labels and JSON that no later step can take."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from blind_suite import CLASSES, make_wedges
from experiment_folder import write_experiment
from mutated.values import DEEP_LIST

from fvcollapse import load_experiment
from fvcollapse.__main__ import main
from fvcollapse.blind import outside, run_forms
from fvcollapse.blind.labels import LABELS_FORMAT
from fvcollapse.blind.make import make
from fvcollapse.blind.seal import SEAL_FORMAT, canonical, label_digest, seal_digest
from fvcollapse.case.case import case_from_text, load_case
from fvcollapse.diagnosis import diagnose as diagnosis
from fvcollapse.errors import CaseError, InputError

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
        for form in run_forms.Run.__annotations__["forces"].__args__[0].__args__
    }
    assert known == set(outside.FORCES)
    known = {
        form.__struct_config__.tag
        for form in run_forms.Run.__annotations__["readings"].__args__[0].__args__
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
