"""Measured curves as CSV files with a header line: read, checked, written.

Every defect is one line that names file, column, what was found and in which line, and what is
allowed.
"""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fvcollapse.case.grammar import closest_name, read_text
from fvcollapse.errors import InputError
from fvcollapse.files.plain_numbers import decimal_number, finite_numbers
from fvcollapse.measure.quantities import CURVES

KINDS = ("value", "upper", "lower")
ROWS_MAX = 5_000_000  # more is a wrong file


SCALARS = "scalars"
SCALAR_COLUMNS = ("name", "value", "sigma", "kind")
CSV_FILES = (*CURVES, SCALARS)


class Curve(NamedTuple):
    """Measured points, (n,) each; x is None for curves over time alone. SI units."""

    time: np.ndarray
    x: np.ndarray | None
    value: np.ndarray
    sigma: np.ndarray


class Scalar(NamedTuple):
    """One number, or a bound on one: kind "value", "upper" (at most) or "lower" (at least)."""

    name: str
    value: float
    sigma: float
    kind: str


def read_curve(path: Path, name: str, sigma: float) -> Curve:
    """The curve in a CSV file.

    Parameters
    ----------
    path : Path
    name : str
        Key of `quantities.CURVES`.
    sigma : float
        Standard deviation where the file has no column for it.

    Raises
    ------
    InputError
        A column that is missing or unknown, a value that is not finite, times that do not increase,
        or, within one time, abscissae that do not; a standard deviation that is not positive.
    """
    quantity = CURVES[name]
    lines, header, rows = read_rows(path, quantity.columns, (quantity.sigma_column,))
    numbers = {
        column: column_of_numbers(path, column, lines, cells)
        for column, cells in zip(header, zip(*rows, strict=True), strict=True)
    }
    time, *places, value = (numbers[column] for column in quantity.columns)
    refuse_disorder(path, quantity.columns, time, places, lines)
    spread = numbers.get(quantity.sigma_column)
    if spread is None:
        spread = np.full(len(time), float(sigma))
    elif (spread <= 0.0).any():
        refuse(
            path,
            quantity.sigma_column,
            f"{spread.min():g}",
            lines[int(np.argmin(spread))],
            "a number > 0",
        )
    return Curve(time, places[0] if places else None, value, spread)


def read_scalars(
    path: Path, units: Mapping[str, str], default: Callable[[str], float]
) -> tuple[Scalar, ...]:
    """The scalars in a CSV file, as a tuple of `Scalar`.

    An empty `kind` is "value"; an empty `sigma` takes the default.

    Parameters
    ----------
    path : Path
    units : dict
        Units of each name that is known.
    default : function
        Standard deviation of a name where the file gives none.

    Raises
    ------
    InputError
    """
    lines, header, rows = read_rows(path, SCALAR_COLUMNS[:2], SCALAR_COLUMNS[2:])
    scalars = [
        scalar(path, line, dict(zip(header, cells, strict=True)), units, default)
        for line, cells in zip(lines, rows, strict=True)
    ]
    seen = [(each.name, each.kind) for each in scalars]
    for line, pair in zip(lines, seen, strict=True):
        if seen.count(pair) > 1:
            refuse(path, "name", f"{pair[0]} ({pair[1]}) twice", line, "each once")
    return tuple(scalars)


def scalar(
    path: Path,
    line: int,
    row: Mapping[str, str],
    units: Mapping[str, str],
    default: Callable[[str], float],
) -> Scalar:
    """The `Scalar` of one row."""
    name, kind = row["name"], row.get("kind") or "value"
    if name not in units:
        known = f"the closest name is {closest_name(name, list(units))}"
        refuse(path, "name", repr(name), line, known)
    if kind not in KINDS:
        refuse(path, "kind", repr(kind), line, " or ".join(KINDS))
    value = number(path, "value", line, row["value"])
    stated = row.get("sigma")
    sigma = number(path, "sigma", line, stated) if stated else default(name)
    if sigma <= 0.0:
        refuse(path, "sigma", f"{sigma:g}", line, "a number > 0")
    return Scalar(name, value, sigma, kind)


