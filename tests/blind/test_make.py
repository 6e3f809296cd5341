"""Sealed cases: nothing shown tells the label, everything hidden is sealed, and a call can be continued."""

import json
import stat
from pathlib import Path

import numpy as np
import pytest
from blind_suite import CLASSES, keep_wedge, make_wedges

from fvcollapse.blind import make as making
from fvcollapse.blind.causes import BLIND
from fvcollapse.blind.generator import draw_label
from fvcollapse.blind.labels import Draw, draw_plan, read_labels
from fvcollapse.blind.make import make
from fvcollapse.blind.outside import UNKNOWNS
from fvcollapse.blind.seal import data_digest, label_digest
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.errors import InputError, NumericalError, OutputError
from fvcollapse.measure.experiment import load_experiment


def files(folder):
    return {path.relative_to(folder): path for path in folder.rglob("*") if path.is_file()}


def test_a_suite_is_folders_of_experiments_and_a_seal(tmp_path, monkeypatch):
    seal, _ = make_wedges(monkeypatch, tmp_path / "suite")
    assert seal == tmp_path / "suite" / "SEAL.json"
    plan = read_labels(tmp_path / "suite.labels.json")
    sealed = json.loads(seal.read_text())["cases"]
    assert [entry["label"]["cause"] for entry in plan["cases"].values()] == list(CLASSES)
    for name, entry in plan["cases"].items():
        folder = tmp_path / "suite" / name
        controls = entry["label"]["world"]["controls"]
        runs = {path.parent.relative_to(folder) for path in folder.rglob("experiment.toml")}
        expected = {Path(name) for name in entry["label"]["experiments"]}
        assert runs == expected | {Path("controls") / name for name in controls}
        for experiment in (folder / run for run in runs):
            curves = load_experiment(experiment).curves
            assert set(curves) == {"front", "profiles", "volume", "interface"}
        assert sealed[name] == {"label": label_digest(entry), "data": data_digest(folder)}
    assert not (tmp_path / "suite.labels.json.runs").exists()


def test_no_file_that_is_shown_tells_a_cause(tmp_path, monkeypatch):
    make_wedges(monkeypatch, tmp_path / "suite")
    shown = files(tmp_path / "suite")
    text = "".join(path.read_text() for path in shown.values())
    for word in (*CATALOGUE, *UNKNOWNS, "none", "unknown", "truth", "quantile", "cell_size"):
        if word not in ("gate", "tilt", "clock"):  # [gate] is a section of every experiment
            assert word not in text, word
    assert len({path.stat().st_mtime for path in shown.values()}) == 1
    settings = {}  # a laboratory states the same of all its experiments of a set-up, whatever it hides in them
    for name, entry in read_labels(tmp_path / "suite.labels.json")["cases"].items():
        for path in (tmp_path / "suite" / name).rglob("experiment.toml"):
            place = entry["label"]["world"]["name"], path.parent.name.removeprefix("control_")
            settings.setdefault(place, set()).add(path.read_text())
    assert all(len(texts) == 1 for texts in settings.values())


def test_controls_are_those_of_the_world_in_all_its_cases(tmp_path, monkeypatch):
    make_wedges(monkeypatch, tmp_path / "suite")
    controls = {}
    for name, entry in read_labels(tmp_path / "suite.labels.json")["cases"].items():
        for path in files(tmp_path / "suite" / name / "controls").values():
            place = entry["label"]["world"]["name"], path.parent.name, path.name
            controls.setdefault(place, []).append(path.read_bytes())
    assert max(len(texts) for texts in controls.values()) > 1
    assert all(len(set(texts)) == 1 for texts in controls.values())


def test_a_control_that_cannot_be_computed_is_another_world(tmp_path, monkeypatch):
    seal, _ = make_wedges(monkeypatch, tmp_path / "whole")
    first = read_labels(tmp_path / "whole.labels.json")["cases"]["case_001"]["label"]["world"]
    failed = []

    def fail(case_text, forces, path):
        if path.parent.name.startswith("world_") and not failed:
            failed.append(path)
            raise NumericalError("no pivot", time=0.1)
        keep_wedge(case_text, forces, path)

    monkeypatch.setattr(making, "keep_truth", fail)
    make(len(CLASSES), tmp_path / "suite", draw=Draw(classes=CLASSES, seed=1))
    entries = read_labels(tmp_path / "suite.labels.json")["cases"].values()
    of_first = [entry for entry in entries if entry["label"]["world"]["name"] == first["name"]]
    assert len(of_first) == 3
    assert all(entry["attempt"] == 1 for entry in of_first)
    assert len({json.dumps(entry["label"]["world"]) for entry in of_first}) == 1
    assert of_first[0]["label"]["world"] != first
    assert [entry["label"]["cause"] for entry in entries] == list(CLASSES)


