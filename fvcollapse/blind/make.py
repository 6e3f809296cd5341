"""Sealed cases: experiment folders whose cause is known to nobody until the seal is opened.

The labels are drawn first and kept outside the folder of the cases; the truths are run beside them; at
the end the folder gets `SEAL.json`: for every case a hash of its salted label and one of its data. An
interrupted call is continued by the same one.
"""

import hashlib
import json
import os
import shutil
from pathlib import Path

import numpy as np

from fvcollapse.blind.forms import label_problems, read_form, refuse_names
from fvcollapse.blind.generator import (
    BLIND,
    ERRORS,
    SET_UPS,
    draw_classes,
    draw_label,
    settings_text,
)
from fvcollapse.blind.measurement import film
from fvcollapse.blind.truth import keep_truth, view_of
from fvcollapse.case.case import case_from_text
from fvcollapse.errors import FvcollapseError, InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import SETTINGS
from fvcollapse.output.fingerprint import solver_version
from fvcollapse.studies.workers import refuse_workers, run_all

LABELS_FORMAT, SEAL_FORMAT = "fvcollapse-labels", "fvcollapse-seal"
FORMAT_VERSION = 1
SEAL = "SEAL.json"
CASES_MAX = 100_000
REDRAWS = 5  # of a case whose truth cannot be computed
MOMENT = 946_684_800  # s; modification time of every file: 1 January 2000


def make(
    count,
    folder,
    labels=None,
    style=BLIND,
    classes=None,
    seed=None,
    cells=None,
    workers=1,
    scheduler=None,
    quiet=True,
):
    """Make sealed cases, or continue to.

    Parameters
    ----------
    count : int
        Number of cases.
    folder : str or Path
        Gets one folder per case, with one experiment folder per run inside, and the seal.
    labels : str or Path, optional
        File of the labels, outside `folder`; default `<folder>.labels.json`.
    style : Style
    classes : sequence of str, optional
        Cause of each case; default `draw_classes`.
    seed : int, optional
        For a suite that anybody can make again; default: entropy of the system.
    cells : (float, float), optional
        Range of the number of cells in the height, instead of that of the style.
    workers, scheduler, quiet
        See `workers.run_all`.

    Returns
    -------
    Path
        Of the seal.

    Raises
    ------
    InputError, OutputError
        Before anything is run.
    NumericalError
        A truth cannot be computed, whatever is drawn.
    """
    refuse_workers(workers)
    folder, labels = places(folder, labels)
    if not 1 <= count <= CASES_MAX:
        raise InputError("command line", "--cases", f"{count}", f"a number from 1 to {CASES_MAX}")
    plan = begun_plan(count, folder, labels)
    if plan is None:
        plan = draw_plan(count, style, classes, seed, cells)
        write_labels(labels, plan)
    if (folder / SEAL).exists():
        return folder / SEAL
    work = make_folder(labels.with_name(f"{labels.name}.runs"), mode=0o700)  # it tells the causes
    run_truths(plan, labels, style, cells, work, workers, scheduler, quiet)
    for name, entry in plan["cases"].items():
        write_case(folder / name, entry["label"], work / run_name(name, entry))
    write_atomic(folder / SEAL, seal_text(plan, folder).encode())
    os.utime(folder / SEAL, (MOMENT, MOMENT))
    shutil.rmtree(work)
    return folder / SEAL


def places(folder, labels):
    """(folder, labels) as absolute paths; labels inside the folder are refused."""
    folder = Path(os.path.abspath(folder))
    if not folder.name:
        raise InputError("command line", "--out", str(folder), "a folder with a name")
    labels = Path(labels).absolute() if labels else folder.with_name(f"{folder.name}.labels.json")
    if Path(os.path.realpath(labels)).is_relative_to(os.path.realpath(folder)):
        allowed = f"a file outside {folder}, which is what is shown"
        raise InputError("command line", "--labels", str(labels), allowed)
    make_folder(folder, SEAL)
    make_folder(labels.parent, labels.name)
    return folder, labels


# -- labels ------------------------------------------------------------------------------------------------


def begun_plan(count, folder, labels):
    """The plan in a file of labels that was begun for this folder, else None.

    Raises
    ------
    InputError
        It is of another suite, or the folder has contents and no labels.
    """
    if labels.exists():
        plan = read_labels(labels)
        if len(plan["cases"]) != count:
            allowed = f"{len(plan['cases'])}, as in {labels}, or other labels"
            raise InputError("command line", "--cases", f"{count}", allowed)
        refuse_bad_cases(labels, plan)
        return plan
    if any(folder.iterdir()):
        raise InputError(folder, "folder", "contents without labels", "an empty or new folder")
    return None


