"""JSON from a file that is not trusted: finite numbers, every name once, few levels, texts in UTF-8."""

import json
from math import isfinite
from pathlib import Path
from typing import Any

from fvcollapse.case.grammar import read_text, show
from fvcollapse.errors import InputError
from fvcollapse.files.trees import tree_problems


def read_object(path: str | Path, what: str) -> dict:
    """The JSON object in a file.

    Parameters
    ----------
    path : str or Path
    what : str
        What the file should be, for errors.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        Unreadable, no JSON, no object, or a value that no later step can take.
    """
    try:
        table = json.loads(
            read_text(path, "JSON"),
            parse_float=finite,
            parse_constant=refuse_constant,
            object_pairs_hook=each_once,
        )
    except (ValueError, RecursionError) as error:
        raise InputError(path, "file", f"broken JSON: {error}", what) from None
    if not isinstance(table, dict):
        raise InputError(path, "file", show(table), what)
    for refusal in tree_problems(table):
        raise InputError(path, *refusal)
    return table


def finite(text: str) -> float:
    """A number that a float can hold."""
    value = float(text)
    if not isfinite(value):
        raise ValueError(f"the number {text:.20}, which is too large")
    return value


def refuse_constant(name: str) -> Any:
    """NaN and infinities are no JSON."""
    raise ValueError(f"{name}, which is no number of JSON")


def each_once(pairs: list[tuple[str, Any]]) -> dict:
    """The object of some pairs; a name that is there twice is refused."""
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the name {twice!r:.60} twice in one object")
    return table
