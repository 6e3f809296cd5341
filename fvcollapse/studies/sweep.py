"""The product of variations of a case: one result per point, and a table of all points.

The folder of a point is named after its values, so that a sweep may be continued, and widened by
further values, with the same folder. The table keeps the rows of all points of the folder: a narrower
sweep, or another one at the same time, takes none away.
"""

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fvcollapse.case.case import parse_value
from fvcollapse.case.grammar import read_text, toml_value
from fvcollapse.errors import (
    CaseError,
    FvcollapseError,
    InputError,
    NumericalError,
    failures_named,
)
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.locks import LOCK, exclusive
from fvcollapse.files.targets import make_folder
from fvcollapse.output.question import Latitude, case_question, claim_folder
from fvcollapse.output.result import open_result
from fvcollapse.studies.members import run_member
from fvcollapse.studies.sweep_units import UNITS_TABLE, headed, units_table
from fvcollapse.studies.workers import HERE, refuse_workers, run_all

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.studies.workers import Resources


TABLE = "sweep.csv"
POINTS_MAX = 100_000
FOLDER_NAME_MAX = 120  # characters
SHOWN = (
    "runout",
    "runout_10mm",
    "final_thickness",
    "arrest_time",
    "trust",
)  # printed; the table has all


class Point(NamedTuple):
    """One combination of values: the name of its folder, {key: value}, and its case."""

    name: str
    values: dict
    case: "Case"


def sweep(
    case: "Case",
    variations: Mapping[str, Sequence],
    folder: str | Path,
    resources: "Resources" = HERE,
    source: str | Path = "case",
    force: bool = False,
) -> list[dict[str, Any]]:
    """Run a case at every combination of values; what is finished is not run again.

    Parameters
    ----------
    case : Case
    variations : dict
        {dotted key: list of values}.
    folder : str or Path
        Gets one folder per point, and `sweep.csv` with `sweep_units.csv`, renewed after every run.
    resources : Resources
        Where the points are run.
    source : str
        Name of the case in errors.
    force : bool
        Take the folder over from a sweep of another case; see `question`.

    Returns
    -------
    list of dict
        The rows of these points: point, the varied keys, status (complete, failed, missing), problem,
        and the numbers of `Result.summary` (None while there are none).

    Raises
    ------
    InputError, OutputError
        Before anything runs; later if a folder holds another run or cannot be written.
        The folder holds something else, in particular a sweep of another case.
    """
    refuse_workers(resources.workers)
    points = all_points(case, variations, source)
    folder = Path(folder).absolute()  # a worker has a working folder of its own
    latitude = Latitude(free=tuple(f"case.{key}" for key in variations))
    same = claim_folder(folder, "sweep", case_question(case), force, latitude)
    make_folder(folder, TABLE, UNITS_TABLE)
    if not same:
        for name in (TABLE, UNITS_TABLE):  # of another sweep
            (folder / name).unlink(missing_ok=True)
    outcomes = {point.name: {"status": "missing"} for point in points}

    def finished(name, outcome):
        if isinstance(outcome, NumericalError):
            outcomes[name] = {"status": "failed", "problem": str(outcome)}
        elif isinstance(outcome, FvcollapseError):
            raise outcome
        else:
            outcomes[name] = {"status": "complete"} | outcome
        renew_table(folder / TABLE, table_rows(points, outcomes))

    workers, scheduler, quiet = resources
    silent = quiet or workers > 1 or scheduler is not None
    calls = {point.name: (point.case, folder / point.name, silent, force) for point in points}
    run_all(run_point, calls, finished, *resources)
    return table_rows(points, outcomes)


def run_point(case: "Case", folder: str | Path, quiet: bool, force: bool = False) -> dict[str, Any]:
    """Run one point, or continue it; return its summary."""
    run_member(case, folder, quiet, force)
    with failures_named():
        return open_result(folder).summary()


# -- the points ----------------------------------------------------------------------------------


def parse_variation(text: str) -> tuple[str, list]:
    """(key, values) of "section.key=a,b,c"; the values are a TOML list, else words.

    Raises
    ------
    InputError
    """
    name, equals, values = (part.strip() for part in text.partition("="))
    if not (name and equals and values):
        allowed = "--vary section.key=VALUE,VALUE,..."
        raise InputError("command line", f"--vary {text}", "no key, no '=' or no value", allowed)
    found = parse_value(f"[{values}]")
    if not isinstance(found, list):
        found = [parse_value(value.strip()) for value in values.split(",")]
    return name, found


