"""Type hints: all public functions but the compiled ones have them, and the type checker agrees."""

import ast
import subprocess
import sys
from importlib.util import find_spec

import pytest
from parsed_code import PACKAGE, files_in, tree_of
from readme_blocks import ROOT, blocks_of

from fvcollapse.effects.template import effect_template

KERNELS = ("step", "march.py", "measure/pile.py", "measure/series_row.py")  # their text is compiled
FILES = [path.relative_to(PACKAGE).as_posix() for path in files_in("fvcollapse")]
HINTED = [
    name
    for name in FILES
    if not any(name == other or name.startswith(f"{other}/") for other in KERNELS)
]
HOOKS = {"error", "parse_known_args", "submit", "shutdown", "energy"}  # as a base class has them


def public_functions(tree):
    """Public functions of a module, and public methods of its classes."""
    for node in tree.body:
        for function in getattr(node, "body", ()) if isinstance(node, ast.ClassDef) else (node,):
            if isinstance(function, ast.FunctionDef) and not function.name.startswith("_"):
                yield function


def is_hinted(function):
    """Whether all arguments of a function, but that of the object of a method, and its result have hints."""
    of = function.args
    arguments = [*of.posonlyargs, *of.args, *of.kwonlyargs, of.vararg, of.kwarg]
    arguments = [one for one in arguments if one is not None and one.arg not in ("self", "cls")]
    return function.returns is not None and all(one.annotation for one in arguments)


def test_public_functions_have_hints():
    bare = {
        f"{name}: {function.name}"
        for name in HINTED
        for function in public_functions(tree_of(PACKAGE / name))
        if not is_hinted(function) and function.name not in HOOKS
    }
    assert sorted(bare) == []


def test_a_new_effect_begins_with_hints():
    functions = list(public_functions(ast.parse(effect_template("rolling_friction"))))
    assert functions
    assert all(map(is_hinted, functions))


def test_the_package_says_that_it_has_hints():
    assert (PACKAGE / "py.typed").exists()
    assert len(HINTED) > 120


READMES = (
    "README.md",
    *(f"fvcollapse/{name}/README.md" for name in ("output", "measure", "studies")),
)


@pytest.fixture(scope="module")
def checked(tmp_path_factory):
    """Messages of the type checker on the package, and on the Python of the READMEs, a file for each of them.

    What it finds is kept in `.mypy_cache` of the checkout: only what has changed since is checked anew.
    """
    folder, files = tmp_path_factory.mktemp("readme"), []
    for number, name in enumerate(READMES):
        code = [block.code for block in blocks_of(ROOT / name) if block.language == "python"]
        assert code, name
        files.append(folder / f"readme_{number}.py")
        files[-1].write_text("\n".join(code), encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "fvcollapse", *map(str, files)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    lines = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert bool(lines) == bool(done.returncode)
    return lines


@pytest.mark.skipif(find_spec("mypy") is None, reason="mypy is not installed")
def test_the_type_checker_agrees(checked):
    assert [line for line in checked if "readme_" not in line] == []


@pytest.mark.skipif(find_spec("mypy") is None, reason="mypy is not installed")
def test_the_type_checker_agrees_with_the_readmes(checked):
    assert [line for line in checked if "readme_" in line] == []


def test_no_readme_with_python_is_forgotten():
    with_python = {
        path.relative_to(ROOT).as_posix()
        for path in [ROOT / "README.md", *(ROOT / "fvcollapse").rglob("README.md")]
        if any(block.language == "python" for block in blocks_of(path))
    }
    assert with_python == set(READMES)
