"""Plain values from a JSON file against the form they must have, given as types of msgspec.

Keys that a form does not name are allowed: a later version may write more.
"""

import copy
import re
from collections.abc import Iterator
from typing import Any

import msgspec

from fvcollapse.case.grammar import show

PLACE = re.compile(r" - at `\$(.*)`$", re.DOTALL)
WORDS = {"array": "a list", "object": "a table", "float": "a number", "int": "a whole number"}
WORDS |= {"str": "text", "bool": "true or false"}
STEP = re.compile(r"\.(\w+)|\[(\d+)\]|(\[\.\.\.\])")


def form_problems(tree: Any, form: Any) -> Iterator[tuple[str, str, str]]:
    """(key, what was found, what is allowed) of the first value that does not fit; nothing if all do.

    Parameters
    ----------
    tree : object
        Plain values; not changed.
    form : type

    Yields
    ------
    tuple of str
    """
    message = misfit(tree, form)
    if message is None:
        return
    steps: list = []
    tree = copy.deepcopy(tree)
    while True:
        path = steps_of(message)
        blind = next((n for n in range(len(steps), len(path)) if path[n] is None), len(path))
        steps += path[len(steps) : blind]
        if blind == len(path):
            break
        table = value_at(tree, steps)  # msgspec does not tell which key of a table of equal values
        key, message = blame(tree, table, form, path[: blind + 1])
        steps.append(key)
    value = value_at(tree, steps)
    yield ".".join(map(str, steps)), show(value), allowed_by(message)


def misfit(tree: Any, form: Any) -> str | None:
    """What msgspec says of a tree that does not fit, else None."""
    try:
        msgspec.convert(tree, form)
    except msgspec.ValidationError as error:
        return str(error)
    return None


def steps_of(message: str) -> list:
    """Keys and indices on the way to the value that a message is about; None for an unknown key."""
    place = PLACE.search(message)
    found = STEP.findall(place.group(1)) if place else []
    return [name or (int(index) if index else None) for name, index, _ in found]


def blame(tree: Any, table: dict, form: Any, path: list) -> tuple[Any, str]:
    """(key, message) of the entry of a table inside a tree that is at fault; the others are removed.

    `path` are the steps to it: what is wrong elsewhere in the tree is no fault of an entry.
    """
    entries = dict(table)
    for key, value in entries.items():
        table.clear()
        table[key] = value
        message = misfit(tree, form)
        if message is not None and steps_of(message)[: len(path)] == path:
            return key, message
    raise ValueError("a table that fits")  # unreachable: msgspec has refused one of its entries


def value_at(tree: Any, steps: list) -> Any:
    """The value at the end of the steps."""
    for step in steps:
        tree = tree[step]
    return tree


def allowed_by(message: str) -> str:
    """What a message of msgspec says is allowed."""
    words = PLACE.sub("", message)
    expected = re.fullmatch(r"Expected (.*?)(, got .*)?", words, re.DOTALL)
    words = expected.group(1) if expected else words[:1].lower() + words[1:]
    types = re.sub(r"\b(array|object|float|int|str|bool)\b(?! missing)", spoken, words)
    return types.replace("`", "").replace("|", "or")


def spoken(match: re.Match) -> str:
    """The name of a type in words."""
    return WORDS[match.group(0)]
