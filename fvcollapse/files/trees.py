"""Nested plain values out of a file or a command line: how deep they may go, and that texts are texts.

A parser takes hundreds of levels, and Python decodes bytes that are no UTF-8 into lone surrogates. Both
break what comes later, far from the input. `tree_problems` finds them without recursion.
"""

import re
from collections.abc import Iterable, Iterator

SURROGATE = re.compile("[\ud800-\udfff]")
DEPTH_MAX = 20  # levels; the deepest file that the package writes has ten
# a name of TOML of 50 parts, a.a.a…: the parser takes a time that grows with the square of their number
ENDLESS_NAME = re.compile(r"""(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){50}""")


def is_text(word: str) -> bool:
    """Whether a string can be written as UTF-8: it holds no lone surrogates."""
    return SURROGATE.search(word) is None


def is_deep(tree: object) -> bool:
    """Whether lists and tables are nested deeper than `DEPTH_MAX` levels."""
    level = [tree]
    for _ in range(DEPTH_MAX + 1):
        level = [part for node in level for part in parts(node)]
    return bool(level)


def parts(node: object) -> Iterable:
    """What is inside a list or a table; nothing for other values."""
    if isinstance(node, dict):
        return node.values()
    return node if isinstance(node, list | tuple) else ()


def tree_problems(table: dict) -> Iterator[tuple[str, str, str]]:
    """(key, what was found, what is allowed) of everything in a table that no later step can take.

    Parameters
    ----------
    table : dict
        Nested dictionaries and lists of plain values.

    Yields
    ------
    tuple of str
    """
    todo = [(str(name), value, 1) for name, value in table.items()]
    while todo:
        path, value, depth = todo.pop()
        if not is_text(path):
            yield path, "a name that is not UTF-8", "names in UTF-8"
        elif isinstance(value, str) and not is_text(value):
            yield path, "a text that is not UTF-8", "text in UTF-8"
        elif depth > DEPTH_MAX and isinstance(value, dict | list | tuple):
            name = path if len(path) <= 60 else path[:57] + "..."
            yield name, f"values nested {depth} levels deep", f"at most {DEPTH_MAX} levels"
        elif isinstance(value, dict):
            todo += [(f"{path}.{name}", inner, depth + 1) for name, inner in value.items()]
        elif isinstance(value, list | tuple):
            todo += [(path, inner, depth + 1) for inner in value]
