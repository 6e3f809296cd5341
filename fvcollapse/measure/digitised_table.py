"""Two columns of numbers in a file, as digitising tools and spreadsheets write them.

Such files differ in the mark between the columns (comma, semicolon, tab, blanks), in the decimal mark (point,
comma), in quotes, and in what stands above the numbers: the name of the data set, the names of the axes, `sep=;`.
The first combination of marks that makes every line two numbers is taken. A file that can be read in two ways, or
that holds several data sets, is refused in one line that says how to export it.
"""

import csv
import re
from codecs import BOM_UTF8
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from fvcollapse.case.grammar import decode_text, read_bytes
from fvcollapse.errors import InputError
from fvcollapse.files.plain_numbers import decimal_number

# (mark between the columns, None = blanks; decimal mark), less ambiguous ones first
STYLES = (
    (";", "."),
    (";", ","),
    ("\t", "."),
    ("\t", ","),
    (",", "."),
    (",", ","),  # numbers in quotes
    (None, "."),
    (None, ","),
)
SEPARATOR = re.compile(r"\s*sep=(.)\s*", re.IGNORECASE)  # first line of a spreadsheet's export
BEGINS_AS_NUMBER = re.compile(r"""[\s,;"']*[+-]?[.,]?[0-9]""")
LIKE_NUMBER = re.compile(r"[-+0-9.,:'eE\s]*|nan|[-+]?inf|n/?a|none|null", re.IGNORECASE)
THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+")
HEADER_MAX = 3  # lines of words above the numbers
SHOWN = 60  # characters of a line
EXPORT = "two columns of numbers: export one data set alone, as CSV"
# what other files of such tools begin with
OTHER = {
    b"PK": "a ZIP archive, such as a spreadsheet or the project of a tool",
    b"\xd0\xcf\x11\xe0": "a spreadsheet in a binary format",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
    b"{": "a JSON document, such as the project of a tool",
    b"<": "an XML document, such as the project of a tool",
}


class Table(NamedTuple):
    """The lines of a file in one style.

    Attributes
    ----------
    header : list of list of str
        Cells of the lines above the numbers.
    rows : list of (int, str, list)
        Number of the line, the line, and its numbers; None in an empty cell.
    stopped : (int, str) or None
        The first line, with its number, that is neither words above numbers nor numbers.
    """

    header: list
    rows: list
    stopped: tuple | None

    def columns(self) -> list[int]:
        """Indices of the columns that hold a number anywhere."""
        width = max((len(cells) for _, _, cells in self.rows), default=0)
        return [
            column
            for column in range(width)
            if any(column < len(cells) and cells[column] is not None for _, _, cells in self.rows)
        ]


def read_table(path: Path) -> list[tuple[float, float]]:
    """Pairs (x, y) in the order of the file, a list of tuples.

    Empty lines, lines that begin with #, up to three lines of words above the numbers, and columns without a
    number are passed over.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    InputError
        The file cannot be read, is no table of two columns, or can be read in more than one way.
    """
    lines, styles = lines_of(path)
    if not any(BEGINS_AS_NUMBER.match(line) for _, line in lines):
        raise InputError(path, "file", "no points", EXPORT)
    tables = [table_in(lines, *style) for style in styles]
    for table, (between, decimal) in zip(tables, styles, strict=True):
        columns = table.columns()
        if table.stopped is None and len(columns) == 2:
            refuse_gaps(path, table, columns)
            if between == decimal:
                refuse_thousands(path, lines)
            return [tuple(cells[column] for column in columns) for _, _, cells in table.rows]
    raise refusal(path, tables, styles)


def lines_of(path: Path) -> tuple[list[tuple[int, str]], Any]:
    """([(number, line)] without empty lines and comments, the styles in which they may be)."""
    data = read_bytes(path, "two-column")
    for mark, kind in OTHER.items():
        if data.removeprefix(BOM_UTF8).lstrip().startswith(mark):
            raise InputError(path, "file", kind, f"{EXPORT}, in UTF-8")
    numbered = enumerate(decode_text(data, path).splitlines(), start=1)
    lines = [(at, line) for at, line in numbered if line.strip() and line.strip()[0] != "#"]
    separator = SEPARATOR.fullmatch(lines[0][1]) if lines else None
    if separator:
        return lines[1:], ((separator[1], "."), (separator[1], ","))
    return lines, STYLES


