"""The grammar of a case file: what a key says of itself, the table of all keys, values as TOML."""

import json
import tomllib
from collections.abc import Iterator
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

import msgspec

from fvcollapse.errors import InputError
from fvcollapse.files.misfit import UNKNOWN, first_misfit
from fvcollapse.files.regular import problem_words, read_regular
from fvcollapse.files.trees import DEPTH_MAX, ENDLESS_NAME, is_deep, tree_problems

LIMIT_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


class Section(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A table of the case file: unknown keys refused, no silent conversion, never changed."""


def key(
    unit: str,
    description: str,
    allowed: str | None = None,
    inf: bool = False,
    most: float | None = None,
    **limits: Any,
) -> msgspec.Meta:
    """What a user must know of a key of the case file, beside its type and default.

    Parameters
    ----------
    unit, description : str
        Unit ("-" if none) and meaning, one line.
    allowed : str, optional
        Range in words; without it the words follow from the type and the limits.
    inf : bool
        Whether `inf` is a legal value; otherwise numbers are finite. NaN never is legal.
    most : float, optional
        Largest finite value of a key that may be inf.
    **limits : float
        Range: gt, ge, lt, le.
    """
    ends = limits if most is None else limits | {"le": most}
    words = " and ".join(f"{LIMIT_SIGNS[name]} {limit:g}" for name, limit in ends.items())
    words = allowed or words + (", or inf" if inf else "")
    extra = {"unit": unit, "allowed": words, "inf": inf, "most": most}
    return msgspec.Meta(description=description, extra=extra, **limits)


class KeyInfo(NamedTuple):
    """One row of the table of keys."""

    name: str
    unit: str
    allowed: str
    default: str
    description: str


# -- reading -----------------------------------------------------------------------------------


def read_text(path: str | Path, kind: str, refuse: type[InputError] = InputError) -> str:
    """Text of a file; a defect is one error of the type `refuse`, which asks for `kind`."""
    return decode_text(read_bytes(path, kind, refuse), path, refuse)


def read_bytes(path: str | Path, kind: str, refuse: type[InputError] = InputError) -> bytes:
    """Bytes of a regular file; a defect is one error of the type `refuse`, which asks for `kind`."""
    try:
        return read_regular(path)
    except (OSError, ValueError) as error:
        raise refuse(path, "file", problem_words(error), f"a readable {kind} file") from None


def decode_text(data: bytes, path: str | Path, refuse: type[InputError] = InputError) -> str:
    """The text in bytes of the file `path`: UTF-8, with or without a byte order mark."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        found = f"a byte that is not UTF-8 at offset {error.start}"
        raise refuse(path, "file", found, "UTF-8 text") from None


def parse_toml(text: str, source: str | Path, refuse: type[InputError] = InputError) -> dict:
    """Nested dictionaries of a TOML text; a defect is one error of the type `refuse`."""
    if ENDLESS_NAME.search(text):
        found = "a name of more than 50 parts"
        raise refuse(source, "file", found, f"at most {DEPTH_MAX} levels")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # broken, a number too long, nested too deep
        raise refuse(source, "file", f"broken TOML: {error}", "valid TOML") from None


def convert(table: dict, model: Any) -> tuple[Any, list[tuple[str, str, str]]]:
    """(a model of nested dictionaries or None, what is refused in them).

    What is refused is a list of (key, what was found, what is allowed): of values nested too deep, of
    texts that are no UTF-8, and of the first value that has not the type or the range of its key.
    """
    refused = list(tree_problems(table))
    if refused:
        return None, refused
    misfit = first_misfit(table, model)
    if misfit is not None:
        return None, [refusal_of_type(misfit, model)]
    return msgspec.convert(table, model), []


# -- the table of all keys ---------------------------------------------------------------------


@cache
def sections(model: Any, prefix: str = "") -> tuple[tuple[str, Any], ...]:
    """Each table inside a model as (dotted name, model), outer before inner."""
    found = []
    for name, hint in get_type_hints(model).items():
        for part in (hint, *get_args(hint)):
            if isinstance(part, type) and issubclass(part, Section):
                found += [(prefix + name, part), *sections(part, f"{prefix}{name}.")]
    return tuple(found)


@cache
def key_metas(model: Any) -> dict:
    """The `key(...)` of each key of one table, by name."""
    metas = {}
    for name, hint in get_type_hints(model, include_extras=True).items():
        for part in (hint, *get_args(hint)):  # hint is Annotated[...] or Annotated[...] | None
            for meta in getattr(part, "__metadata__", ()):
                metas[name] = meta
    return metas


@cache
def key_table(model: Any) -> dict[str, KeyInfo]:
    """KeyInfo of all keys inside a model, as {dotted name: KeyInfo}, in the order of the model."""
    rows = {}
    for section, inner in (("", model), *sections(model)):
        for key_name, meta in key_metas(inner).items():
            default = getattr(inner(), key_name)
            name = f"{section}.{key_name}".removeprefix(".")
            rows[name] = KeyInfo(
                name=name,
                unit=meta.extra["unit"],
                allowed=allowed_words(get_type_hints(inner)[key_name], meta),
                default="absent" if default is None else toml_value(default),
                description=meta.description,
            )
    return rows


@cache
def table_names(model: Any) -> set[str]:
    """Dotted names of all tables inside a model."""
    return {name for name, _ in sections(model)}


def allowed_words(hint: Any, meta: msgspec.Meta) -> str:
    """What a key accepts, in words: from its type and its limits."""
    if get_origin(hint) is Literal:
        return " or ".join(toml_value(choice) for choice in get_args(hint))
    if hint is bool:
        return "true or false"
    if hint is str:
        return "text"
    words = (meta.extra or {})["allowed"]
    if words.startswith("a list"):
        return words
    return f"a {'whole ' if hint is int else ''}number {words}"


def closest(path: str, model: Any) -> str:
    """The key or table of a model most like a path: a near miss in the same table first, ...

    ... then the same last word in another table, then the nearest spelling.
    """
    names = [*key_table(model), *sorted(table_names(model))]
    parent, _, last = path.rpartition(".")
    siblings = [name for name in names if name.rpartition(".")[0] == parent]
    same_word = [name for name in names if name.rpartition(".")[2] == last]
    for candidates, cutoff in ((siblings, 0.8), (same_word, 0.0), (siblings or names, 0.0)):
        if match := get_close_matches(path, candidates, n=1, cutoff=cutoff):
            return match[0]
    return names[0]


def closest_name(name: str, names: list[str]) -> str:
    """The name most like another one."""
    return (get_close_matches(name, names, n=1, cutoff=0.0) or names)[0]


def refusal_of_type(misfit: Any, model: Any) -> tuple[str, str, str]:
    """(key, what was found, what is allowed) of the first value of a table that does not fit its model."""
    names = [step for step in misfit.steps if isinstance(step, str)]
    indices = "".join(f"[{step}]" for step in misfit.steps if isinstance(step, int))
    name = ".".join(names)
    if misfit.form is UNKNOWN:
        return name, "an unknown key", f"the closest key is {closest(name, model)}"
    info = key_table(model).get(name)
    found = show(misfit.value) + (f" at {indices}" if indices else "")
    return name, found, info.allowed if info else "a table"


# -- values ------------------------------------------------------------------------------------


def as_table(section: Section) -> dict:
    """Nested dictionaries of a case; what is absent (None) is left out."""
    values = {name: getattr(section, name) for name in section.__struct_fields__}
    return {
        name: as_table(value) if isinstance(value, Section) else value
        for name, value in values.items()
        if value is not None
    }


def plain(value: Any) -> Any:
    """Numbers and arrays of numpy as plain numbers and lists."""
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value.tolist() if hasattr(value, "tolist") else value


def toml_lines(table: dict, prefix: str = "") -> Iterator[str]:
    """Nested dictionaries as lines of TOML: the plain keys of a table first, then its tables."""
    for name, value in table.items():
        if not isinstance(value, dict):
            yield f"{name} = {toml_value(value)}"
    for name, value in table.items():
        if isinstance(value, dict):
            yield f"\n[{prefix}{name}]"
            yield from toml_lines(value, f"{prefix}{name}.")


def toml_value(value: Any) -> str:
    """A value as TOML text; floats to the last bit."""
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int):  # Python refuses to print decimal integers of thousands of digits
        return str(value) if abs(value) < 10**18 else hex(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    return "{...}" if isinstance(value, dict) else str(value)


def show(value: Any) -> str:
    """A value and its type in a few words."""
    if isinstance(value, dict):
        return "a table"
    if is_deep(value):
        return f"a list of more than {DEPTH_MAX} levels"
    kinds = {str: "the string ", bool: "the boolean ", list: "the list ", tuple: "the list "}
    text = toml_value(value)
    return kinds.get(type(value), "") + (text if len(text) <= 60 else text[:57] + "...")
