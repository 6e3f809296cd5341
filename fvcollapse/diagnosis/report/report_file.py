"""`report.json`: a report written, read and checked."""

import json
import math
import os
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from fvcollapse.case.grammar import read_text
from fvcollapse.diagnosis.report.checks import contradictions
from fvcollapse.diagnosis.report.schema import FORMAT, FORMAT_VERSION, Report
from fvcollapse.errors import FvcollapseError, InputError
from fvcollapse.files.atomic import write_atomic

FILE_NAME = "report.json"
DIGITS = 6  # significant digits of an array in the file


class ReportError(FvcollapseError):
    """A report that contradicts itself; nothing is written."""


def to_json(report: Report) -> str:
    """The report as the text of `report.json`.

    Raises
    ------
    ReportError
        It contradicts itself, or holds a value that JSON has not.
    """
    tree = msgspec.to_builtins(report, enc_hook=plain)
    tree = without_nan(tree, "")
    try:
        checked = msgspec.convert(tree, Report)
    except msgspec.ValidationError as error:
        raise ReportError(f"report: {error}") from None
    for key, problem in contradictions(checked):
        raise ReportError(f"report: {key}: {problem}")
    return json.dumps(tree, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write_report(report: Report, folder: str | Path) -> Path:
    """Put `report.json` into a folder; its path.

    Raises
    ------
    ReportError, OutputError
    """
    path = Path(folder) / FILE_NAME
    write_atomic(path, to_json(report).encode())
    return path


def read_report(path: str | Path) -> Report:
    """The report in a file (or in `report.json` of a folder).

    Raises
    ------
    InputError
        No report, or one that contradicts itself.
    """
    path = Path(path)
    path = path / FILE_NAME if os.path.isdir(path) else path
    text = read_text(path, "JSON")
    try:
        report = msgspec.json.decode(text, type=Report)
    except (msgspec.MsgspecError, RecursionError) as error:
        allowed = f"a {FORMAT} of version {FORMAT_VERSION}"
        raise InputError(path, "file", str(error), allowed) from None
    for key, problem in contradictions(report):
        raise InputError(path, key, problem, "a report that agrees with itself")
    return report


def plain(value: object) -> Any:
    """Arrays and numpy numbers as lists and numbers of Python; arrays to `DIGITS` digits."""
    if isinstance(value, np.ndarray):
        return rounded(value.tolist())
    if isinstance(value, np.generic):
        return value.item()
    raise ReportError(f"report: a {type(value).__name__} is no value of a report")


def rounded(value: Any) -> Any:
    """Nested lists with their floats rounded to `DIGITS` significant digits."""
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def without_nan(value: Any, key: str) -> Any:
    """The tree with None for what is not finite in a list; elsewhere that is an error."""
    if isinstance(value, dict):
        return {name: without_nan(item, f"{key}.{name}".strip(".")) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [
            None if missing(item) else without_nan(item, f"{key}[{n}]")
            for n, item in enumerate(value)
        ]
    if missing(value):
        raise ReportError(f"report: {key}: {value} is no finite number")
    return value


def missing(value: object) -> bool:
    """Whether a value is NaN or infinite."""
    return isinstance(value, float) and not math.isfinite(value)
