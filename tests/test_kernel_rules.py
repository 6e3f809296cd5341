"""What a kernel may be, read off the syntax trees: cached, exact, of numbers and arrays alone, and who may call it."""

import ast

from code_modules import ALL, inner_kernels, kernels
from parsed_code import PACKAGE, files_in, tree_of

from fvcollapse.files.kernel_cache import KernelCache
from fvcollapse.step import geometry, unknowns

OBJECTS = {"state", "grid", "case", "simulation", "recorder", "result", "self"}


def test_kernels_are_cached_and_exact():
    """Fast arithmetic loses NaN checks; threads may change sums; without a cache each start waits.

    Division by zero may give inf or NaN in place of an error: the sweeps find them in the velocity.
    """
    for name, _, decorator in kernels():
        if isinstance(decorator, ast.Name):  # in `stepper` and `marcher`, which call one of the two
            assert decorator.id == "jit", name
            continue
        assert ast.unparse(decorator.func) in ("kernel_jit", "inner_jit"), name
        options = {option.arg: ast.unparse(option.value) for option in decorator.keywords}
        options.pop("inline", None)
        assert options.pop("error_model", "'numpy'") == "'numpy'", name
        assert not options, name


def test_the_decorators_cache_and_ask_for_no_fast_arithmetic():
    for kernel, wrapper in (
        (geometry.fill_cells, {}),
        (vars(unknowns)["_number"], {"no_cpython_wrapper": True}),
    ):
        assert isinstance(kernel._cache, KernelCache)
        own = {"nopython": True, "boundscheck": None, "no_cfunc_wrapper": True}
        assert kernel.targetoptions == own | wrapper


def calls_outside_kernels(tree, known):
    """Functions that a file calls outside of kernels, as (module of the step, name); `known` are its own."""
    names = {name: (known, name) for name in inner_kernels().get(known, ())}
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            source = (node.module or "").rpartition(".")[2]
            names |= {a.asname or a.name: (source, a.name) for a in node.names}
    inside = {
        id(part)
        for kernel in ast.walk(tree)
        if isinstance(kernel, ast.FunctionDef)
        and "jit" in "".join(map(ast.unparse, kernel.decorator_list))
        for part in ast.walk(kernel)
    }
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or id(node) in inside:
            continue
        called = node.func
        if isinstance(called, ast.Name) and called.id in names:
            found.add(names[called.id])
        if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
            found.add((names.get(called.value.id, ("", called.value.id))[1], called.attr))
    return found


def test_python_calls_no_inner_kernel():
    """It would end the process: these have no entry for Python."""
    for path in files_in(*ALL):
        own = path.stem if path.parent == PACKAGE / "step" else ""
        for module, name in calls_outside_kernels(tree_of(path), own):
            assert name not in inner_kernels().get(module, ()), f"{path} calls {module}.{name}"


def test_kernels_take_numbers_and_arrays_only():
    for name, kernel, _ in kernels():
        arguments = kernel.args
        names = {a.arg for a in [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]}
        assert not names & OBJECTS, name
        assert arguments.vararg is None, name
        assert arguments.kwarg is None, name
        assert not arguments.defaults, name
        used = {node.id for node in ast.walk(kernel) if isinstance(node, ast.Name)}
        assert not used & OBJECTS, name
        assert "prange" not in used, name


def test_kernels_hold_no_strings_dicts_or_closures():
    forbidden = (ast.Dict, ast.DictComp, ast.JoinedStr, ast.Lambda, ast.FunctionDef, ast.Global)
    for name, kernel, _ in kernels():
        letters = {  # ord("L") is a number to the compiler
            id(argument)
            for node in ast.walk(kernel)
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "ord"
            for argument in node.args
        }
        body = kernel.body[1:] if ast.get_docstring(kernel) else kernel.body
        for node in (node for statement in body for node in ast.walk(statement)):
            assert not isinstance(node, forbidden), f"{name}, line {node.lineno}"
            is_text = isinstance(node, ast.Constant) and isinstance(node.value, str | bytes)
            assert not is_text or id(node) in letters, f"{name}, line {node.lineno}"
