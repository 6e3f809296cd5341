"""Version of the solver: a digest of the code that turns a resolved case into numbers.

The digest is that of a graph. Its nodes are the top-level definitions (functions, classes, constants)
that a run reaches from `ROOTS`, its edges the references between them. It does not depend on the file
in which a definition stands, and it leaves out what cannot change a number:

- comments, docstrings, annotations, layout and imports of the package itself;
- the methods `VIEWS` of a class, which show what it holds;
- the text of an error that is raised;
- the fields of the sections of a case. Their values are part of the resolved case, which stands beside
  the digest in every key of the cache; their units, bounds, defaults and descriptions only decide which
  cases there are. The methods of a section count;
- priors, and what else an `Effect` says of calibration (`NO_NUMBERS`): they decide which cases a
  diagnosis runs, not their results.

An effect that is off changes no bit of a run, which the tests of the catalogue check. The table that
lists the effects (`EFFECT_TABLES`) is therefore no part of the graph. The definition `EFFECT` in
`effects/<effect>.py`, the stages of its term in the step, and what they reach count where the effect is on,
so that a new effect voids no run without it. Code of an effect that is called by name from elsewhere counts for
all cases.

Two versions of Python may disagree on the digest. Two solvers have the same digest only if their
definitions are the same, apart from what is left out.
"""

import ast
import hashlib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.output.code_graph import CodeGraph, called_name, is_docstring, is_import
from fvcollapse.output.known_digests import known_digest
from fvcollapse.version import __version__

PACKAGE = Path(__file__).parents[1]
# (module, definition) that a run starts from: fields, series, profiles and what is observed of them
ROOTS = (
    ("case.case", "Case"),
    ("effects.catalogue", "with_effects"),
    ("simulation", "Simulation"),
    ("output.recorder", "Recorder"),
    ("output.recorder", "schedule"),
    ("measure.observation", "flow_case"),
    ("measure.observables", "observe"),
)
EFFECT_TABLES = ("CATALOGUE",)
OUTSIDE = (
    "errors",
    "files.hdf5",
    "files.kernel_cache",
)  # modules that give no numbers: their names are not followed
CASE_FILE = ("to_toml", "replace")  # methods of a section that read and write case files
PROSE = ("key", "Prior")  # calls that describe a value
VIEWS = ("plot", "to_xarray", "_repr_html_", "__repr__")
EFFECT = "Effect"
NO_NUMBERS = ("priors", "absorbed_in", "refuse", "needs_walls", "zero")  # arguments of it
SECTION, DEFINE_SECTION = "Section", "defstruct"


def solver_version(effects: Sequence[str] | None = None) -> str:
    """The version and a digest, such as "0.1.0+1f0c…".

    Parameters
    ----------
    effects : sequence of str, optional
        Effects that are on, in any order; default all of the catalogue.
    """
    names = tuple(name for name in CATALOGUE if effects is None or name in effects)
    return f"{__version__}+{own_digest(names)[:12]}"


@cache
def own_digest(effects: tuple[str, ...]) -> str:
    """Digest of this solver with these effects, in the order in which they act; see `known_digests`."""
    return known_digest(PACKAGE, " ".join(effects), lambda: solver_digest(PACKAGE, effects))


@cache
def solver_digest(package: Path, effects: tuple[str, ...]) -> str:
    """Digest of the solver in a folder, for a tuple of effects in the order in which they act."""
    code = solver_code(package)
    lines = code.lines([*ROOTS, *(root for name in effects for root in roots_of(code, name))])
    return hashlib.sha256("\n".join([*effects, *lines]).encode()).hexdigest()


@cache
def solver_code(package: Path) -> CodeGraph:
    """The `CodeGraph` of a package; each file is parsed once."""
    return CodeGraph(package, Counted, frozenset(OUTSIDE), frozenset(EFFECT_TABLES))


def roots_of(code: CodeGraph, effect: str) -> list[tuple[str, str]]:
    """Places of the code that acts only while an effect is on: its `EFFECT`, and the stages of its term."""
    module = f"effects.{effect}"
    definition = code.node(module, "EFFECT")
    if definition is None:
        return []
    from fvcollapse.step.terms import Terms  # loads the compiler

    stages = [(f"step.{term_of(definition)}", stage) for stage in Terms._fields]
    return [(module, "EFFECT"), *(place for place in stages if code.node(*place) is not None)]


