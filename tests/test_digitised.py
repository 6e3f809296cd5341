"""Curves of digitising tools: every style of numbers is read, and what is no curve is refused."""

from pathlib import Path

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from fvcollapse.errors import InputError
from fvcollapse.measure.digitised import read_pairs
from fvcollapse.measure.digitised_table import STYLES

EXPORTS = Path(__file__).parent / "conventions" / "tool_exports"
POINTS = [(0.0, 20.0), (0.05, 21.5), (0.1, -1.25e-3)]


def text_in(between, decimal, pairs=POINTS):
    mark = "  " if between is None else between
    quote = '"' if between == decimal else ""
    lines = (mark.join(f"{quote}{float(value)!r}{quote}" for value in pair) for pair in pairs)
    return "\n".join(line.replace(".", decimal) for line in lines) + "\n"


@pytest.mark.parametrize(("between", "decimal"), STYLES)
def test_every_style_is_read(tmp_path, between, decimal):
    path = tmp_path / "curve.txt"
    path.write_text(text_in(between, decimal))
    np.testing.assert_array_equal(read_pairs(path), POINTS)


@settings(max_examples=60)
@given(
    pairs=st.lists(
        st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)),
        min_size=1,
        max_size=8,
        unique_by=lambda pair: pair[0],
    ),
    style=st.sampled_from(STYLES),
)
def test_style_does_not_change_the_numbers(tmp_path_factory, pairs, style):
    path = tmp_path_factory.mktemp("curve") / "curve.txt"
    path.write_text(text_in(*style, pairs))
    np.testing.assert_array_equal(read_pairs(path), sorted(pairs))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1, 2\n3, 4\n", [(1, 2), (3, 4)]),
        ("1 ; 2,5\n", [(1, 2.5)]),
        ("0,1 ; 2\n3 ; 4\n", [(0.1, 2), (3, 4)]),
        ("1,5\t2\n", [(1.5, 2)]),
        ("1,5 -2,5e-3\n", [(1.5, -2.5e-3)]),
        ("x;y\n1;2\n", [(1, 2)]),
        ("# tool 4.5\n\n 2\t1 \r\n1\t3\r\n", [(1, 3), (2, 1)]),
        ("\ufeff1 2\n", [(1, 2)]),
        ("1 2\n1 4\n0 5\n", [(0, 5), (1, 3)]),  # clicked twice
        ("Default Dataset,\nX,Y\n1,2\n", [(1, 2)]),
        ("h at t = 0.2 s,\nX,Y\n1.5,2\n", [(1.5, 2)]),
        ("0.2 s,\nX,Y\n1.5,2\n", [(1.5, 2)]),
        ("x,Curve1\n1,2\n", [(1, 2)]),
        ('"x";"y"\n"1,5";"2"\n', [(1.5, 2)]),
        ('"1,50000", "2,50000"\n', [(1.5, 2.5)]),
        ("\ufeffsep=;\nx;y\n1,5;2\n", [(1.5, 2)]),
        ("sep=|\n1|2\n", [(1, 2)]),
        ("Empty,,front,\nX,Y,X,Y\n,,1,2\n,,3,4\n", [(1, 2), (3, 4)]),  # one of two sets is empty
        ("1,2,\n3,4,\n", [(1, 2), (3, 4)]),
    ],
)
def test_what_tools_write(tmp_path, text, expected):
    path = tmp_path / "curve.txt"
    path.write_text(text, encoding="utf-8")
    np.testing.assert_array_equal(read_pairs(path), expected)


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("", "file", "no points"),
        ("x,y\n", "file", "no points"),
        ("1 2\n3 four\n", "line 2", "'3 four'"),
        ("1 2 3\n", "line 1", "'1 2 3'"),
        ("1,5 2,5\n1.5 2.5\n", "line 2", "'1.5 2.5'"),
        ("1 nan\n", "line 1", "'1 nan'"),
        ("0,1,0,2\n", "line 1", "'0,1,0,2'"),
        ("x,y\n0,1,0,2\n", "line 2", "4 columns of numbers if no comma is a decimal mark"),
        ("A,,B,\nX,Y,X,Y\n0,1,0,2\n", "line 3", "4 columns of numbers under A, B"),
        ("x,Curve1,Curve2\n0,1,2\n", "line 2", "3 columns of numbers under x, Curve1, Curve2"),
        ("1\n2\n", "line 1", "1 column of numbers"),
        ("x,y\n1,2\nx,y\n3,4\n", "line 3", "words below numbers"),
        ("nan;nan\n1;2\n", "line 1", "'nan;nan'"),
        ("1,2\n3,\n", "line 2", "'3,'"),
        ("1;2,5\n1.5;2.5\n", "line 2", "'1.5;2.5'"),
        ('"1,234","5,678"\n', "file", "may be decimal marks or stand between thousands"),
        ("1_0 2\n", "line 1", "'1_0 2'"),
        ("1 \u0662\n", "line 1", "'1 \u0662'"),
        ("1 1e999\n", "line 1", "'1 1e999'"),
        ("a\nb\nc\nd\n1 2\n", "line 4", "'d'"),
        ('{"dataset": [1, 2]}\n', "file", "a JSON document"),
        ('<?xml version="1.0"?>\n1 2\n', "file", "an XML document"),
    ],
)
def test_what_is_no_curve_is_refused(tmp_path, text, key, words):
    path = tmp_path / "curve.txt"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_pairs(path)
    assert caught.value.key == key
    assert words in caught.value.found


@pytest.mark.parametrize(
    ("data", "words"), [(b"PK\x03\x04\xff", "a ZIP archive"), ("1;2\n".encode("utf-16"), "UTF-16")]
)
def test_a_spreadsheet_is_named(tmp_path, data, words):
    path = tmp_path / "curve.xlsx"
    path.write_bytes(data)
    with pytest.raises(InputError, match=words):
        read_pairs(path)


@pytest.mark.parametrize(
    ("file", "count", "first", "last"),
    [
        ("front_wpd.csv", 20, (0.000496854507139, 20.0), (0.951338671379642, 52.76119531113468)),
        ("h_0.2s_wpd.csv", 14, (1.0, 13.55), (27.0, 1.41)),
        ("curve_default.csv", 20, (0.0, 0.2), (0.95, 0.527612)),
        ("curve_cs_CZ.csv", 20, (0.0, 0.2), (0.95, 0.52761)),
    ],
)
def test_exports_of_tools_are_read(file, count, first, last):
    pairs = read_pairs(EXPORTS / file)
    assert len(pairs) == count
    assert (tuple(pairs[0]), tuple(pairs[-1])) == (first, last)


def test_one_mark_for_two_things_is_not_guessed():
    with pytest.raises(
        InputError, match=r"line 2: found '0,00000,0,20000', 4 columns .* semicolons"
    ):
        read_pairs(EXPORTS / "curve_et_EE.csv")
