"""The labels of a suite: the hidden cause of every case, with the salt of its hash.

They are kept in one file outside the folder of the cases, readable to their owner only.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse.blind.causes import BLIND, Style, dealt, draw_classes
from fvcollapse.blind.forms import label_problems, read_form, refuse_names
from fvcollapse.blind.generator import draw_fitting_label, drawn_world
from fvcollapse.blind.plain_values import Entry, Plan
from fvcollapse.blind.worlds import world_seeds
from fvcollapse.case.case import case_from_text
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.fingerprint import solver_version

LABELS_FORMAT = "fvcollapse-labels"
FORMAT_VERSION = 3


class Draw(NamedTuple):
    """What the labels of a suite are drawn from.

    Attributes
    ----------
    style : Style
    classes : sequence of str or None
        Cause of each case; None: `draw_classes`.
    seed : int or None
        For a suite that anybody can make again; None: entropy of the system.
    cells : (float, float) or None
        Range of the number of cells in the height, instead of that of the style.
    per_world : int
        Cases of a world; the last may have fewer.
    """

    style: Style = BLIND
    classes: Sequence[str] | None = None
    seed: int | None = None
    cells: tuple[float, float] | None = None
    per_world: int = 3


def begun_plan(count: int, folder: Path, labels: Path) -> Plan | None:
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


def draw_plan(count: int, draw: Draw) -> Plan:
    """All labels: {"cases": {name: {"salt", "seed", "world_seed", "attempt", "label"}}} and the solver."""
    draws = np.random.default_rng(draw.seed)  # without a seed: entropy of the system
    classes = draw_classes(count, draws) if draw.classes is None else list(draw.classes)
    seeds = world_seeds(-(-count // draw.per_world), draws)
    worlds = {name: drawn_world(name, draw.style, seed, draw.cells) for name, seed in seeds.items()}
    own = [name for name in worlds for _ in range(draw.per_world)][:count]
    classes = dealt(classes, [worlds[name]["effects"] for name in own])
    digits = max(3, len(str(count)))
    cases: dict[str, Entry] = {}
    for number, (cause, name) in enumerate(zip(classes, own, strict=True), start=1):
        seed = int(draws.integers(2**63))
        cases[f"case_{number:0{digits}d}"] = {
            "salt": os.urandom(16).hex(),
            "seed": seed,
            "world_seed": seeds[name],
            "attempt": 0,
            "label": draw_fitting_label(cause, draw.style, seed, worlds[name]),
        }
    return {
        "format": LABELS_FORMAT,
        "format_version": FORMAT_VERSION,
        "solver": solver_version(),
        "cases": cases,
    }


def draw_again(entry: Entry, draw: Draw) -> None:
    """Draw the label of an entry again in the same world, with the same cause if it fits."""
    entry["attempt"] += 1
    label = entry["label"]
    seed = entry["seed"] + entry["attempt"]
    entry["label"] = draw_fitting_label(label["cause"], draw.style, seed, label["world"])


def draw_world_again(plan: Plan, name: str, draw: Draw) -> None:
    """Draw a world again, and with it the labels of its cases; causes that it now has itself stay as they are."""
    entries = [entry for entry in plan["cases"].values() if entry["label"]["world"]["name"] == name]
    hidden = {effect for entry in entries for effect in entry["label"]["effects"]}
    for entry in entries:
        entry["attempt"] += 1
    seed = entries[0]["world_seed"] + max(entry["attempt"] for entry in entries)
    world = drawn_world(name, draw.style, seed, draw.cells)
    while hidden & set(world["effects"]):
        seed += 1
        world = drawn_world(name, draw.style, seed, draw.cells)
    for entry in entries:
        seed = entry["seed"] + entry["attempt"]
        entry["label"] = draw_fitting_label(entry["label"]["cause"], draw.style, seed, world)


def write_labels(path: str | Path, plan: Plan) -> None:
    """Write the labels, readable to their owner only from the first byte on."""
    text = json.dumps(plan, indent=1) + "\n"
    write_atomic(path, text.encode(), running=False, private=True)


def read_labels(path: str | Path) -> Plan:
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


def refuse_bad_cases(path: str | Path, plan: Plan) -> None:
    """Refuse labels without a truth, or with one that is no case, before any of them is run."""
    for name, entry in plan["cases"].items():
        if not entry["label"]["experiments"]:
            key = f"cases.{name}.label.experiments"
            raise InputError(path, key, "no experiment", "one or more")
        places = {"experiments": entry["label"]["experiments"]}
        places["world.controls"] = entry["label"]["world"]["controls"]
        for place, runs in places.items():
            for run, experiment in runs.items():
                texts = {"case": experiment["case"]}
                if "without" in experiment:
                    texts["without"] = experiment["without"]
                for part, text in texts.items():
                    key = f"cases.{name}.label.{place}.{run}.{part}"
                    case_from_text(text, f"{path}: {key}")
