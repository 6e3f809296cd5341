"""One run of the study in a worker process: its folder, its cost, and what becomes of a failure."""

import sys
import time
from pathlib import Path

from fvcollapse.errors import NumericalError
from fvcollapse.refinement import run_member

COST = "cpu_s.txt"  # CPU time of all parts of a run, the resumed ones added


def run_one(case, folder, quiet=True):
    """Run a case into its folder, or continue it, and add its CPU time to `cpu_s.txt`.

    A run that fails is left as it is, its log says why, and the study goes on: the tables leave it
    out. The next call tries again from its last checkpoint.
    """
    start = time.process_time()
    try:
        run_member(case, folder, quiet)
    except NumericalError as error:
        print(f"{folder}: {error}", file=sys.stderr)
    finally:
        if Path(folder).is_dir():
            spent = cost(folder) + time.process_time() - start
            (Path(folder) / COST).write_text(f"{spent:.2f}\n")


def cost(folder):
    """CPU time spent on a run so far [s]."""
    path = Path(folder) / COST
    return float(path.read_text()) if path.exists() else 0.0
