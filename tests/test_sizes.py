"""Sizes that a reader can hold: files, functions and lists of arguments of the packages already put in order."""

import ast
from pathlib import Path

import pytest

import fvcollapse

PACKAGE = Path(fvcollapse.__file__).parent
PACKAGES = ("diagnosis",)  # in order already; the next one is a word more
FILE_LINES, CODE_LINES, ARGUMENTS = 300, 40, 6
# what may be larger, and why; at most ten
EXCEPTIONS = {
    ("diagnosis/diagnose.py", "diagnose", "arguments"): "the public call: one for each option",
}


def files_of(package):
    """Paths of the modules of a package, relative to `fvcollapse`."""
    return sorted(path.relative_to(PACKAGE) for path in (PACKAGE / package).rglob("*.py"))


FILES = [path for package in PACKAGES for path in files_of(package)]


def functions_of(text):
    """All functions and methods in a source text."""
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]


def code_lines(function, lines):
    """Number of lines of a function that are neither blank, nor comment, nor docstring."""
    documented = ast.get_docstring(function) is not None
    first = function.body[0]
    prose = set(range(first.lineno, first.end_lineno + 1)) if documented else set()
    numbers = set(range(function.lineno, function.end_lineno + 1)) - prose
    stripped = (lines[number - 1].strip() for number in numbers)
    return sum(bool(line) and not line.startswith("#") for line in stripped)


def argument_count(function):
    """Number of arguments of a function, without that of the object of a method."""
    arguments = function.args
    names = [a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"]))


def too_large(path, text):
    """(function, what) of every function of a file that is larger than allowed."""
    lines = text.splitlines()
    for function in functions_of(text):
        if code_lines(function, lines) > CODE_LINES:
            yield path.as_posix(), function.name, "lines"
        if argument_count(function) > ARGUMENTS:
            yield path.as_posix(), function.name, "arguments"


@pytest.mark.parametrize("path", FILES, ids=Path.as_posix)
def test_a_file_holds_one_idea(path):
    text = (PACKAGE / path).read_text(encoding="utf-8")
    assert len(text.splitlines()) <= FILE_LINES or (path.as_posix(), "", "lines") in EXCEPTIONS
    assert set(too_large(path, text)) <= set(EXCEPTIONS)


def test_every_exception_is_needed():
    assert len(EXCEPTIONS) <= 10
    needed = {
        name
        for path in FILES
        for name in too_large(path, (PACKAGE / path).read_text(encoding="utf-8"))
    }
    assert {name for name in EXCEPTIONS if name[1]} <= needed


def test_the_count_is_of_code():
    text = 'def f(self, a, *, b):\n    """Prose.\n\n    More.\n    """\n    # a comment\n\n    return a\n'
    (function,) = functions_of(text)
    assert code_lines(function, text.splitlines()) == 2
    assert argument_count(function) == 2
