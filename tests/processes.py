"""Processes that a test starts: in the environment of this checkout, and found again by a mark."""

import os
import subprocess
import sys
import time
import uuid
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MARK = "FVCOLLAPSE_TEST"


def start(*arguments, **changes):
    """(Popen of this Python with these arguments, mark of it and of all that it starts)."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests")])
    mark = uuid.uuid4().hex
    environment = os.environ | {"PYTHONPATH": paths, MARK: mark} | changes
    command = [sys.executable, *map(str, arguments)]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, env=environment, start_new_session=True, **streams), mark


def alive(mark):
    """Numbers of the living processes with a mark (of Linux: none elsewhere)."""
    found, wanted = [], f"{MARK}={mark}".encode()
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            marked = wanted in (folder / "environ").read_bytes().split(b"\0")
            state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
        except (OSError, IndexError):
            continue
        if marked and state != "Z":
            found.append(int(folder.name))
    return found


def wait_for(condition, limit=60.0):
    """Wait until a condition holds."""
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)