def table_in(lines: list[tuple[int, str]], between: str | None, decimal: str) -> Table:
    """The `Table` of lines whose columns and decimals have these marks."""
    header: list = []
    rows: list = []
    for at, line in lines:
        cells = cells_of(line, between)
        numbers = numbers_of(cells, decimal)
        if numbers is not None:
            rows.append((at, line, numbers))
        elif not rows and len(header) < HEADER_MAX and are_words(cells):
            header.append(cells)
        else:
            return Table(header, rows, (at, line))
    return Table(header, rows, None if rows else lines[0])


def cells_of(line: str, between: str | None) -> list[str]:
    """Cells of a line, without blanks and quotes around them; none where the quotes are broken."""
    if between is None:
        return [cell.strip("\"'") for cell in line.split()]
    try:
        (cells,) = csv.reader(
            [line.strip(" ")], delimiter=between, skipinitialspace=True, strict=True
        )
    except csv.Error:
        return []
    return [cell.strip() for cell in cells]


def numbers_of(cells: list[str], decimal: str) -> list | None:
    """The cells as finite numbers, None for an empty one; None if there is none, or anything else."""
    numbers: list[float | None] = []
    for cell in cells:
        if not cell:
            numbers.append(None)
            continue
        if decimal == "," and "." in cell:  # of another style
            return None
        try:
            numbers.append(decimal_number(cell.replace(decimal, ".")))
        except ValueError:
            return None
    known = [number for number in numbers if number is not None]
    return numbers if known and all(map(isfinite, known)) else None


def are_words(cells: list[str]) -> bool:
    """Whether no cell is, or wants to be, a number."""
    written = [cell for cell in cells if cell]
    return bool(written) and not any(LIKE_NUMBER.fullmatch(cell) for cell in written)


# -- refusals ------------------------------------------------------------------------------------


def refuse_gaps(path: Path, table: Table, columns: list[int]) -> None:
    """Refuse a pair of which one number is missing."""
    for at, line, cells in table.rows:
        if any(column >= len(cells) or cells[column] is None for column in columns):
            raise not_two(path, at, line)


def refuse_thousands(path: Path, lines: list[tuple[int, str]]) -> None:
    """Refuse numbers in quotes whose commas may stand between thousands as well as before decimals."""
    cells = [cell for _, line in lines for cell in cells_of(line, ",") if "," in cell]
    if all(THOUSANDS.fullmatch(cell) for cell in cells):
        found = f"commas that may be decimal marks or stand between thousands, as in {cells[0]}"
        raise InputError(path, "file", found, "a decimal point")


def refusal(path: Path, tables: Any, styles: Any) -> InputError:
    """The InputError for a file that no style makes a table of two columns."""
    for table, (between, _) in zip(tables, styles, strict=True):
        if table.stopped is None:
            return other_columns(path, table, between)
    table = max(tables, key=lambda table: table.stopped[0])
    at, line = table.stopped
    if table.rows and BEGINS_AS_NUMBER.match(line) is None:
        return InputError(path, f"line {at}", f"{line[:SHOWN]!r}, words below numbers", EXPORT)
    return not_two(path, at, line)


def not_two(path: Path, at: Any, line: str) -> InputError:
    """The InputError for a line that is not two numbers."""
    return InputError(
        path, f"line {at}", repr(line[:SHOWN]), "two finite numbers, as all lines before"
    )


def other_columns(path: Path, table: Table, between: str | None) -> InputError:
    """The InputError for a table that has not two columns."""
    at, line, cells = table.rows[0]
    count = len(table.columns())
    found = f"{line[:SHOWN]!r}, {count} column{'s' * (count != 1)} of numbers"
    named = any(len(cells) >= count for cells in table.header)
    pointless = "." not in "".join(line for _, line, _ in table.rows)
    if between == "," and count > 2 and pointless and not named:
        found += " if no comma is a decimal mark"
        allowed = "two columns: export with semicolons or tabs between them, or with decimal points"
        return InputError(path, f"line {at}", found, allowed)
    names = [cell for cell in (table.header[0] if table.header else []) if cell]
    if names:
        found += f" under {', '.join(names)[:SHOWN]}"
    return InputError(path, f"line {at}", found, EXPORT)