def read_rows(
    path: Path, required: Sequence[str], optional: Sequence[str]
) -> tuple[list[int], list[str], list[list[str]]]:
    """Line numbers, header and rows of a CSV file; every row has as many cells as the header."""
    try:
        reader = csv.reader(io.StringIO(read_text(path, "CSV"), newline=""), strict=True)
        table = [(reader.line_num, list(map(str.strip, row))) for row in reader if any(row)]
    except csv.Error as error:
        raise InputError(path, "file", f"broken CSV: {error}", "comma-separated values") from None
    if len(table) < 2:
        raise InputError(path, "file", "no rows", f"a header {', '.join(required)} and rows")
    if len(table) > ROWS_MAX:
        raise InputError(path, "file", f"{len(table)} rows", f"at most {ROWS_MAX}")
    (_, header), *body = table
    check_header(path, header, required, optional)
    for line, row in body:
        if len(row) != len(header):
            refuse(path, "row", f"{len(row)} cells", line, f"{len(header)}, as in the header")
    return [line for line, _ in body], header, [row for _, row in body]


def check_header(
    path: Path, header: list[str], required: Sequence[str], optional: Sequence[str]
) -> None:
    """Refuse a header with a column that is unknown, missing or there twice."""
    for name in header:
        if name not in (*required, *optional):
            nearest = closest_name(name, [*required, *optional])
            found, allowed = "an unknown column in the header", f"the closest column is {nearest}"
            raise InputError(path, name or "column without a name", found, allowed)
        if header.count(name) > 1:
            raise InputError(path, name, "the column twice", "each column once")
    for name in required:
        if name not in header:
            allowed = f"the columns {', '.join(required)}"
            raise InputError(path, name, "no such column in the header", allowed)


def column_of_numbers(
    path: Path, column: str, lines: Sequence[int], cells: Sequence[str]
) -> np.ndarray:
    """A column of finite numbers."""
    found = finite_numbers(cells)
    if found is None:  # the first that is none is named
        found = [number(path, column, *at) for at in zip(lines, cells, strict=True)]
    return np.array(found)


def number(path: Path, column: str, line: int, text: str) -> float:
    """A finite number."""
    try:
        value = decimal_number(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        refuse(path, column, repr(text), line, "a finite number")
    return value


def refuse_disorder(
    path: Path, columns: Sequence[str], time: np.ndarray, places: list[np.ndarray], lines: list[int]
) -> None:
    """Refuse times, or abscissae within one time, that do not increase."""
    steps = np.diff(time)
    bad = steps < 0.0 if places else steps <= 0.0
    if places:
        bad |= (steps == 0.0) & (np.diff(places[0]) <= 0.0)
    if not bad.any():
        return
    row = int(np.argmax(bad))
    back_in_time = not places or steps[row] < 0.0
    column, values = (columns[0], time) if back_in_time else (columns[1], places[0])
    found = f"{values[row + 1]:g} after {values[row]:g}"
    order = "times in order" if places else "increasing times"
    allowed = order if back_in_time else "abscissae that increase within each time"
    refuse(path, column, found, lines[row + 1], allowed)


def refuse(path: Path, column: str, found: str, line: int, allowed: str) -> None:
    """Raise the InputError of one line of a CSV file."""
    raise InputError(path, column, f"{found} in line {line}", allowed)


def curve_text(name: str, rows: np.ndarray) -> str:
    """CSV text of a curve: rows (time, value) or (time, x, value).

    Parameters
    ----------
    name : str
        Key of `quantities.CURVES`.
    rows : (n, 2) or (n, 3) array
        In the order of the file.
    """
    return csv_text(CURVES[name].columns, [[f"{value:.7g}" for value in row] for row in rows])


def scalars_text(scalars: Iterable[Scalar]) -> str:
    """CSV text of scalars."""
    rows = [[each.name, f"{each.value:.7g}", f"{each.sigma:.7g}", each.kind] for each in scalars]
    return csv_text(SCALAR_COLUMNS, rows)


def csv_text(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """CSV text with a header line."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()
