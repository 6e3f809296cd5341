"""The sealed laboratory measures what it is asked for: the next experiment of a case, with the hidden cause in it.

Only this step opens the labels, and all that it hands out is folders of experiments, as `make` does. The world is that
of the case, with its hidden physics and measuring errors; a hidden cause stays what it is in every set-up. A gate that
is said to be removed at once still has the hidden defect of a gate.
"""

import json
import shutil
import zlib
from collections.abc import Mapping
from pathlib import Path

from fvcollapse.blind.generator import draw_added
from fvcollapse.blind.labels import read_labels
from fvcollapse.blind.make import WITHOUT, texts_of, write_experiment
from fvcollapse.blind.next_plan import first_experiment
from fvcollapse.blind.plain_values import Entry, Run
from fvcollapse.blind.seal import check_seal
from fvcollapse.blind.set_ups import SetUp, set_up_of, varied
from fvcollapse.blind.truth import keep_truth
from fvcollapse.errors import FvcollapseError, NumericalError
from fvcollapse.files.targets import make_folder
from fvcollapse.measure.experiment import SETTINGS
from fvcollapse.studies.workers import HERE, Resources, run_all

Call = tuple[str, str]  # case and candidate


def film_next(
    folder: Path, labels: Path, plans: Path, out: Path, resources: Resources = HERE
) -> dict[Call, NumericalError]:
    """Write `<case>/<candidate>` below a folder for every candidate of every plan; what is there stays.

    Parameters
    ----------
    folder : Path
        Sealed cases, as `make` leaves them.
    labels : Path
        Their labels, which must be the sealed ones.
    plans : Path
        Folder of `next_plan.keep_plans`.
    out : Path
        Gets the experiments.
    resources : Resources
        Where the truths are run.

    Returns
    -------
    dict
        (case, candidate) -> NumericalError of the truths that cannot be computed.

    Raises
    ------
    InputError
        Labels or cases are not those that were sealed.
    """
    entries = read_labels(labels)
    check_seal(folder, entries, labels)
    wanted = missing_films(folder, entries["cases"], plans, out)
    work = make_folder(labels.with_name(f"{labels.name}.next"), mode=0o700)  # it shows the causes
    failed: dict[Call, NumericalError] = {}

    def finished(call: Call, outcome: FvcollapseError | None) -> None:
        """Film a truth that has been run."""
        if isinstance(outcome, NumericalError):
            failed[call[0], call[1].removesuffix(WITHOUT)] = outcome
            return
        if isinstance(outcome, FvcollapseError):
            raise outcome
        if call not in wanted or call in failed:
            return
        case, name = call
        set_up, run = wanted[call]
        world = entries["cases"][case]["label"]["world"]
        write_experiment(out / case / name, run, world, work / case, set_up)

    calls: dict[Call, tuple] = {}
    for (case, name), (_, run) in wanted.items():
        for truth, text in texts_of(name, run).items():
            calls[case, truth] = (text, run["forces"], work / case / f"{truth}.h5")
    for is_shown in (False, True):  # what a film is made of is run before it
        some = {call: each for call, each in calls.items() if (call in wanted) == is_shown}
        run_all(keep_truth, some, finished, *resources)
    shutil.rmtree(work)
    return failed


def missing_films(
    folder: Path, entries: Mapping[str, Entry], plans: Path, out: Path
) -> dict[Call, tuple[SetUp, Run]]:
    """{(case, candidate): (SetUp, run)} of what is not filmed yet."""
    wanted = {}
    for path in sorted(Path(plans).glob("*.json")):
        case, plan = path.stem, json.loads(path.read_text(encoding="utf-8"))
        first, entry = set_up_of(first_experiment(folder / case).name), entries[case]
        for name, about in plan["candidates"].items():
            if not (out / case / name / SETTINGS).exists():
                set_up = varied(first, about["changes"])
                seed = (entry["seed"], entry["attempt"], zlib.crc32(name.encode()))
                wanted[case, name] = set_up, draw_added(entry["label"], set_up, seed)
    return wanted
