"""Every kind of input: how it is mutated, how it is read, and how what was accepted is judged."""

import json
from typing import NamedTuple

import numpy as np
import pytest
from blind_suite import keep_wedge, wedge
from fake_simulation import FakeSimulation

from fvcollapse import load_case, load_experiment, observe, open_result
from fvcollapse.blind import calibration, outcomes
from fvcollapse.blind import make as making
from fvcollapse.blind.answers import answer_of_verdict
from fvcollapse.blind.evidence_file import read_evidence
from fvcollapse.blind.score import score
from fvcollapse.blind.score_table import scores_text, table
from fvcollapse.blind.simple_rules import SIMPLE, simple_answer
from fvcollapse.case.case import case_from_text
from fvcollapse.diagnosis.report import read_report
from fvcollapse.diagnosis.report.sentences import answer as sentences
from fvcollapse.diagnosis.verdict import verdict
from fvcollapse.diagnosis.verdict_model import VerdictModel
from fvcollapse.errors import InputError
from fvcollapse.measure.digitised import (
    LENGTHS,
    Source,
    Units,
    missing_settings,
    read_pairs,
    write_experiment,
)
from fvcollapse.output import run as output
from fvcollapse.output.checkpoint import read_checkpoint
from fvcollapse.output.extract import extract_image
from fvcollapse.studies.cache import RunCache, cached_case
from fvcollapse.studies.sweep import all_points, parse_variation
from mutated import hdf5, oracle, seeds, text
from mutated.values import pick
from mutated.writers import in_copy, mutated_text


class Suite(NamedTuple):
    """`write(seed, rng, folder)` leaves a mutated input and returns what `read` takes.

    `read` returns a list of sentences: what was accepted and is impossible.
    """

    write: object
    read: object
    short: int  # inputs in the default suite
    long: int  # inputs in the slow suite


# -- cases ---------------------------------------------------------------------------------------


def write_case(seed, rng, folder):
    data = pick(rng, seeds.CASES).encode()
    (folder / "case.toml").write_bytes(text.mutated(data, rng, text.TOML))
    return folder / "case.toml"


def read_case(path):
    case = load_case(path)
    assert case_from_text(case.to_toml()) == case
    return list(oracle.impossible_case(case))


def write_override(seed, rng, folder):
    changed = text.mutated(pick(rng, seeds.OVERRIDES).encode(), rng, text.TOML)
    return changed.decode("utf-8", "surrogateescape")  # as Python decodes a command line


def read_override(override):
    found = list(oracle.impossible_case(case_from_text("", "case", [override])))
    name, values = parse_variation(override)
    for point in all_points(case_from_text(""), {name: values}):
        found += oracle.impossible_case(point.case)
        assert len(point.name.encode()) <= 255
    return found


# -- experiments ---------------------------------------------------------------------------------

write_experiment_folder = in_copy("experiment", {".toml": text.TOML, ".csv": text.CSV})


def read_experiment(folder):
    return list(oracle.impossible_experiment(load_experiment(folder)))


@mutated_text((*text.BYTES, *text.LINES, text.other_mark, text.other_cell, text.scaled_column))
def write_curve(seed):
    return [(f"{name}.csv", data.encode()) for name, data in seeds.CURVES.items()]


def read_digitised(path):
    found = list(oracle.impossible_pairs(read_pairs(path)))
    target = path.parent / "imported"
    for old in target.glob("*"):
        old.unlink()
    write_experiment([Source("front", path, None)], target, Units(pick(RNG, list(LENGTHS))))
    missing_settings(target)
    return found


RNG = np.random.default_rng(0)

# -- results -------------------------------------------------------------------------------------


def hdf5_writer(name):
    """A writer of a mutated HDF5 seed."""

    def write(seed, rng, folder):
        path = folder / f"{name}.h5"
        path.write_bytes(hdf5.mutated(getattr(seed, name), rng, seed.outside))
        return path

    return write


def read_result(path):
    result = open_result(path)
    found = list(oracle.impossible_result(result))
    result.summary_table()
    fields = [result.field(index) for index in range(len(result.field_times))]
    found += oracle.impossible_fields(fields)
    observe(result)
    extract_image(result)
    return found


def write_checkpoint(seed, rng, folder):
    place = seeds.fresh(folder, "run", seed.folder / "run")
    (place / "checkpoint.h5").write_bytes(hdf5.mutated(seed.checkpoint, rng, seed.outside))
    (place / "result.h5").unlink()
    return seed.case, place


def read_resumed(given):
    """A checkpoint that is accepted is one from which the run ends well; others are started anew."""
    case, place = given
    stored = read_checkpoint(place / "checkpoint.h5")
    found = list(oracle.impossible_state(stored.state))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "Simulation", FakeSimulation)
        try:
            result = output.run_case(case, place, resume=True, quiet=True)
        except InputError as error:  # a sound checkpoint, of a case that was flipped into another
            if case_from_text(stored.case_text) != case:
                raise
            return [*found, f"cannot be resumed: {error}"]
    return [*found, *oracle.impossible_result(result)]


