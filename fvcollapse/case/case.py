"""The case: everything a run depends on, from a TOML file, validated, frozen.

Only what differs from the defaults need be written. The defaults are the paper's Table I at 22°,
w = 10 cm, 6 mm, without any effect; a section `[effects.<name>]`, even empty, switches that effect
on. SI units throughout, degrees only where a key ends in `_deg`. Each key keeps its unit, range,
default and meaning in its section (`sections.py`, `effects/<name>.py`; `describe_keys()`, `fvcollapse keys`).
"""

import tomllib
from collections.abc import Collection, Sequence
from functools import cached_property
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from fvcollapse.case.grammar import (
    Section,
    as_table,
    closest,
    convert,
    key_table,
    parse_toml,
    plain,
    read_text,
    show,
    table_names,
    toml_lines,
)
from fvcollapse.case.rules import RULES
from fvcollapse.case.sections import Boundary, Front, Gate, Geometry, Grid, Numerics, Rheology, Time
from fvcollapse.effects.catalogue import CATALOGUE, with_effects
from fvcollapse.errors import CaseError
from fvcollapse.files.trees import ENDLESS_NAME, is_text

if TYPE_CHECKING:
    from fvcollapse.case.grammar import KeyInfo


GRAVITY = 9.81  # m/s2, fixed
LONGEST_STEP = 0.02  # of a case that states none, in sqrt(height_0 / g)
DOMAIN_MAX = (
    100.0  # of height and length of the column: a collapse that stops runs out a tenth of it
)


if TYPE_CHECKING:
    Effects = Any

# built from the catalogue; `nonlocal` is a word of Python, which no class body can declare
Effects = msgspec.defstruct(
    "Effects",
    [(name, effect.section | None, None) for name, effect in CATALOGUE.items()],
    bases=(Section,),
    module=__name__,
    namespace={"__doc__": "What is added to the physics that the user believes; absent = off."},
    kw_only=True,
    frozen=True,
    forbid_unknown_fields=True,
)


class Case(Section, dict=True):
    """A whole case.

    Build it with `load_case`, `case_from_text` or `Case.replace`: they check, and name what they
    refuse. `Case()` is the default case.
    """

    geometry: Geometry = Geometry()
    grid: Grid = Grid()
    rheology: Rheology = Rheology()
    boundary: Boundary = Boundary()
    gate: Gate = Gate()
    front: Front = Front()
    time: Time = Time()
    numerics: Numerics = Numerics()
    effects: Effects = Effects()

    @cached_property
    def resolved(self) -> "Case":
        """The case that the solver runs: its effects on keys are put into the keys that they change.

        It is its own resolved case.
        """
        return with_effects(self)

    @property
    def longest_step(self) -> float:
        """Longest time step [s]."""
        return self.time.step_max or LONGEST_STEP * sqrt(self.geometry.height_0 / GRAVITY)

    @property
    def domain_max(self) -> float:
        """Greatest length to which the domain grows [m]."""
        geometry, boundary = self.geometry, self.boundary
        absent = DOMAIN_MAX * (geometry.height_max + max(geometry.length_max, geometry.length_0))
        return boundary.domain_max or max(absent, boundary.domain_length or 0.0)

    def to_toml(self) -> str:
        """The full resolved case as TOML text; `case_from_text` reads back an equal case."""
        return "\n".join(toml_lines(as_table(self))).lstrip() + "\n"

    def replace(self, **changes: Any) -> "Case":
        """A case with some keys changed: `case.replace(**{"grid.cell_size": 0.004})`.

        Checked like a file. None stands for the default of a key, or for an effect that is off;
        {} switches an effect on.
        """
        table = as_table(self)
        for path, value in changes.items():
            set_path(table, path, plain(value), "Case.replace", tables_allowed=True)
        return case_from_table(table, "Case.replace")


def describe_keys() -> "list[KeyInfo]":
    """All keys of the case file: a list of KeyInfo (name, unit, allowed, default, description)."""
    return list(key_table(Case).values())


def load_case(path: str | Path, overrides: Sequence[str] = ()) -> Case:
    """The case in a TOML file, with overrides on top.

    Parameters
    ----------
    path : str or Path
        Case file, UTF-8.
    overrides : sequence of str
        "section.key=VALUE"; VALUE is parsed as TOML, else taken as a string. The last one wins.

    Raises
    ------
    CaseError
        One line that names file, key, what was found and what is allowed.
    """
    text = read_text(path, "TOML", CaseError)
    return case_from_text(text, path, overrides)


def case_from_text(text: str, source: str | Path = "case", overrides: Sequence[str] = ()) -> Case:
    """The case in a TOML text; `source` is the file name that errors give."""
    table = parse_toml(text, source, CaseError)
    overridden = set()
    for override in overrides:
        if not is_text(override):
            raise CaseError(source, f"--set {override}", "a byte that is not UTF-8", "UTF-8 text")
        path, equals, value = (part.strip() for part in override.partition("="))
        if not (path and equals):
            found = "no key before '='" if equals else "no '='"
            raise CaseError(source, f"--set {override}", found, "--set section.key=VALUE")
        set_path(table, path, parse_value(value), f"{source} with --set {override}")
        overridden.add(path)
    return case_from_table(table, source, overridden)


def case_from_table(
    table: dict, source: str | Path = "case", overridden: Collection[str] = ()
) -> Case:
    """The case in nested dictionaries; `overridden` are the keys that came from `--set`."""
    case, refused = convert(table, Case)
    if not refused:
        refused = [refusal for rule in RULES for refusal in rule(case)]
    if not refused:  # what the effects make of the case must be a case too
        refused = [refusal for rule in RULES for refusal in rule(case.resolved)]
    for name, found, allowed in refused:
        origin = f"{source} with --set {name}" if name in overridden else source
        raise CaseError(origin, name, found, allowed)
    return case


def parse_value(text: str) -> Any:
    """VALUE of an override: parsed as TOML, else the text itself."""
    if ENDLESS_NAME.search(text):
        return text
    try:
        table = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return table["value"] if table.keys() == {"value"} else text


def set_path(
    table: dict, path: str, value: Any, source: str | Path, tables_allowed: bool = False
) -> None:
    """Set a dotted key in nested dictionaries; a path that is no key, or a table, is refused."""
    keys, tables = set(key_table(Case)), table_names(Case)
    if path not in keys | tables:
        hint = f"the closest key is {closest(path, Case)}"
        raise CaseError(source, path, "a path that is no key", hint)
    if path in tables and not tables_allowed:
        inside = sorted(name for name in keys | tables if name.rpartition(".")[0] == path)
        hint = f"a table cannot be set to a value; set one of {', '.join(inside)}"
        raise CaseError(source, path, show(value), hint)
    *parents, last = path.split(".")
    for depth, name in enumerate(parents, start=1):
        table = table.setdefault(name, {})
        if not isinstance(table, dict):
            raise CaseError(source, ".".join(parents[:depth]), show(table), "a table")
    if value is None:
        table.pop(last, None)
    else:
        table[last] = value
