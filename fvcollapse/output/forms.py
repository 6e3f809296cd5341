"""Plain values from a JSON file against the form they must have, given as types of msgspec.

Keys that a form does not name are allowed: a later version may write more.
"""

from collections.abc import Iterator
from operator import ge, gt, le, lt
from typing import Any

import msgspec
from msgspec import inspect

from fvcollapse.case.grammar import show, toml_value
from fvcollapse.files.misfit import (
    alternatives,
    bare,
    chosen,
    first_misfit,
    fits,
    is_struct,
    tags_of,
)

KINDS: dict[Any, str] = {
    inspect.FloatType: "a number",
    inspect.IntType: "a whole number",
    inspect.StrType: "text",
    inspect.BoolType: "true or false",
    inspect.NoneType: "null",
    inspect.ListType: "a list",
    inspect.VarTupleType: "a list",
    inspect.TupleType: "a list",
    inspect.DictType: "a table",
    inspect.StructType: "a table",
}
LIMITS = {"gt": (">", gt), "ge": (">=", ge), "lt": ("<", lt), "le": ("<=", le)}
LENGTHS = {"min_length": (">=", ge), "max_length": ("<=", le)}


def form_problems(tree: Any, form: Any) -> Iterator[tuple[str, str, str]]:
    """(key, what was found, what is allowed) of the first value that does not fit; nothing if all do.

    Parameters
    ----------
    tree : object
        Plain values; not changed.
    form : type

    Yields
    ------
    tuple of str
    """
    misfit = first_misfit(tree, form)
    if misfit is not None:
        key = ".".join(map(str, misfit.steps))
        yield key, show(misfit.value), allowed_by(misfit.value, misfit.form)


def allowed_by(value: Any, form: Any) -> str:
    """What a form allows in place of a value that does not fit, in words."""
    struct = chosen(value, form)
    if is_struct(struct) and isinstance(value, dict):
        return allowed_in_table(value, struct)
    field, _ = tags_of(form)
    if field and isinstance(value, dict):
        return f"object missing required field {field}"
    ranged = [inner for inner in alternatives(form) if fits(value, bare(inner))]
    if not ranged:
        return words(inspect.type_info(form))
    kind, info = words(inspect.type_info(bare(ranged[0]))), inspect.type_info(ranged[0])
    exact = float if isinstance(info, inspect.FloatType) else int
    size = len(value) if isinstance(value, str | list | dict) else value
    limits = [f"{sign} {exact(limit)}" for sign, limit in exceeded(info, LIMITS, size)]
    lengths = [f"of length {sign} {limit}" for sign, limit in exceeded(info, LENGTHS, size)]
    pattern = getattr(info, "pattern", None)
    if not (limits or lengths) and pattern:
        return f"{kind} matching regex {pattern!r}"
    return " ".join([kind, *limits, *lengths])


def allowed_in_table(value: Any, struct: Any) -> str:
    """The same for a table all of whose values fit."""
    for field in msgspec.structs.fields(struct):
        if field.required and field.encode_name not in value:
            return f"object missing required field {field.encode_name}"
    try:
        msgspec.convert(value, struct)
    except msgspec.ValidationError as error:  # a rule that ties its values together
        return str(error.__cause__ or error)
    return "a table"


def words(info: Any) -> str:
    """A form in words, from what msgspec knows of it."""
    if isinstance(info, inspect.UnionType):
        return " or ".join(dict.fromkeys(map(words, info.types)))
    if isinstance(info, inspect.LiteralType):
        return " or ".join(map(toml_value, info.values))
    length = f" of length {len(info.item_types)}" if isinstance(info, inspect.TupleType) else ""
    return KINDS.get(type(info), "another kind of value") + length


def exceeded(info: Any, limits: dict, size: Any) -> Iterator[tuple[str, Any]]:
    """(sign, limit) of each limit of a form that a number, or a length, does not keep."""
    for name, (sign, keeps) in limits.items():
        limit = getattr(info, name, None)
        if limit is not None and not keeps(size, limit):
            yield sign, limit