def term_of(definition: ast.AST) -> str:
    """Module of the step that the definition of an `EFFECT` names; "" without one."""
    keywords = (part for part in ast.walk(definition) if isinstance(part, ast.keyword))
    terms = (part.value for part in keywords if part.arg == "term")
    return next((str(term.value) for term in terms if isinstance(term, ast.Constant)), "")


def is_section(node: ast.AST) -> bool:
    """Whether a statement defines a section of a case."""
    if isinstance(node, ast.Assign):
        return called_name(node.value) == DEFINE_SECTION
    bases = getattr(node, "bases", ()) if isinstance(node, ast.ClassDef) else ()
    return any(isinstance(base, ast.Name) and base.id == SECTION for base in bases)


class Counted(ast.NodeTransformer):
    """Reduces a definition to the text that enters the digest, with definitions under their own names.

    Attributes
    ----------
    target : function
        Of a `Name` or `Attribute`: the place (module, name) of what it names, or None.
    places, names : set
        The places that were named; the names that are none of the package.
    """

    def __init__(self, target: Callable[[ast.AST], tuple[str, str] | None]) -> None:
        self.target = target
        self.places: set[tuple[str, str]] = set()
        self.names: set[str] = set()

    def reduced(self, node: Any) -> str:
        """The text of a definition, "" of a section without methods; `places` is what it refers to."""
        section = is_section(node)
        if section:
            self.note_fields(node)
        if section and isinstance(node, ast.Assign):
            return ""
        if section:
            node.body = [part for part in node.body if is_method(part)]
            if not node.body:
                return ""
        return ast.unparse(self.visit(node))

    def note_fields(self, section: ast.AST) -> None:
        """Note the sections inside a section: their methods count."""
        waiting = [section]
        while waiting:
            node = waiting.pop()
            if isinstance(node, ast.FunctionDef) or called_name(node) in PROSE:
                continue
            if isinstance(node, ast.Name | ast.Attribute):
                self.visit_reference(node)
            waiting += ast.iter_child_nodes(node)

    def visit_reference(self, node: Any) -> ast.AST:
        """A `Name` or `module.name` of the package: the name of the definition; else the node."""
        place = self.target(node)
        if place is None:
            self.names |= {node.id} if isinstance(node, ast.Name) else set()
            return node
        self.places.add(place)
        return ast.Name(place[1], node.ctx)

    visit_Name = visit_reference

    def visit_Attribute(self, node: Any) -> ast.AST:  # noqa: N802
        """An attribute, also of a module of the package."""
        found = self.visit_reference(node)
        return found if found is not node else self.generic_visit(node)

    def visit_body(self, node: Any) -> ast.AST:
        """A function, class or module: without docstrings and imports."""
        node.body = [
            part for part in node.body if not is_docstring(part) and not is_import(part)
        ] or [ast.Pass()]
        return self.generic_visit(node)

    visit_Module = visit_body

    def visit_ClassDef(self, node: Any) -> ast.AST:  # noqa: N802
        """A class: without the methods that show it."""
        node.body = [part for part in node.body if getattr(part, "name", "") not in VIEWS]
        return self.visit_body(node)

    def visit_FunctionDef(self, node: Any) -> ast.AST:  # noqa: N802
        """A function: without the annotation of its result."""
        node.returns = None
        return self.visit_body(node)

    def visit_arg(self, node: Any) -> ast.AST:
        """An argument: its name."""
        node.annotation = None
        return node

    def visit_Raise(self, node: Any) -> ast.AST:  # noqa: N802
        """An error that is raised: its class."""
        if isinstance(node.exc, ast.Call):
            node.exc = node.exc.func
        return self.generic_visit(node)

    def visit_Call(self, node: Any) -> ast.AST:  # noqa: N802
        """A call; None for a call that only describes a value."""
        name = called_name(node)
        if name in PROSE:
            return ast.Constant(None)
        if name == EFFECT:
            node.keywords = [part for part in node.keywords if part.arg not in NO_NUMBERS]
        return self.generic_visit(node)


def is_method(node: ast.AST) -> bool:
    """Whether a statement of a section is a method that gives numbers."""
    return isinstance(node, ast.FunctionDef) and node.name not in CASE_FILE