def all_points(
    case: "Case", variations: Mapping[str, Sequence], source: str | Path = "case"
) -> list[Point]:
    """Every combination of the values as a `Point`; the last key changes fastest.

    Raises
    ------
    CaseError, InputError
        A value is out of range, the same combination is there twice, or there are too many.
    """
    count = math.prod(len(values) for values in variations.values())
    if not 1 <= count <= POINTS_MAX:
        allowed = f"1 to {POINTS_MAX} combinations"
        raise InputError("command line", "--vary", f"{count} combinations", allowed)
    combinations = product(*variations.values())
    points = [
        make_point(case, dict(zip(variations, values, strict=True)), source)
        for values in combinations
    ]
    seen = set()
    for point in points:
        if point.name in seen:
            raise InputError("command line", "--vary", f"{point.name} twice", "different values")
        seen.add(point.name)
    return points


def make_point(case: "Case", values: dict[str, Any], source: str | Path) -> Point:
    """One `Point`."""
    try:
        varied = case.replace(**values)
    except CaseError as error:
        wanted = " ".join(f"--vary {key}={toml_value(value)}" for key, value in values.items())
        raise CaseError(f"{source} with {wanted}", error.key, error.found, error.allowed) from None
    return Point(point_name(values), values, varied)


def point_name(values: Mapping[str, Any]) -> str:
    """Name of a folder, made of the values; a digest stands for what would make it too long."""
    full = "_".join(f"{key}={toml_value(value)}" for key, value in values.items())
    name = re.sub(r"[^\w.=+-]+", "-", full.replace('"', "")).strip("-")
    if len(name) <= FOLDER_NAME_MAX:
        return name
    return f"{name[: FOLDER_NAME_MAX - 17]}_{sha256(full.encode()).hexdigest()[:16]}"


# -- the table -----------------------------------------------------------------------------------


def table_rows(points: Sequence[Point], outcomes: Mapping[str, dict]) -> list[dict[str, Any]]:
    """One flat dictionary per point."""
    names = list(dict.fromkeys(name for of in outcomes.values() for name in of))
    columns = ["status", "problem", *(name for name in names if name not in ("status", "problem"))]
    return [
        {"point": point.name, **point.values}
        | {column: outcomes[point.name].get(column) for column in columns}
        for point in points
    ]


def renew_table(path: Path, rows: list[dict]) -> None:
    """Put rows into the table at `path`; rows of other points, and better ones of these, stay."""
    with exclusive(path.parent / LOCK):
        before = {row["point"]: row for row in read_table(path)}
        new = [before.get(row["point"], row) if row["status"] == "missing" else row for row in rows]
        names = {row["point"] for row in new}
        write_table(path, new + [row for point, row in before.items() if point not in names])


def read_table(path: Path) -> list[dict[str, Any]]:
    """The rows of a table, all cells as text; none if it is not there.

    Raises
    ------
    InputError
        It is no table of a sweep.
    """
    if not path.exists():
        return []
    rows = list(csv.DictReader(io.StringIO(read_text(path, "CSV"), newline="")))
    if not all(row.get("point") and row.get("status") and None not in row for row in rows):
        raise InputError(path, "file", "no table of a sweep", "that table, or --force")
    return rows


def write_table(path: Path, rows: list[dict]) -> None:
    """Write the rows as CSV, where None is an empty cell, and the units of the columns beside it."""
    text = io.StringIO()
    columns = list(dict.fromkeys(name for row in rows for name in row))
    keys = [name for name in columns if "." in name]
    first = ["point", *keys, "status", "problem"]
    columns = first + [name for name in columns if name not in first]
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: cell(value) for name, value in row.items()} for row in rows)
    write_atomic(path, text.getvalue().encode())
    write_atomic(path.with_name(UNITS_TABLE), units_table(columns).encode())


def cell(value: Any) -> str:
    """A value as text: words as they are, the rest as in TOML; "" for None."""
    if value is None:
        return ""
    return value if isinstance(value, str) else toml_value(value)


def table(rows: list[dict]) -> str:
    """The rows as aligned plain text: varied keys, status and a few observables, with their units."""
    keys = [name for name in list(rows[0])[1:] if name == "status" or "." in name]
    columns = [*keys, *(name for name in SHOWN if name in rows[0])]
    lines = [list(map(headed, columns))] + [[short(row[name]) for name in columns] for row in rows]
    widths = [max(len(line[n]) for line in lines) for n in range(len(columns))]
    return "\n".join(
        "  ".join(word.rjust(width) for word, width in zip(line, widths, strict=True))
        for line in lines
    )


def short(value: Any) -> str:
    """A value in a few characters."""
    if value is None:
        return "-"
    return f"{value:.5g}" if isinstance(value, float) else cell(value)
