"""Which solver this is: its version, and a digest of the code that decides what a run gives."""

import ast
import hashlib
from functools import cache
from pathlib import Path

from fvcollapse.version import __version__

# what the fields, the series and the profiles of a run depend on
SOLVER = (
    "case.py",
    "case_effects.py",
    "effects.py",
    "grid.py",
    "state.py",
    "step",
    "simulation.py",
    "observation.py",
    "observables.py",
    "recorder.py",
)


@cache
def solver_version():
    """The version and a digest, such as "0.1.0+1f0c…": comments and docstrings do not count.

    The text of a statement may depend on the version of Python, so two of them may disagree on the
    digest; they never agree where the code differs.
    """
    digest = hashlib.sha256()
    for path in solver_files():
        digest.update(path.name.encode())
        digest.update(statements(path.read_text(encoding="utf-8")).encode())
    return f"{__version__}+{digest.hexdigest()[:12]}"


def solver_files():
    """The files of the solver, in the order of their names."""
    package = Path(__file__).parent
    places = [package / name for name in SOLVER]
    return [file for place in places for file in sorted(place.rglob("*.py")) or [place]]


def statements(source):
    """The code of a module without comments, docstrings and layout."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node
        ):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree)
