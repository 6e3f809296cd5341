"""The top-level definitions of a package and the references between them, read off its syntax trees.

A definition stands at a place: (dotted name of the module below the package, name). The statements of a
module that define nothing stand together at (module, "").
"""

import ast
import hashlib
from collections import deque
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

BLOCKS = ("body", "handlers", "orelse", "finalbody", "cases")  # where a statement holds others


class Part(NamedTuple):
    """The part of a definition that enters a digest.

    Attributes
    ----------
    digest : str
        "" if no part enters it.
    places : set of (str, str)
        The definitions that it refers to.
    statements : set of (str, str)
        The statements that run when its module is imported.
    """

    digest: str
    places: set
    statements: set


class CodeGraph:
    """The definitions of a package and what they refer to.

    Attributes
    ----------
    package : Path
    reducer : class
        Made for every definition with a function (node -> place or None). Its `reduced(node)` returns the
        text that counts and may change the node; afterwards its `places` are the definitions of the
        package that were named, and its `names` the other names.
    outside : collection of str
        Modules whose definitions are not followed.
    cut : collection of str
        Names of definitions that are not followed.
    """

    def __init__(
        self,
        package: str | Path,
        reducer: Any,
        outside: Collection[str] = (),
        cut: Collection[str] = (),
    ) -> None:
        self.package, self.reducer, self.outside, self.cut = Path(package), reducer, outside, cut
        self._modules: dict[str, Module | None] = {}
        self._parts: dict[int, Part] = {}

    def lines(self, roots: Iterable[tuple[str, str]]) -> list[str]:
        """A line for each definition that the roots lead to, sorted: its digest, and those it refers to.

        Raises
        ------
        LookupError
            A root is not in the package.
        """
        parts = [self.part(place) for place in self.reached(roots)]
        neighbours = (
            sorted({self.part(place).digest for place in part.places} - {""}) for part in parts
        )
        pairs = zip(parts, neighbours, strict=True)
        return sorted({" ".join([part.digest, *others]) for part, others in pairs if part.digest})

    def reached(self, roots: Iterable[tuple[str, str]]) -> set[tuple[str, str]]:
        """All places that some places lead to, themselves included."""
        reached, waiting = set(), []
        for root in roots:
            place = self.resolved(*root)
            if place is None:
                raise LookupError(f"{self.package}: no definition {'.'.join(root)}")
            waiting.append(place)
        while waiting:
            place = waiting.pop()
            if place not in reached:
                reached.add(place)
                waiting += self.part(place).places | self.part(place).statements
        return reached

    def part(self, place: tuple[str, str]) -> Part:
        """The `Part` of the definition at a place."""
        node = self.node(*place)
        if id(node) not in self._parts:  # a definition is changed in being reduced
            self._parts[id(node)] = self._reduce(place, node)
        return self._parts[id(node)]

    def _reduce(self, place, node):
        module, foreign = place[0], self.module(place[0]).foreign
        reducer = self.reducer(lambda name: self.target(module, name))
        text = reducer.reduced(node)
        origins = [f"{name} is {foreign[name]}" for name in sorted(reducer.names & set(foreign))]
        content = "\n".join([text, *origins])
        digest = hashlib.sha256(content.encode()).hexdigest() if text else ""
        places = {other for other in reducer.places if other[1] not in self.cut}
        return Part(digest, places, self.statements_of(module))

    def statements_of(self, module: str) -> set[tuple[str, str]]:
        """Places of the statements that run when a module is imported, those of its packages included."""
        parts = module.split(".")
        modules = ["", *(".".join(parts[: n + 1]) for n in range(len(parts)))]
        return {(name, "") for name in modules if self.node(name, "") is not None}

    def node(self, module: str, name: str) -> Any:
        """The statement at a place; None if there is none."""
        found = self.module(module)
        return None if found is None else found.definitions.get(name)

    def module(self, name: str) -> Any:
        """The `Module` of a dotted name; None if there is no such file."""
        if name not in self._modules:
            path = self.package.joinpath(*name.split("."))
            files = [path / "__init__.py", *([path.with_suffix(".py")] if name else [])]
            found = next((file for file in files if file.is_file()), None)
            self._modules[name] = None if found is None else Module(found, name, self.package.name)
        return self._modules[name]

    def resolved(self, module: str, name: str) -> tuple[str, str] | None:
        """Place where a name of a module is defined, imports followed; None outside of the package."""
        found = self.module(module)
        if found is None or module in self.outside:
            return None
        if name in found.definitions:
            return module, name
        source = found.imports.get(name)
        return None if source is None else self.resolved(*source)

    def target(self, module: str, node: ast.AST) -> tuple[str, str] | None:
        """Place that a node names in a module: `name`, or `module.name`; else None."""
        if isinstance(node, ast.Name):
            return self.resolved(module, node.id)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            source = self.module(module).imports.get(node.value.id)
            if source is not None:
                return self.resolved(".".join(part for part in source if part), node.attr)
        return None