def draw_plan(count, style, classes, seed, cells):
    """All labels: {"cases": {name: {"salt", "seed", "attempt", "label"}}} and the solver."""
    draws = np.random.default_rng(seed)  # without a seed: entropy of the system
    classes = draw_classes(count, draws) if classes is None else list(classes)
    digits = max(3, len(str(count)))
    cases = {}
    for number, cause in enumerate(classes, start=1):
        entry = {"salt": os.urandom(16).hex(), "seed": int(draws.integers(2**63)), "attempt": 0}
        cases[f"case_{number:0{digits}d}"] = entry | {"label": label_of(cause, style, entry, cells)}
    about = {"format": LABELS_FORMAT, "format_version": FORMAT_VERSION}
    return about | {"solver": solver_version(), "cases": cases}


def label_of(cause, style, entry, cells):
    """The label of an entry; another attempt is another draw."""
    return draw_label(cause, style, entry["seed"] + entry["attempt"], cells)


def write_labels(path, plan):
    """Write the labels, readable to their owner only from the first byte on."""
    text = json.dumps(plan, indent=1) + "\n"
    write_atomic(path, text.encode(), running=False, private=True)


def read_labels(path):
    """The labels in a file.

    Raises
    ------
    InputError
    """
    plan = read_form(path, LABELS_FORMAT)
    refuse_names(path, plan["cases"])
    for name, entry in plan["cases"].items():
        for key, found, allowed in label_problems(entry):
            raise InputError(path, f"cases.{name}.{key}", found, allowed)
    return plan


def refuse_bad_cases(path, plan):
    """Refuse labels without a truth, or with one that is no case, before any of them is run."""
    for name, entry in plan["cases"].items():
        if not entry["label"]["experiments"]:
            key = f"cases.{name}.label.experiments"
            raise InputError(path, key, "no experiment", "one or more")
        for run, each in entry["label"]["experiments"].items():
            case_from_text(each["case"], f"{path}: cases.{name}.label.experiments.{run}.case")


# -- the seal ----------------------------------------------------------------------------------------------


def canonical(value):
    """The one JSON text of a value, as bytes."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def label_digest(entry):
    """Hash of an entry behind its salt: whoever knows all labels but the salt learns nothing from it."""
    rest = {key: value for key, value in entry.items() if key != "salt"}
    return hashlib.sha256(bytes.fromhex(entry["salt"]) + canonical(rest)).hexdigest()


def data_digest(folder):
    """Hash of the names and contents of all files of a case."""
    digest = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        digest.update(f"{path.relative_to(folder).as_posix()} {content}\n".encode())
    return digest.hexdigest()


def seal_text(plan, folder):
    """Text of `SEAL.json`."""
    cases = {
        name: {"label": label_digest(entry), "data": data_digest(folder / name)}
        for name, entry in plan["cases"].items()
    }
    about = {"format": SEAL_FORMAT, "format_version": FORMAT_VERSION}
    overall = hashlib.sha256(canonical(cases)).hexdigest()
    return json.dumps(about | {"seal": overall, "cases": cases}, indent=1) + "\n"


# -- the cases ---------------------------------------------------------------------------------------------


def run_name(name, entry):
    """Folder of the truths of one draw of a case."""
    return f"{name}_{entry['attempt']}"


def run_truths(plan, labels, style, cells, work, workers, scheduler, quiet):
    """Run all truths; a case that cannot be computed is drawn again with the same cause."""
    todo = set(plan["cases"])
    while todo:
        failed = compute(plan, todo, work, workers, scheduler, quiet)
        for name, error in failed.items():
            entry = plan["cases"][name]
            entry["attempt"] += 1
            if entry["attempt"] > REDRAWS:
                raise error
            entry["label"] = label_of(entry["label"]["cause"], style, entry, cells)
        write_labels(labels, plan)
        todo = set(failed)


def compute(plan, names, work, workers, scheduler, quiet):
    """Run the truths of some cases; return {case: NumericalError} of those that failed."""
    calls, failed = {}, {}
    for name in sorted(names):
        entry = plan["cases"][name]
        for run, each in entry["label"]["experiments"].items():
            path = work / run_name(name, entry) / f"{run}.h5"
            calls[name, run] = (each["case"], each["forces"], path)

    def finished(call, outcome):
        if isinstance(outcome, NumericalError):
            failed[call[0]] = outcome
        elif isinstance(outcome, FvcollapseError):
            raise outcome

    run_all(keep_truth, calls, finished, workers, scheduler, quiet)
    return failed


def write_case(folder, label, truths):
    """Write the experiment folders of a case, all files with the same date."""
    for name, each in label["experiments"].items():
        set_up, case = SET_UPS[name], case_from_text(each["case"])
        view = view_of(truths / f"{name}.h5", case, each)
        rng = np.random.default_rng(each["noise"])
        texts = film(view, set_up.end, set_up.reach, ERRORS, rng)
        (folder / name).mkdir(parents=True, exist_ok=True)
        for file, text in ({SETTINGS: settings_text(name)} | texts).items():
            write_atomic(folder / name / file, text.encode())
            os.utime(folder / name / file, (MOMENT, MOMENT))
        os.utime(folder / name, (MOMENT, MOMENT))
    os.utime(folder, (MOMENT, MOMENT))
