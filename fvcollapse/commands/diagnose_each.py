"""`diagnose --each`: many experiments, one diagnosis for each of them, and a table of all answers."""

import csv
import io
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from fvcollapse.errors import InputError, NumericalError

SUMMARY = "summary.csv"
DONE, FAILED = "done", "failed"


class SummaryRow(NamedTuple):
    """The answer for one experiment; numbers are empty where there are none."""

    experiment: str
    status: str
    state: str = ""
    headline: str = ""
    first_cause: str = ""
    probability: float | None = None
    closed_fitted: float | None = None
    closed_held_out: float | None = None
    problem: str = ""


def diagnose_each(experiments: list, folder: Path, diagnose: Callable, force: bool = False) -> int:
    """Diagnose experiments one by one; print and write the table of all answers, after each of them.

    Parameters
    ----------
    experiments : sequence of Path
        Folders; all of them are read before anything is run.
    folder : Path
        Gets `summary.csv`, and a folder of each experiment by its name.
    diagnose : function
        (experiment, folder) -> Report.
    force : bool
        Replace the results of another question.

    Returns
    -------
    int
        Exit status: 1 if the computation of one of them failed; the others are there.

    Raises
    ------
    InputError
        Before anything runs: an experiment is refused, or two have the same name.
    """
    from fvcollapse.files.targets import make_folder
    from fvcollapse.measure.experiment import load_experiment
    from fvcollapse.output.question import Latitude, claim_folder

    loaded = named_once([load_experiment(path) for path in experiments])
    latitude = Latitude(growing=("experiments",))
    claim_folder(folder, "diagnose --each", {"experiments": sorted(loaded)}, force, latitude)
    make_folder(folder, SUMMARY)
    rows = []
    for name, experiment in loaded.items():
        try:
            rows.append(answered(name, diagnose(experiment, folder / name)))
        except NumericalError as error:
            print(f"{name}: {error}", file=sys.stderr)
            rows.append(SummaryRow(name, FAILED, problem=str(error)))
        write_summary(rows, folder)
        print(f"{name}: {rows[-1].headline or rows[-1].problem}", flush=True)
    print(folder / SUMMARY)
    return 1 if any(row.status == FAILED for row in rows) else 0


def named_once(experiments: list) -> dict[str, Any]:
    """{name: experiment}; two of one name would write into one folder.

    Raises
    ------
    InputError
    """
    found: dict[str, Any] = {}
    for one in experiments:
        if one.name in found:
            allowed = f"folders of different names; {found[one.name].folder} has it too"
            raise InputError("command line", "EXPERIMENT", str(one.folder), allowed)
        found[one.name] = one
    return found


def answered(name: str, report: Any) -> Any:
    """The row of a report."""
    from fvcollapse.diagnosis.report.sentences import headline
    from fvcollapse.diagnosis.report.standing import standing

    stand, reduction = standing(report), report.reduction
    held_out = reduction.held_out if reduction is not None else None
    return SummaryRow(
        experiment=name,
        status=DONE,
        state=stand.state,
        headline=headline(report),
        first_cause=stand.causes[0],
        probability=stand.shares[stand.causes[0]],
        closed_fitted=None if reduction is None else reduction.fitted.overall.fraction_closed,
        closed_held_out=None if held_out is None else held_out.overall.fraction_closed,
    )


def write_summary(rows: list, folder: Path) -> Any:
    """Write the rows as CSV."""
    from fvcollapse.files.atomic import write_atomic

    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([SummaryRow._fields, *rows])
    write_atomic(folder / SUMMARY, stream.getvalue().encode())