def test_labels_are_private_and_salted(tmp_path, monkeypatch):
    make_wedges(monkeypatch, tmp_path / "suite")
    path = tmp_path / "suite.labels.json"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    entries = list(read_labels(path)["cases"].values())
    salts = {entry["salt"] for entry in entries}
    assert len(salts) == len(entries)
    assert all(len(bytes.fromhex(salt)) == 16 for salt in salts)
    entry = entries[0]
    assert label_digest(entry) != label_digest(entry | {"salt": entries[1]["salt"]})
    assert label_digest(entry) != label_digest(entry | {"seed": entry["seed"] + 1})


def test_two_suites_without_a_seed_differ():
    plans = [draw_plan(3, Draw())["cases"] for _ in range(2)]
    first, second = ([entry["label"] for entry in plan.values()] for plan in plans)
    assert first != second


def test_a_suite_can_be_continued(tmp_path, monkeypatch):
    seal, calls = make_wedges(monkeypatch, tmp_path / "whole")
    whole = {name: path.read_bytes() for name, path in files(tmp_path / "whole").items()}
    stop = len(calls) // 2

    with monkeypatch.context() as patch:
        count = []

        def keep(case_text, forces, path):
            count.append(path)
            if len(count) > stop:
                raise KeyboardInterrupt
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("0.3")

        patch.setattr(making, "keep_truth", keep)
        with pytest.raises(KeyboardInterrupt):
            make(len(CLASSES), tmp_path / "part", draw=Draw(classes=CLASSES, seed=1))
    assert not (tmp_path / "part" / "SEAL.json").exists()
    make_wedges(monkeypatch, tmp_path / "part")
    part = {name: path.read_bytes() for name, path in files(tmp_path / "part").items()}
    names = {name for name in whole if name.name != "SEAL.json"}
    assert {name: part[name] for name in names} == {name: whole[name] for name in names}


def test_a_finished_suite_is_left_alone(tmp_path, monkeypatch):
    seal, _ = make_wedges(monkeypatch, tmp_path / "suite")
    before = seal.read_bytes()
    again, calls = make_wedges(monkeypatch, tmp_path / "suite")
    assert again.read_bytes() == before
    assert not calls


def test_a_truth_that_cannot_be_computed_is_drawn_again_with_its_cause(tmp_path, monkeypatch):
    planned = draw_plan(len(CLASSES), Draw(classes=CLASSES, seed=1))["cases"]["case_001"]
    controls = len(planned["label"]["world"]["controls"])  # which are run first
    seal, calls = make_wedges(monkeypatch, tmp_path / "suite", failures=(controls,))
    plan = read_labels(tmp_path / "suite.labels.json")
    first = plan["cases"]["case_001"]
    assert first["attempt"] == 1
    assert first["label"] == draw_label("none", BLIND, first["seed"] + 1, first["label"]["world"])
    assert json.loads(seal.read_text())["cases"]["case_001"]["label"] == label_digest(first)
    with pytest.raises(NumericalError, match="no pivot"):
        make_wedges(monkeypatch, tmp_path / "never", failures=range(1000))


def test_bad_input_is_one_line(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="--cases: found 0; allowed: a number from 1"):
        make(0, tmp_path / "suite")
    with pytest.raises(InputError, match="--labels: .*outside"):
        make(1, tmp_path / "suite", tmp_path / "suite" / "labels.json")
    make_wedges(monkeypatch, tmp_path / "suite")
    with pytest.raises(InputError, match="--cases: found 5; allowed: 4"):
        make(5, tmp_path / "suite")
    with pytest.raises(InputError, match="contents without labels"):
        make(4, tmp_path / "suite", tmp_path / "other.json")
    (tmp_path / "broken.json").write_text("{")
    with pytest.raises(InputError, match="broken JSON"):
        make(4, tmp_path / "new", tmp_path / "broken.json")
    (tmp_path / "foreign.json").write_text('{"format": "another"}')
    with pytest.raises(InputError, match='format: found the string "another"'):
        make(4, tmp_path / "new", tmp_path / "foreign.json")
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        make(1, tmp_path / "file" / "suite")


@pytest.mark.slow
def test_a_real_suite_on_coarse_cells(tmp_path):
    draw = Draw(classes=["none", "lateral_friction"], seed=4, cells=(4.2, 4.6))
    make(2, tmp_path / "suite", draw=draw)
    for path in (tmp_path / "suite").glob("*/*/experiment.toml"):
        experiment = load_experiment(path.parent)
        front = experiment.curves["front"]
        cell = 0.14 / 4.2  # within which the front of a vertical face is read
        assert 0.18 < front.value[0] < 0.22 + cell
        assert front.value[-1] > 0.3
        height = experiment.curves["profiles"].value
        assert np.max(height) == pytest.approx(0.14, abs=0.012)
