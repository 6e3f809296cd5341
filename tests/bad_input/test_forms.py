"""What a form says of values that do not fit: the way to the value, also through tables of any names."""

from typing import Annotated

import msgspec
import pytest

from fvcollapse.output.forms import form_problems


class Drag(msgspec.Struct, tag_field="kind", tag="drag"):
    """One of two forms that `kind` tells apart."""

    rate: float


class Strip(msgspec.Struct, tag_field="kind", tag="strip"):
    """The other one, whose ends are tied together."""

    first: float
    last: float

    def __post_init__(self):
        if self.last < self.first:
            raise ValueError("last >= first")


class Row(msgspec.Struct):
    """A form with everything."""

    size: Annotated[float, msgspec.Meta(ge=0)]
    tables: dict[str, dict[str, float]] = {}
    numbers: list[int] = []
    pair: tuple[float, float] = (0.0, 0.0)
    forces: list[Drag | Strip] = []
    name: Annotated[str, msgspec.Meta(pattern="^[a-z]+$")] | None = None
    shares: Annotated[dict[str, float], msgspec.Meta(min_length=1)] | None = None
    digest: Annotated[str, msgspec.Meta(pattern="^[0-9a-f]+$", min_length=2)] = "00"


PROBLEMS = {
    "nested table": (
        {"size": 1, "tables": {"a": {"b": 1}, "c": {"d": 2, "e": "f"}}},
        ("tables.c.e", 'the string "f"', "a number"),
    ),
    "two faults, the first named": (
        {"tables": {"a": {"b": 1}, "c": 3}, "pair": ["x", 1], "size": 1},
        ("tables.c", "3", "a table"),
    ),
    "out of range": ({"size": -1}, ("size", "-1", "a number >= 0.0")),
    "missing": ({}, ("", "a table", "object missing required field size")),
    "in a list": ({"size": 1, "numbers": [1, "a"]}, ("numbers.1", '"a"', "a whole number")),
    "truth for a number": ({"size": True}, ("size", "the boolean true", "a number")),
    "an unknown tag": (
        {"size": 1, "forces": [{"kind": "drag", "rate": 1}, {"kind": "lift"}]},
        ("forces.1.kind", 'the string "lift"', '"drag" or "strip"'),
    ),
    "no tag": (
        {"size": 1, "forces": [{"rate": 1}]},
        ("forces.0", "a table", "object missing required field kind"),
    ),
    "inside the form of a tag": (
        {"size": 1, "forces": [{"kind": "strip", "first": 0, "last": "b"}]},
        ("forces.0.last", '"b"', "a number"),
    ),
    "values that do not go together": (
        {"size": 1, "forces": [{"kind": "strip", "first": 1, "last": 0}]},
        ("forces.0", "a table", "last >= first"),
    ),
    "a list too long": ({"size": 1, "pair": [1, 2, 3]}, ("pair", "the list", "a list of length 2")),
    "an empty table": ({"size": 1, "shares": {}}, ("shares", "a table", "a table of length >= 1")),
    "a short text": ({"size": 1, "digest": "0"}, ("digest", '"0"', "text of length >= 2")),
    "a text of other letters": (
        {"size": 1, "digest": "xyz"},
        ("digest", '"xyz"', "text matching regex '^[0-9a-f]+$'"),
    ),
    "optional": ({"size": 1, "name": 3}, ("name", "3", "text or null")),
    "no table": (3, ("", "3", "a table")),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_fault_is_named(name):
    tree, (key, found, allowed) = PROBLEMS[name]
    ((where, what, wanted),) = form_problems(tree, Row)
    assert where == key
    assert found in what
    assert wanted == allowed


def test_what_fits_is_passed_and_nothing_is_changed():
    tree = {"size": 1, "tables": {"a": {"b": 2}}, "more": [1, 2]}
    assert list(form_problems(tree, Row)) == []
    assert tree == {"size": 1, "tables": {"a": {"b": 2}}, "more": [1, 2]}
