"""Where nested plain values depart from a form, found by following the form, not by reading messages.

A form is a type of msgspec: structs, tables and lists of plain values with ranges. msgspec says whether values fit
and, in words for a person, why not; it gives no place that a program can use. So the form is followed down to the
first part that does not fit.
"""

from collections.abc import Iterator
from types import UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

import msgspec

UNKNOWN = object()  # the form of a key that a struct does not have
NONE = type(None)


class Misfit(NamedTuple):
    """The first value that does not fit.

    Attributes
    ----------
    steps : tuple of str or int
        Keys and indices on the way to it.
    value : object
    form : type or object
        What it should be; `UNKNOWN` where the last step is no key of its table.
    """

    steps: tuple
    value: object
    form: object


def first_misfit(value: Any, form: Any) -> Misfit | None:
    """The `Misfit` of plain values against a form, in the order of the values; None if all fit.

    Where every part of a table or a list fits, it is at fault as a whole: a key is missing, or its length is wrong.
    """
    if fits(value, form):
        return None
    for step, inner, inner_form in parts(value, form):
        misfit = first_misfit(inner, inner_form)
        if misfit is not None:
            return misfit._replace(steps=(step, *misfit.steps))
    return Misfit((), value, form)


def fits(value: Any, form: Any) -> bool:
    """Whether a value has the form."""
    if form is UNKNOWN:
        return False
    try:
        msgspec.convert(value, form)
    except msgspec.ValidationError:
        return False
    return True


def parts(value: Any, form: Any) -> Iterator[tuple[Any, Any, Any]]:
    """(step, value, form) of everything directly inside a table or a list."""
    field, tags = tags_of(form)
    form = chosen(value, form)
    origin, inner = get_origin(form), get_args(form)
    if isinstance(value, dict):
        if form is NONE and field in value:
            yield field, value[field], Literal[tags]
        elif is_struct(form):
            fields = {field.encode_name: field.type for field in msgspec.structs.fields(form)}
            known = UNKNOWN if form.__struct_config__.forbid_unknown_fields else object
            fields[form.__struct_config__.tag_field] = object
            yield from ((name, part, fields.get(name, known)) for name, part in value.items())
        elif origin is dict:
            yield from ((name, part, inner[1]) for name, part in value.items())
    elif isinstance(value, list | tuple):
        if origin is list or (origin is tuple and inner[-1] is Ellipsis):
            yield from ((place, part, inner[0]) for place, part in enumerate(value))
        elif origin is tuple:
            yield from zip(range(len(inner)), value, inner, strict=False)


def chosen(value: Any, form: Any) -> Any:
    """The form that a value is meant to have: bare of its range, and one of several."""
    forms = [bare(inner) for inner in alternatives(form)]
    if len(forms) == 1:
        return forms[0]
    return next((inner for inner in forms if is_meant(value, inner)), NONE)


def alternatives(form: Any) -> tuple:
    """The forms of which a value may have one, with their ranges."""
    return get_args(form) if get_origin(form) in (Union, UnionType) else (form,)


def tags_of(form: Any) -> tuple[str, tuple]:
    """(name of the key, its values) that tell several structs apart; ("", ()) where none does."""
    structs = [inner for inner in get_args(form) if is_struct(inner)]
    tags = tuple(inner.__struct_config__.tag for inner in structs)
    if not any(tags):
        return "", ()
    return structs[0].__struct_config__.tag_field, tags


def bare(form: Any) -> Any:
    """A form without its range."""
    return get_args(form)[0] if get_origin(form) is Annotated else form


def is_meant(value: Any, form: Any) -> bool:
    """Whether a table or a list is meant to have a form: that of its tag, where forms have tags."""
    if is_struct(form):
        config = form.__struct_config__
        return isinstance(value, dict) and (
            config.tag is None or value.get(config.tag_field) == config.tag
        )
    kind = {dict: dict, list: list | tuple, tuple: list | tuple}.get(get_origin(form))
    return kind is not None and isinstance(value, kind)


def is_struct(form: Any) -> bool:
    """Whether a form is a struct."""
    return isinstance(form, type) and issubclass(form, msgspec.Struct)
