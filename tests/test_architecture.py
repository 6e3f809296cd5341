"""The shape of the code, read off its syntax trees: who may import whom, and what a kernel may be."""

import ast
from functools import cache
from graphlib import TopologicalSorter
from typing import NamedTuple

from parsed_code import PACKAGE, files_in, tree_of

from fvcollapse.files.kernel_cache import KernelCache
from fvcollapse.step import geometry, unknowns

# The data flow, which is the import rule: a line may import only from lines above it.
LAYERS = (
    "errors version",
    "files",
    "console",
    "case.grammar case.limits case.well_posed",
    "effects.effect effects.conditions",
    "effects",
    "effects.catalogue",
    "effects.table effects.template",
    "case.rules",
    "case",
    "step",
    "draw.html draw.look",
    "draw.drawing",
    "measure.quantities",
    "draw.grains draw.curves",
    "draw.figures",
    "measure",
    "march",
    "simulation",
    "output",
    "draw",
    "studies",
    "verification",
    "diagnosis",
    "diagnosis.report",
    "diagnosis.diagnose",
    "blind",
    "cache observation",
    "__init__",
    "commands",
    "__main__",
)
RANK = {name: rank for rank, line in enumerate(LAYERS) for name in line.split()}
OBJECTS = {"state", "grid", "case", "simulation", "recorder", "result", "self"}


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


def test_the_checks_see_the_code():
    """A renamed folder or decorator must not make the tests below pass by finding nothing."""
    assert len(kernels()) > 50
    assert sum(map(len, inner_kernels().values())) > 50
    assert imported("step.quantities") >= {"step.strain"}
    assert imported("simulation") >= {"step.advance", "step.initial"}
    assert len(files_in("runs")) > 50
    assert len(files_in("plots")) > 10


def room(name):
    """The entry of `LAYERS` that a module belongs to: the longest beginning of its name that has one."""
    while name and name not in RANK:
        name = name.rpartition(".")[0]
    return name


def test_every_module_has_a_layer():
    assert {room(name) for name in FILES} == set(RANK)


def points_upwards(name, other):
    """Whether one module may import another."""
    if other == "__init__":  # the package itself
        return name == "__main__"
    return room(other) == room(name) or RANK[room(other)] < RANK[room(name)]


def test_imports_point_upwards():
    pairs = [(name, other) for name in FILES for other in imported(name)]
    assert len(pairs) > len(FILES)
    assert [pair for pair in pairs if not points_upwards(*pair)] == []


def test_the_root_of_the_package_holds_few_modules():
    beside = {name for name in FILES if "." not in name and FILES[name].name != "__init__.py"}
    assert len(beside - {"__main__"}) <= 8


SHARED = {"runs.study", "runs.table"}
OF_PAPER = ("paper_beds", "paper_verdicts")
NAMES_OF_PAPER = tuple(
    f"runs.paper.{name}" for name in ("beds", "cases", "settled", "statements", "verdicts")
)
BORROWED = {
    ("paper_case", "runs.experiments.convert"),  # bounds that a paper prints
    ("laboratories", "runs.experiments.convert"),  # how an experiment folder is written
    ("laboratories", "runs.cross_code.study"),  # how an answer is named and kept
    ("runs", "runs.paper.settled"),  # names of readings, for the README of the paper
    ("runs", "runs.paper.verdicts"),
    ("runs", "runs.cross_code.study"),
    ("runs", "runs.laboratories.study"),  # names of the laboratories, for their README
    ("runs", "runs.paper_facts.sets"),  # names of sets and variants, for theirs
    ("runs", "runs.paper_facts.study"),
    ("runs", "runs.particle_laboratory.thin_layers"),
    ("runs", "runs.particle_laboratory.walls"),
}


def imports_outside(path):
    """Dotted names that a file of `runs` or `plots` imports, `from a import b` as a.b and as a."""
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            yield from (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))


def test_a_study_imports_no_figure_and_no_other_study():
    """They share the call, the runs and the tables; figures are drawn from the tables afterwards."""
    modules = {f"runs.{file.parent.name}.{file.stem}" for file in files_in("runs")} - SHARED
    for path in files_in("runs"):
        own = path.parent.name
        for name in imports_outside(path):
            assert not name.startswith("plots"), f"{path} imports {name}"
            if name in modules and not name.startswith(f"runs.{own}."):
                assert (own, name) in BORROWED, f"{path} imports {name}"


def test_a_figure_imports_no_study():
    """It reads tables; figures of the paper also read how its beds and readings are named and judged."""
    for path in files_in("plots"):
        for name in imports_outside(path):
            if name.startswith("runs."):
                known = ("runs.table", *(NAMES_OF_PAPER if path.stem in OF_PAPER else ()))
                assert name.startswith(known), f"{path} imports {name}"


def test_no_import_cycle():
    graph = {name: imported(name) for name in FILES}
    tuple(TopologicalSorter(graph).static_order())  # raises CycleError


def test_the_step_reads_and_writes_no_files():
    step = [path for name, path in FILES.items() if name.startswith("step.")]
    assert len(step) > 50
    for path in step:
        nodes = [node for node in ast.walk(tree_of(path)) if isinstance(node, ast.Call)]
        assert "h5py" not in path.read_text(encoding="utf-8"), path
        assert not {"open", "print"} & {ast.unparse(node.func) for node in nodes}, path


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


# -- sizes ---------------------------------------------------------------------------------------


def test_no_private_method_of_a_simulation_is_overridden():
    """Other flows take other stages."""
    for path in files_in(*ALL):
        for node in ast.walk(tree_of(path)):
            bases = {ast.unparse(base) for base in getattr(node, "bases", ())}
            if isinstance(node, ast.ClassDef) and bases & {"Simulation", "UniformFlow", "Box"}:
                methods = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
                private = {name for name in methods if name[0] == "_" and name != "__init__"}
                assert not private, f"{path}: {node.name}"
