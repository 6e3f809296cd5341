"""Numbers in text: ASCII digits alone; input from regular files alone."""

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fvcollapse.__main__ import main
from fvcollapse.diagnosis.report import read_report
from fvcollapse.errors import InputError
from fvcollapse.files.plain_numbers import decimal_number, finite_numbers, whole_number
from fvcollapse.files.regular import read_regular
from fvcollapse.output.result import open_result

NO_NUMBERS = [
    "",
    "1_000",
    "\u0661",
    "\uff11",
    "nan",
    "inf",
    "-",
    ".",
    "e5",
    "0x10",
    "1,5",
    "1 2",
    "1e",
]


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_number_that_is_printed_is_read(value):
    assert decimal_number(f" {value!r}\t") == value


@given(st.integers())
def test_every_whole_number_that_is_printed_is_read(value):
    assert whole_number(str(value)) == value


@pytest.mark.parametrize("text", NO_NUMBERS)
def test_what_is_no_number_is_refused(text):
    for read in (decimal_number, whole_number):
        with pytest.raises(ValueError, match="number"):
            read(text)


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False)))
def test_many_numbers_are_read_at_once(values):
    assert finite_numbers([repr(value) for value in values]) == values


@pytest.mark.parametrize("text", [*NO_NUMBERS, "1e999", " 1", "1\n2"])
def test_of_many_texts_each_must_be_a_finite_number(text):
    assert finite_numbers(["1", text, "2"]) is None


@pytest.mark.parametrize("text", ["1.0", "1e3", "9" * 5000])
def test_what_is_no_whole_number_is_refused(text):
    with pytest.raises(ValueError, match="no whole number"):
        whole_number(text)


@pytest.mark.parametrize(
    "arguments",
    [
        ["diagnose", "beads", "--out", "x", "--seed", "1_0"],
        ["diagnose", "beads", "--out", "x", "--cell-size", "0.\u0661"],
        ["diagnose", "beads", "--out", "x", "--workers", "\uff12"],
        ["import-curves", "--out", "x", "--profile", "1_0=curve.txt"],
    ],
)
def test_the_command_line_takes_ascii_digits(arguments, capsys):
    assert main(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.fixture
def pipe(tmp_path):
    """A named pipe without a writer: who opens it waits."""
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    return path


def test_a_pipe_is_not_waited_for(pipe, capsys):
    with pytest.raises(OSError, match="a named pipe, not a regular file"):
        read_regular(pipe)
    for read in (open_result, read_report):
        with pytest.raises(InputError, match="a named pipe"):
            read(pipe)
    for command in (
        ["run", str(pipe), "--out", str(pipe.parent / "out")],
        ["import-curves", "--front", str(pipe), "--out", str(pipe.parent / "out")],
    ):
        assert main(command) == 2
        error = capsys.readouterr().err
        assert "a named pipe, not a regular file" in error
        assert error.count("\n") == 1
    assert not (pipe.parent / "out").exists()


def test_a_device_is_no_input():
    with pytest.raises(OSError, match="a device, not a regular file"):
        read_regular(os.devnull)