class Module:
    """A parsed file.

    Attributes
    ----------
    definitions : dict
        Name -> statement; under "" all statements that define nothing.
    imports : dict
        Name -> (module of the package, name in it; "" for the package itself).
    foreign : dict
        Name -> dotted name of what was imported from another package.
    """

    def __init__(self, path: Path, name: str, package: str) -> None:
        self.definitions: dict[str, ast.AST] = {}
        self.imports: dict[str, tuple[str, str]] = {}
        self.foreign: dict[str, str] = {}
        parents = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
        self.parents = [part for part in (package, *parents) if part]
        tree, others = ast.parse(path.read_text(encoding="utf-8")), []
        for node in tree.body:
            names = defined_names(node)
            for defined in names:
                self._define(defined, node)
            if not names and not (is_import(node) or is_docstring(node) or is_typing(node)):
                others.append(node)
        if others:
            self.definitions[""] = statements = ast.Module(others, [])
            for defined in bound_names(statements):  # under a condition, in a loop
                self._define(defined, statements)
        for statement in filter(is_import, statements_in(tree)):
            self._add_import(statement)

    def _define(self, name, node):
        before = self.definitions.get(name)
        both = before is not None and before is not node
        self.definitions[name] = ast.Module([before, node], []) if both else node

    def _add_import(self, node):
        level = getattr(node, "level", 0)
        base = self.parents[: len(self.parents) + 1 - level] if level else []
        base = [*base, *filter(None, (getattr(node, "module", None) or "").split("."))]
        for alias in node.names:
            name, dotted = alias.asname or alias.name, [*base, *alias.name.split(".")]
            if dotted[0] == self.parents[0]:
                self.imports[name] = ".".join(dotted[1:-1]), dotted[-1]
            else:
                self.foreign[name] = ".".join(dotted)


def statements_in(tree: ast.AST) -> Iterator[ast.AST]:
    """The statements of a tree, those inside others included; expressions, which are most nodes, are not visited."""
    waiting = deque([tree])
    while waiting:
        node = waiting.popleft()
        for name in BLOCKS:
            inside = getattr(node, name, ())
            yield from inside
            waiting.extend(inside)


def defined_names(node: ast.AST) -> list[str]:
    """Names that a top-level statement defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    targets = {ast.Assign: "targets", ast.AnnAssign: "target"}.get(type(node))
    if targets is None:
        return []
    found = getattr(node, targets)
    found = found if isinstance(found, list) else [found]
    if not all(isinstance(target, ast.Name | ast.Tuple) for target in found):
        return []  # x.y = …, x[y] = …
    return [part.id for target in found for part in ast.walk(target) if isinstance(part, ast.Name)]


def bound_names(node: ast.AST) -> set[str]:
    """Names that a statement binds anywhere inside."""
    definitions = ast.FunctionDef | ast.ClassDef
    names = {part.name for part in ast.walk(node) if isinstance(part, definitions)}
    bound = (part for part in ast.walk(node) if isinstance(getattr(part, "ctx", None), ast.Store))
    return names | {part.id for part in bound if isinstance(part, ast.Name)}


def is_import(node: ast.AST) -> bool:
    """Whether a statement is an import."""
    return isinstance(node, ast.Import | ast.ImportFrom)


def is_typing(node: ast.AST) -> bool:
    """Whether a statement is for type checkers only: `if TYPE_CHECKING:`."""
    return isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING"


def is_docstring(node: ast.AST) -> bool:
    """Whether a statement is a text and nothing else."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def called_name(node: ast.AST | None) -> str:
    """Last part of the name that a node calls: `f` of `f(...)` and of `m.f(...)`; else ""."""
    function = node.func if isinstance(node, ast.Call) else None
    return getattr(function, "attr", getattr(function, "id", ""))
