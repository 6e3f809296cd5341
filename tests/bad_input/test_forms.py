"""What a form says of values that do not fit: the way to the value, also through tables of any names."""

from typing import Annotated

import msgspec
import pytest

from fvcollapse.output.forms import form_problems


class Row(msgspec.Struct):
    """A form with everything."""

    size: Annotated[float, msgspec.Meta(ge=0)]
    tables: dict[str, dict[str, float]] = {}
    numbers: list[int] = []
    pair: tuple[float, float] = (0.0, 0.0)


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
