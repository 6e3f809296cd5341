"""Sealed cases: experiment folders whose cause nobody knows until the seal is opened.

The labels are drawn first and kept outside the folder of the cases; the truths are run beside them; at
the end the folder gets `SEAL.json`. An interrupted call is continued by the same call.
"""

import hashlib
import os
import shutil
from pathlib import Path

import numpy as np

from fvcollapse.blind.case_evidence import CONTROLS
from fvcollapse.blind.labels import (
    Draw,
    begun_plan,
    draw_again,
    draw_plan,
    draw_world_again,
    write_labels,
)
from fvcollapse.blind.measurement import film
from fvcollapse.blind.other_closure import reformed
from fvcollapse.blind.plain_values import Entry, Force, Plan, Run, World
from fvcollapse.blind.seal import SEAL, canonical, refuse_count, seal_text
from fvcollapse.blind.set_ups import SetUp, errors_of, set_up_of, settings_text
from fvcollapse.blind.truth import View, keep_truth, view_of
from fvcollapse.case.case import case_from_text
from fvcollapse.errors import FvcollapseError, InputError, NumericalError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import SETTINGS
from fvcollapse.studies.workers import HERE, Resources, refuse_workers, run_all

REDRAWS = 5  # of a case whose truth cannot be computed
WITHOUT = ".without"  # end of the names of truths without the hidden effects
MOMENT = 946_684_800  # s; modification time of every file: 1 January 2000


def make(
    count: int,
    folder: str | Path,
    labels: str | Path | None = None,
    draw: Draw = Draw(),  # noqa: B008 (immutable)
    resources: Resources = HERE,
) -> Path:
    """Make sealed cases, or continue to.

    Parameters
    ----------
    count : int
        Number of cases.
    folder : str or Path
        Gets one folder per case, with one experiment folder per run inside, and the seal.
    labels : str or Path, optional
        File of the labels, outside `folder`; default `<folder>.labels.json`.
    draw : Draw
        What the labels are drawn from.
    resources : Resources
        Where the truths are run.

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
    refuse_workers(resources.workers)
    folder, labels = places(folder, labels)
    refuse_count(count)
    plan = begun_plan(count, folder, labels)
    if plan is None:
        plan = draw_plan(count, draw)
        write_labels(labels, plan)
    if (folder / SEAL).exists():
        return folder / SEAL
    work = make_folder(work_folder(labels), mode=0o700)  # it shows the causes
    run_truths(plan, labels, draw, work, resources)
    for name, entry in plan["cases"].items():
        write_case(folder / name, entry, work / run_name(name, entry), work)
    write_atomic(folder / SEAL, seal_text(plan, folder).encode())
    os.utime(folder / SEAL, (MOMENT, MOMENT))
    shutil.rmtree(work)
    return folder / SEAL


def places(folder: str | Path, labels: str | Path | None) -> tuple[Path, Path]:
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


def work_folder(labels: Path) -> Path:
    """Folder of the truths beside a file of labels, until the suite is finished."""
    return labels.with_name(f"{labels.name}.runs")


def run_name(name: str, entry: Entry) -> str:
    """Folder of the truths of one draw of a case."""
    return f"{name}_{entry['attempt']}"


def world_name(entry: Entry) -> str:
    """Folder of the truths of the controls of one draw of a world."""
    world = entry["label"]["world"]
    return f"{world['name']}_{digest_of(world)}"


def digest_of(world: World) -> str:
    """A short name of what a world is."""
    return hashlib.sha256(canonical(world)).hexdigest()[:12]


def run_truths(plan: Plan, labels: Path, draw: Draw, work: Path, resources: Resources) -> None:
    """Run all truths; a case, or a world, that cannot be computed is drawn again with the same causes."""
    while True:
        failed = compute(plan, work, resources)
        if not failed:
            return
        for name, error in failed.items():
            if name in plan["cases"]:
                draw_again(plan["cases"][name], draw)
            else:
                draw_world_again(plan, name, draw)
            if max(entry["attempt"] for entry in plan["cases"].values()) > REDRAWS:
                raise error
        write_labels(labels, plan)


def compute(plan: Plan, work: Path, resources: Resources) -> dict[str, NumericalError]:
    """Run the truths that are not there; return {case or world: NumericalError} of those that failed."""
    calls, failed = truths_of(plan, work), {}

    def finished(call: tuple[str, str, str], outcome: FvcollapseError | None) -> None:
        if isinstance(outcome, NumericalError):
            failed[call[0]] = outcome
        elif isinstance(outcome, FvcollapseError):
            raise outcome

    run_all(keep_truth, calls, finished, *resources)
    return failed


def truths_of(plan: Plan, work: Path) -> dict[tuple[str, str, str], tuple[str, list[Force], Path]]:
    """{(case or world, folder, name): arguments of `keep_truth`} of all truths of a plan, below a folder."""
    calls = {}
    for name, entry in sorted(plan["cases"].items()):
        world = entry["label"]["world"]
        places = {
            (world["name"], world_name(entry)): world["controls"],
            (name, run_name(name, entry)): entry["label"]["experiments"],
        }
        for (owner, place), runs in places.items():
            for run, experiment in runs.items():
                for truth, text in texts_of(run, experiment).items():
                    path = work / place / f"{truth}.h5"
                    calls[owner, place, truth] = (text, experiment["forces"], path)
    return calls


def texts_of(name: str, run: Run) -> dict[str, str]:
    """{name of a truth: TOML text} of what a run needs: its truth, and the one without its effects."""
    texts = {name: run["case"]}
    return texts | {name + WITHOUT: run["without"]} if "without" in run else texts


def seen_of(name: str, run: Run, truths: Path) -> View:
    """What is seen of a run whose truths are in a folder, without noise."""
    case = case_from_text(run["case"])
    view = view_of(truths / f"{name}.h5", case, run)
    if "without" not in run:
        return view
    plain = view_of(truths / f"{name}{WITHOUT}.h5", case_from_text(run["without"]), run)
    return reformed(view, plain, run["form"], case.front.thickness)


def write_case(folder: Path, entry: Entry, truths: Path, work: Path) -> None:
    """Write the experiments of a case and the controls of its laboratory, all files with the same date."""
    label = entry["label"]
    world = label["world"]
    for name, experiment in label["experiments"].items():
        write_experiment(folder / name, experiment, world, truths)
    for name, experiment in world["controls"].items():
        write_experiment(folder / CONTROLS / name, experiment, world, work / world_name(entry))
    os.utime(folder / CONTROLS, (MOMENT, MOMENT))
    os.utime(folder, (MOMENT, MOMENT))


def write_experiment(
    folder: Path, experiment: Run, world: World, truths: Path, set_up: SetUp | None = None
) -> None:
    """Write the folder of one experiment, whose name is that of its set-up unless one is given."""
    name, common = folder.name, world["common"]
    set_up = set_up or set_up_of(name)
    view = seen_of(name, experiment, truths)
    rng = np.random.default_rng(experiment["noise"])
    errors = errors_of(set_up, world["statement"], world["quality"])
    camera: dict[str, float] = {
        key: common[key] for key in ("time", "offset", "scale") if key in common
    }
    texts = film(view, set_up.end, set_up.reach, errors, rng, camera)
    texts[SETTINGS] = settings_text(set_up, world["statement"], world["quality"])
    folder.mkdir(parents=True, exist_ok=True)
    for file, text in texts.items():
        write_atomic(folder / file, text.encode())
        os.utime(folder / file, (MOMENT, MOMENT))
    os.utime(folder, (MOMENT, MOMENT))
