"""Standard output that is closed, full, or cannot show a letter: no traceback, the right status."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LONG = """
import sys
from fvcollapse.commands import keys
from fvcollapse.commands.command_line import main
def printing(arguments):
    for number in range(20000):
        print("0123456789 \\u00b0 \\udcff", number, flush=number % 100 == 0)
    print("kept", file=open(sys.argv[1], "w"))
    return int(sys.argv[2])
keys.execute = printing
sys.exit(main(["keys"]))
"""
full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")


def shell(line, tmp_path, status=0, **changes):
    """(status, stderr, whether the command came to its end) of a shell line with the command `$C`."""
    script = tmp_path / "printing.py"
    script.write_text(LONG)
    command = f'"{sys.executable}" "{script}" "{tmp_path / "end"}" {status}'
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | changes
    done = subprocess.run(
        ["bash", "-c", line.replace("$C", command)],
        env=environment,
        capture_output=True,
        timeout=60,
    )
    return done.returncode, done.stderr.decode(), (tmp_path / "end").exists()


@pytest.mark.parametrize("status", [0, 1])
def test_reader_that_has_seen_enough(tmp_path, status):
    line = "$C | head -1 >/dev/null; exit ${PIPESTATUS[0]}"
    assert shell(line, tmp_path, status) == (status, "", True)


@full
@pytest.mark.parametrize(("status", "expected"), [(0, 1), (2, 2)])
def test_full_output_is_one_line(tmp_path, status, expected):
    told = "stdout: cannot be written: No space left on device\n"
    assert shell("$C >/dev/full", tmp_path, status) == (expected, told, True)


@full
@pytest.mark.parametrize("line", ["$C >&-", "$C >&- 2>&-", "$C <&- >&- 2>&-", "$C 2>/dev/full"])
def test_closed_streams_are_no_error(tmp_path, line):
    assert shell(f"{line} >/dev/null" if ">&-" not in line else line, tmp_path) == (0, "", True)


def test_letters_that_the_encoding_lacks(tmp_path):
    line = "$C | head -1 >" + str(tmp_path / "out")
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    status, told, ended = shell(line, tmp_path, **plain)
    assert (status, told, ended) == (0, "", True)
    assert (tmp_path / "out").read_bytes() == b"0123456789 \\xb0 \xff 0\n"
