"""The product of variations of a case: one result per point, and a table of all points.

The folder of a point is named after its values, so that a sweep may be continued, and widened by
further values, with the same folder.
"""

import csv
import io
import math
import re
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import NamedTuple

from fvcollapse.case.case import parse_value
from fvcollapse.case.grammar import toml_value
from fvcollapse.errors import (
    CaseError,
    FvcollapseError,
    InputError,
    NumericalError,
    OutputError,
    failures_named,
)
from fvcollapse.files.storage import write_atomic
from fvcollapse.output.result import open_result
from fvcollapse.studies.members import run_member
from fvcollapse.studies.workers import refuse_workers, run_all

TABLE = "sweep.csv"
POINTS_MAX = 100_000
NAME_MAX = 120  # characters of the name of a folder
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
    case: object


def sweep(case, variations, folder, workers=1, scheduler=None, quiet=True, source="case"):
    """Run a case at every combination of values; what is finished is not run again.

    Parameters
    ----------
    case : Case
    variations : dict
        {dotted key: list of values}.
    folder : str or Path
        Gets one folder per point, and `sweep.csv`, which is renewed after every run.
    workers, scheduler, quiet
        See `run_all`.
    source : str
        Name of the case in errors.

    Returns
    -------
    list of dict
        The rows of the table: point, the varied keys, status (complete, failed, missing), problem,
        and the numbers of `Result.summary` (None while there are none).

    Raises
    ------
    InputError, OutputError
        Before anything runs; later if a folder holds another run or cannot be written.
    """
    refuse_workers(workers)
    points = all_points(case, variations, source)
    folder = Path(folder).absolute()  # a worker has a working folder of its own
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(folder, error, running=False) from None
    found = {point.name: {"status": "missing"} for point in points}

    def finished(name, outcome):
        if isinstance(outcome, NumericalError):
            found[name] = {"status": "failed", "problem": str(outcome)}
        elif isinstance(outcome, FvcollapseError):
            raise outcome
        else:
            found[name] = {"status": "complete"} | outcome
        write_table(folder / TABLE, table_rows(points, found))

    silent = quiet or workers > 1 or scheduler is not None
    calls = {point.name: (point.case, folder / point.name, silent) for point in points}
    run_all(run_point, calls, finished, workers, scheduler, quiet)
    return table_rows(points, found)


def run_point(case, folder, quiet):
    """Run one point, or continue it; return its summary."""
    run_member(case, folder, quiet)
    with failures_named():
        return open_result(folder).summary()


# -- the points ----------------------------------------------------------------------------------


def parse_variation(text):
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


def all_points(case, variations, source="case"):
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


def make_point(case, values, source):
    """One `Point`."""
    try:
        varied = case.replace(**values)
    except CaseError as error:
        wanted = " ".join(f"--vary {key}={toml_value(value)}" for key, value in values.items())
        raise CaseError(f"{source} with {wanted}", error.key, error.found, error.allowed) from None
    return Point(point_name(values), values, varied)


def point_name(values):
    """Name of a folder, made of the values; a digest stands for what would make it too long."""
    full = "_".join(f"{key}={toml_value(value)}" for key, value in values.items())
    name = re.sub(r"[^\w.=+-]+", "-", full.replace('"', "")).strip("-")
    if len(name) <= NAME_MAX:
        return name
    return f"{name[: NAME_MAX - 17]}_{sha256(full.encode()).hexdigest()[:16]}"


# -- the table -----------------------------------------------------------------------------------


def table_rows(points, found):
    """One flat dictionary per point."""
    names = list(dict.fromkeys(name for of in found.values() for name in of))
    columns = ["status", "problem", *(name for name in names if name not in ("status", "problem"))]
    return [
        {"point": point.name, **point.values}
        | {column: found[point.name].get(column) for column in columns}
        for point in points
    ]


def write_table(path, rows):
    """Write the rows as CSV; None is an empty cell."""
    text = io.StringIO()
    writer = csv.DictWriter(text, rows[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: cell(value) for name, value in row.items()} for row in rows)
    write_atomic(path, text.getvalue().encode())


def cell(value):
    """A value as text: words as they are, the rest as in TOML; "" for None."""
    if value is None:
        return ""
    return value if isinstance(value, str) else toml_value(value)


def table(rows):
    """The rows as aligned plain text: varied keys, status and a few observables."""
    keys = [name for name in list(rows[0])[1:] if name == "status" or "." in name]
    columns = [*keys, *(name for name in SHOWN if name in rows[0])]
    lines = [columns] + [[short(row[name]) for name in columns] for row in rows]
    widths = [max(len(line[n]) for line in lines) for n in range(len(columns))]
    return "\n".join(
        "  ".join(word.rjust(width) for word, width in zip(line, widths, strict=True))
        for line in lines
    )


def short(value):
    """A value in a few characters."""
    if value is None:
        return "-"
    return f"{value:.5g}" if isinstance(value, float) else cell(value)
