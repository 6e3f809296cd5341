"""Who may import whom, read off the syntax trees: the package in layers, its studies and figures beside it."""

import ast
from graphlib import TopologicalSorter

from code_modules import ALL, FILES, imported, inner_kernels, kernels
from parsed_code import files_in, tree_of

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


def test_no_private_method_of_a_simulation_is_overridden():
    """Other flows take other stages."""
    for path in files_in(*ALL):
        for node in ast.walk(tree_of(path)):
            bases = {ast.unparse(base) for base in getattr(node, "bases", ())}
            if isinstance(node, ast.ClassDef) and bases & {"Simulation", "UniformFlow", "Box"}:
                methods = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
                private = {name for name in methods if name[0] == "_" and name != "__init__"}
                assert not private, f"{path}: {node.name}"


# -- studies and figures -------------------------------------------------------------------------


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
