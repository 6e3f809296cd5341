"""Syntax trees of the package and of what stands beside it, each file parsed once."""

import ast
from functools import cache
from pathlib import Path

import fvcollapse

PACKAGE = Path(fvcollapse.__file__).parent
ROOT = PACKAGE.parent


@cache
def tree_of(path):
    """The syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def files_in(*folders):
    """All Python files in folders below the root, in order."""
    return tuple(path for name in folders for path in sorted((ROOT / name).rglob("*.py")))
