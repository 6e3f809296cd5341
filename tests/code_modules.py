"""The modules of the package as their syntax trees show them: what each imports, and its kernels."""

import ast
from functools import cache
from typing import NamedTuple

from parsed_code import PACKAGE, files_in, tree_of


def module_name(path):
    """Dotted name of a file inside the package: `step.gate`, `case`, `__init__`."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if len(parts) > 1 and parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in files_in("fvcollapse")}
ALL = ("fvcollapse", "tests", "runs", "plots")


@cache
def imported(name):
    """Modules of the package that a module imports, also inside its functions."""
    tree = tree_of(FILES[name])
    package = FILES[name].parent.relative_to(PACKAGE.parent).parts
    found, for_hints = set(), hint_imports(tree)
    for node in ast.walk(tree):
        if id(node) in for_hints:
            continue
        if isinstance(node, ast.Import):
            dotted = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            source = ".".join([*base, *([node.module] if node.module else [])])
            dotted = [f"{source}.{alias.name}" for alias in node.names]
        else:
            continue
        for full in dotted:
            top, _, inner = full.partition(".")
            if top == PACKAGE.name:
                found.add(longest_module(inner))
    return found - {name}


def hint_imports(tree):
    """Ids of the imports for type checkers only: what a hint names is no dependency."""
    blocks = (node for node in ast.walk(tree) if isinstance(node, ast.If))
    hints = (node for node in blocks if ast.unparse(node.test) == "TYPE_CHECKING")
    return {id(part) for block in hints for part in ast.walk(block)}


def longest_module(dotted):
    """The module in `module.name`: the longest beginning that is a file; else the package."""
    while dotted and dotted not in FILES:
        dotted = dotted.rpartition(".")[0]
    return dotted or "__init__"


class Kernel(NamedTuple):
    """A compiled function: its name with that of its module, its definition, what compiles it."""

    name: str
    function: ast.FunctionDef
    decorator: ast.AST


@cache
def kernels():
    """Every compiled function."""
    found = []
    for name, path in FILES.items():
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.FunctionDef):
                for decorator in node.decorator_list:
                    if "jit" in ast.unparse(decorator).partition("(")[0]:
                        found.append(Kernel(f"{name}.{node.name}", node, decorator))
    return found


@cache
def inner_kernels():
    """Names of the kernels without an entry for Python, by module of the step."""
    found = {}
    for kernel in kernels():
        module, _, name = kernel.name.rpartition(".")
        if ast.unparse(kernel.decorator).startswith("inner_jit"):
            found.setdefault(module.rpartition(".")[2], set()).add(name)
    return found
