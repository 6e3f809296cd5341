"""Markdown tables of the README files, and the stored reports that they are made of."""

import json

from runs.table import RUNS


def table(heading, rows):
    """A Markdown table with a heading; cells are texts."""
    lines = [heading, ["---"] * len(heading), *rows]
    return "".join("| " + " | ".join(map(escaped, cells)) + " |\n" for cells in lines)


def escaped(text):
    """A text that ends no cell of a table."""
    return text.replace("|", "\\|")


def stored(*names):
    """A JSON file of a study."""
    return json.loads(RUNS.joinpath(*names).read_text(encoding="utf-8"))
