"""Markdown tables of the README files, the numbers in them, and the stored reports that they are made of."""

import json
from decimal import ROUND_HALF_UP, Decimal

from fvcollapse.errors import FvcollapseError
from runs.table import RUNS


def require(holds, sentence):
    """Refuse to write a sentence that the tables no longer bear out.

    Parameters
    ----------
    holds : bool
        Whether the tables say what the sentence says.
    sentence : str
        What is written by hand and no longer true.
    """
    if not holds:
        raise FvcollapseError(f"the stored tables no longer say: {sentence}; write it anew")


def table(heading, rows):
    """A Markdown table with a heading; cells are texts."""
    lines = [heading, ["---"] * len(heading), *rows]
    return "".join("| " + " | ".join(map(escaped, cells)) + " |\n" for cells in lines)


def escaped(text):
    """A text that ends no cell of a table."""
    return text.replace("|", "\\|")


def bullets(lines):
    """A Markdown list."""
    return "".join(f"- {line}\n" for line in lines)


def stored(*names):
    """A JSON file of a study."""
    return json.loads(RUNS.joinpath(*names).read_text(encoding="utf-8"))


# -- numbers -------------------------------------------------------------------------------------


def rounded(value, digits=0, scale=1):
    """The text of a number times `scale` with some decimals, halves away from zero.

    Parameters
    ----------
    value : str or float
        As it stands in a table.
    digits : int
    scale : int
        1000 for lengths in m that are told in mm, 100 for shares that are told in %.
    """
    exact = (Decimal(str(value)) * scale).quantize(Decimal(1).scaleb(-digits), ROUND_HALF_UP)
    text = f"{abs(exact)}"
    return f"−{text}" if exact < 0 else text


def signed(value, digits=0, scale=1):
    """As `rounded`, with its sign; "0" for zero."""
    text = rounded(value, digits, scale)
    if float(text.replace("−", "-")) == 0.0:
        return "0"
    return text if text.startswith("−") else f"+{text}"


def span(values, show):
    """The least and the largest of some numbers in words, each shown by `show`; one if they read the same."""
    low, high = (show(value) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def change(old, new):
    """Change in %, of numbers as they stand in a table."""
    return 100.0 * (float(new) / float(old) - 1.0)


def pair(rows, name, digits, unit):
    """A column of several rows with its unit."""
    return " / ".join(rounded(row[name], digits) for row in rows) + f" {unit}"
