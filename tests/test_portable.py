"""What a system without the calls of Unix leaves of the promises: taken away from this one, commands still work.

Windows has no `fcntl`, no `resource`, no SIGHUP, no timer of signals and no groups of processes; its folders cannot be
forced to the disk.
"""

import os
import subprocess
import sys

WITHOUT = """
import os, signal, sys
sys.modules["fcntl"] = sys.modules["resource"] = None
for name in ("SIGHUP", "SIGALRM", "setitimer", "pthread_sigmask"):
    delattr(signal, name)
for name in ("fchmod", "O_NOFOLLOW", "setpgid"):
    delattr(os, name)
from fvcollapse.__main__ import main
from fvcollapse.files import atomic, locks
assert locks.fcntl is None and atomic.fcntl is None
"""
RUN = ["run", "case.toml", "--set", "grid.cell_size=0.035", "--set", "time.end=0.02", "--quiet"]


def without_unix(folder, program):
    """A program on such a system, in a folder with an empty case."""
    (folder / "case.toml").touch()
    environment = os.environ | {"FVCOLLAPSE_CACHE": str(folder / "cache")}
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    return subprocess.run(
        [sys.executable, "-c", WITHOUT + program],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_run_is_made_and_found_again(tmp_path):
    done = without_unix(tmp_path, f"sys.exit(main({RUN}) or main({RUN}))")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("runout") >= 2
    names = {path.name for path in (tmp_path / "out" / "case").iterdir()}
    assert {"result.h5", "result.xdmf", "run.log"} <= names
    assert not [name for name in names if name.endswith(".tmp")]


def test_a_folder_has_one_run_at_a_time(tmp_path):
    held = f"""
from pathlib import Path
from fvcollapse.output.run_log import run_log
with run_log(Path("out/case")):
    sys.exit(main({RUN}))
"""
    done = without_unix(tmp_path, held)
    assert done.returncode == 2
    assert "another run that writes there" in done.stderr


def test_several_runs_are_made_by_other_processes(tmp_path):
    words = ["sweep", *RUN[1:], "--vary", "rheology.mu_1=0.44,0.46", "--out", "out/sweep"]
    done = without_unix(tmp_path, f"sys.exit(main({[*words, '--workers', '2']}))")
    assert done.returncode == 0, done.stderr
    rows = (tmp_path / "out" / "sweep" / "sweep.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 3


def test_the_benchmark_does_without_the_memory(tmp_path):
    program = """
from fvcollapse.studies.bench import report
from fvcollapse.studies.bench.measured import largest_memory
assert largest_memory() is None
print(report.COLUMNS["MB"]({"memory_mb": None}))
"""
    done = without_unix(tmp_path, program)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "-\n"