def write_entry(seed, rng, folder):
    cache = RunCache(folder / "cache")
    place = cache.place(cached_case(seed.case))
    place.mkdir(parents=True, exist_ok=True)
    (place / "extract.h5").write_bytes(hdf5.mutated(seed.extract, rng, seed.outside))
    return cache, cached_case(seed.case)


def read_entry(given):
    cache, case = given
    result = cache.get(case)
    if result is None:
        raise InputError("cache", "entry", "unusable", "a whole entry")
    observe(result)
    return list(oracle.impossible_result(result))


# -- sealed cases --------------------------------------------------------------------------------


def write_sealed(seed, rng, folder):
    """The seal, the labels, the answers or the distances are mutated."""
    seeds.fresh(folder, "suite", seed.folder / "suite")
    paths = {"suite/SEAL.json": seed.seal, "suite.labels.json": seed.labels}
    for name in ("answers.json", "distances.json"):
        paths[name] = (seed.folder / name).read_bytes()
    name = pick(rng, list(paths))
    for path, data in paths.items():
        (folder / path).write_bytes(text.mutated(data, rng, text.JSON) if path == name else data)
    return folder


def read_sealed(folder):
    answers, others = folder / "answers.json", [folder / "answers.json"]
    labels, distances = folder / "suite.labels.json", folder / "distances.json"
    with pytest.MonkeyPatch.context() as patch:
        for module in (outcomes, calibration):
            patch.setattr(module, "SAMPLES", 20)  # of the bootstrap
        scores = score(folder / "suite", answers, labels, others, distances)
    table(scores)
    json.loads(scores_text(scores), parse_constant=float.fromhex)
    return list(oracle.impossible_scores(scores))


def write_begun(seed, rng, folder):
    """Labels of a suite that was begun."""
    place = folder / "begun"
    seeds.fresh(folder, "begun", seed.folder / "experiment")
    for path in place.iterdir():
        path.unlink()
    (folder / "begun.labels.json").write_bytes(text.mutated(seed.labels, rng, text.JSON))
    return folder


def read_begun(folder):
    """The suite is continued; nothing outside of its folder is touched."""
    before = outside(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(making, "keep_truth", keep_wedge)
        patch.setattr(making, "view_of", wedge)
        try:
            making.make(4, folder / "begun")
        finally:
            after = outside(folder)
    return [f"{path} written outside" for path in sorted(set(after) - set(before))]


def outside(folder):
    """Paths beside a suite that was begun and its labels."""
    paths = {path.relative_to(folder).as_posix() for path in folder.rglob("*")}
    paths |= {f"../{path.name}" for path in folder.parent.iterdir()}
    return [path for path in paths if not path.startswith("begun")]


# -- reports, evidence, verdict layer --------------------------------------------------------------


@mutated_text(text.JSON)
def write_report_file(seed):
    return [("report.json", (seed.folder / "report.json").read_bytes())]


def read_report_file(path):
    for sentence in sentences(read_report(path)):
        sentence.encode()
    return []


@mutated_text(text.JSON)
def write_evidence(seed):
    return [("evidence.json", (seed.folder / "evidence.json").read_bytes())]


def read_evidence_file(path):
    content, evidence = read_evidence(path)
    found = answer_of_verdict(content, verdict(evidence))
    for rule in SIMPLE.values():
        simple_answer(rule(content["simple"]), evidence)
    return list(oracle.impossible_scores(found["probability"]))


@mutated_text(text.JSON)
def write_model(seed):
    from fvcollapse.diagnosis.verdict_model import SHIPPED

    return [("verdict.json", SHIPPED.read_bytes())]


def read_model(path):
    VerdictModel.load(path)
    return []


SUITES = {
    "case": Suite(write_case, read_case, 40, 400),
    "override": Suite(write_override, read_override, 40, 300),
    "experiment": Suite(write_experiment_folder, read_experiment, 40, 500),
    "digitised": Suite(write_curve, read_digitised, 40, 300),
    "result": Suite(hdf5_writer("result"), read_result, 25, 500),
    "checkpoint": Suite(write_checkpoint, read_resumed, 12, 400),
    "cache": Suite(write_entry, read_entry, 16, 200),
    "sealed": Suite(write_sealed, read_sealed, 12, 400),
    "begun": Suite(write_begun, read_begun, 6, 200),
    "report": Suite(write_report_file, read_report_file, 12, 200),
    "evidence": Suite(write_evidence, read_evidence_file, 20, 100),
    "verdict": Suite(write_model, read_model, 10, 100),
}
