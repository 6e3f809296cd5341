"""Code blocks of README files, and a checkout in which they run.

The line that opens a block says its language; `<!-- slow -->` before it marks a block that `-m slow` alone runs: it
takes minutes, or quicker tests guard the same. A block of `toml` names the file as which a reader saves it. `sh` and
`python` are executed; `text` is what a command prints.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import pytest

from fvcollapse.__main__ import main

ROOT = Path(__file__).parents[1]
SLOW = "<!-- slow -->"
BLOCK = re.compile(
    rf"(?P<slow>^{SLOW}\n)?^```(?P<info>[^\n]*)\n(?P<code>.*?)^```$", re.DOTALL | re.MULTILINE
)
EXECUTED, SAVED, SHOWN = ("sh", "python"), ("toml",), ("text",)
LEFT_OUT = shutil.ignore_patterns(
    ".git", ".venv*", ".*_cache", ".hypothesis", "out", "dist", "*.egg-info", "report.html"
)


class Block(NamedTuple):
    """A block of code: its language, the other words of its first line, and whether `-m slow` alone runs it."""

    language: str
    words: tuple
    code: str
    is_slow: bool = False


def blocks_of(path):
    """The blocks of a README file in their order."""
    text = path.read_text(encoding="utf-8")
    return [
        block_of(match["info"].split(), match["code"], match["slow"] is not None)
        for match in BLOCK.finditer(text)
    ]


def block_of(words, code, is_slow):
    """A block from the words of the line that opens it."""
    return Block(words[0] if words else "", tuple(words[1:]), code, is_slow)


def checkout(folder):
    """A copy of this checkout, with compiled kernels and without what git leaves out; its environment."""
    shutil.copytree(ROOT, folder, ignore=LEFT_OUT, copy_function=copy_of)
    programs = folder / "out" / "bin"
    programs.mkdir(parents=True)
    for name, call in (("python", ""), ("fvcollapse", "-m fvcollapse ")):
        program = programs / name
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" {call}"$@"\n', encoding="utf-8")
        program.chmod(0o755)
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    return kept | {
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(folder),
        "FVCOLLAPSE_CACHE": str(folder / "out" / "cache"),
    }


def copy_of(source, target):
    """Copy a file; compiled ones, which are large and only ever replaced, are linked where that is possible."""
    if Path(source).parent.name == "__pycache__":
        with suppress(OSError):
            return os.link(source, target)
    return shutil.copy2(source, target)


def fresh_clone(folder):
    """The same without compiled kernels, and an environment in which the package must be installed first."""
    environment = checkout(folder)
    for cache in list(folder.rglob("__pycache__")):
        shutil.rmtree(cache)
    return {name: value for name, value in environment.items() if name != "PYTHONPATH"}


def activated(environment, folder):
    """The environment once its reader has made and activated `.venv`."""
    programs = folder / ".venv" / "bin"
    if not programs.is_dir() or environment["PATH"].startswith(str(programs)):
        return environment
    return environment | {"PATH": f"{programs}{os.pathsep}{environment['PATH']}"}


def can_run_inside(blocks):
    """Whether all commands are calls of `fvcollapse` without anything of a shell."""
    lines = [line for block in blocks if block.language == "sh" for line in block.code.splitlines()]
    return all(line.startswith("fvcollapse ") and not set(line) & set("&|<>;$*") for line in lines)


def run_blocks_inside(blocks, folder, environment):
    """The same by this process, which has loaded the package already; see `can_run_inside`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("FVCOLLAPSE_CACHE", environment["FVCOLLAPSE_CACHE"])
        for block in blocks:
            if block.language == "python":
                exec(compile(block.code, "<README>", "exec"), {"__name__": "__main__"})
            elif block.language in EXECUTED:
                for line in block.code.splitlines():
                    assert main(shlex.split(line, comments=True)[1:]) == 0, line
            else:
                run_blocks([block], folder, environment)


def run_blocks(blocks, folder, environment):
    """Save or run the blocks in their order, as a reader would; the first that fails ends it.

    Raises
    ------
    AssertionError
        With the code, and what it printed.
    """
    for block in blocks:
        if block.language in SAVED:
            path = folder / block.words[0]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.code, encoding="utf-8")
        elif block.language in EXECUTED:
            environment = activated(environment, folder)
            shell = ["bash", "-e", "-o", "pipefail", "-c"]
            call = shell if block.language == "sh" else ["python", "-c"]
            done = subprocess.run(
                [*call, block.code], cwd=folder, env=environment, capture_output=True, text=True
            )
            assert done.returncode == 0, f"{block.code}\n{done.stdout}\n{done.stderr}"
