"""Files that appear whole or not at all; what a kill leaves, and who removes it."""

import os
import signal
import stat

import pytest
from processes import start, wait_for

from fvcollapse.errors import OutputError
from fvcollapse.files.atomic import PREFIX, SUFFIX, locked_temporary, write_atomic

WRITE_FOR_EVER = """
import sys
from fvcollapse.files import atomic
def wait(*_):
    open(sys.argv[1] + "/writing", "w").close()
    __import__("time").sleep(60)
atomic.os.replace = wait
atomic.write_atomic(sys.argv[1] + "/table.csv", b"new")
"""


def temporary(folder):
    return list(folder.glob(f"{PREFIX}*{SUFFIX}"))


def test_temporary_file_of_a_dead_process_goes_and_that_of_a_living_one_stays(tmp_path):
    (tmp_path / "table.csv").write_bytes(b"old")
    writer, _ = start("-c", WRITE_FOR_EVER, tmp_path)
    wait_for((tmp_path / "writing").exists)
    (kept,) = temporary(tmp_path)
    write_atomic(tmp_path / "other.csv", b"other")
    assert temporary(tmp_path) == [kept]
    writer.send_signal(signal.SIGKILL)
    writer.communicate()
    assert temporary(tmp_path) == [kept]
    assert (tmp_path / "table.csv").read_bytes() == b"old"
    write_atomic(tmp_path / "other.csv", b"other")
    assert temporary(tmp_path) == []


def test_what_is_not_ours_stays(tmp_path):
    foreign = [tmp_path / ".result.h5.tmp", tmp_path / "a.tmp", tmp_path / ".tmp"]
    for path in foreign:
        path.touch()
    target = tmp_path / "target"
    target.write_bytes(b"text")
    (tmp_path / f"{PREFIX}link{SUFFIX}").symlink_to(target)  # is not followed
    write_atomic(tmp_path / "new", b"1")
    assert all(path.exists() for path in foreign)
    assert target.read_bytes() == b"text"


def test_permissions(tmp_path):
    before = os.umask(0o027)
    try:
        write_atomic(tmp_path / "usual", b"1")
        write_atomic(tmp_path / "private", b"1", private=True)
    finally:
        os.umask(before)
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("usual", "private")]
    assert modes == [0o640, 0o600]
    handle, name = locked_temporary(tmp_path)
    assert stat.S_IMODE(os.stat(name).st_mode) == 0o600
    os.close(handle)


def test_folder_that_is_none_is_one_line(tmp_path):
    with pytest.raises(OutputError, match="cannot be written"):
        write_atomic(tmp_path / "none" / "file", b"1")
