"""The runs of a diagnosis as a table: what each of them was for, and how it differs from the model as given."""

import csv
import io
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fvcollapse.case.grammar import as_table
from fvcollapse.diagnosis.report.schema_origin import RunGroup
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.question import flat

if TYPE_CHECKING:
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.diagnosis.runner import Runner

RUNS_FILE = "runs.csv"
COLUMNS = ("experiment", "purpose", "changes", "cell_size_m", "end_s", "status", "cache_folder")
COMPUTED, CACHED, FAILED = "computed", "from the cache", "failed"
GRID = "grid."
EFFECTS = "effects."
NUMERICS = ("grid.", "time.")


class RunRow(NamedTuple):
    """One run; the fields are `COLUMNS`."""

    experiment: str
    purpose: str
    changes: str
    cell_size_m: float
    end_s: float
    status: str
    cache_folder: str


def run_rows(runner: "Runner", question: "Question") -> list[RunRow]:
    """The `RunRow` list of a diagnosis, in the order in which the runs were asked for.

    Parameters
    ----------
    runner : Runner
    question : Question
    """
    cases = question.cases | question.held_out_cases
    given = {name: flat(as_table(case)) for name, case in cases.items()}
    rows = []
    for key, (experiment, case, place) in runner.record.items():
        own = flat(as_table(case))
        changed = changes(given.get(experiment, {}), own) if experiment in given else None
        status = COMPUTED if key in runner.computed else CACHED
        rows.append(
            RunRow(
                experiment=experiment,
                purpose=purpose_of(changed),
                changes=""
                if changed is None
                else "; ".join(f"{k}={v}" for k, v in changed.items()),
                cell_size_m=case.grid.cell_size,
                end_s=case.time.end,
                status=FAILED if key in runner.failed else status,
                cache_folder=str(place),
            )
        )
    return rows


def changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, Any]:
    """{key: value, or "absent"} of the keys in which two flat cases differ."""
    names = [*after, *(name for name in before if name not in after)]
    return {
        name: after.get(name, "absent") for name in names if before.get(name) != after.get(name)
    }


def purpose_of(changed: Mapping[str, Any] | None) -> str:
    """What a run is for, by the keys that it changes; None: a set-up that was not measured."""
    if changed is None:
        return "a further experiment"
    physics = [name for name in changed if not name.startswith(NUMERICS)]
    effects = {name.split(".")[1] for name in physics if name.startswith(EFFECTS)}
    if effects:
        return " + ".join(sorted(effects)).replace("_", " ")
    if physics:
        return "other parameters"
    return "finer grid" if any(name.startswith(GRID) for name in changed) else "model as given"


def run_groups(rows: Iterable[RunRow]) -> list[RunGroup]:
    """The `RunGroup` list of some rows."""
    groups: dict[tuple[str, str], Counter[str]] = {}
    for row in rows:
        groups.setdefault((row.experiment, row.purpose), Counter()).update([row.status])
    return [
        RunGroup(
            experiment=experiment,
            purpose=purpose,
            runs=counts.total(),
            cached=counts[CACHED],
            failed=counts[FAILED],
        )
        for (experiment, purpose), counts in groups.items()
    ]


def write_runs(rows: Iterable[RunRow], folder: str | Path) -> Path:
    """Put the rows into `runs.csv` of a folder; its path.

    Raises
    ------
    OutputError
    """
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(COLUMNS)
    table.writerows(rows)
    path = Path(folder) / RUNS_FILE
    write_atomic(path, stream.getvalue().encode())
    return path
