"""What a worker process does: one run of the study in its folder, and its rows of the tables."""

import sys
import time
from pathlib import Path

from fvcollapse.errors import InputError, NumericalError
from fvcollapse.members import run_member
from fvcollapse.output import RESULT
from fvcollapse.result import open_result
from runs.paper import tables
from runs.paper.cases import GROUPS
from runs.paper.extract import curves, scalars

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


def rows_of_run(job):
    """The rows of the tables of one run.

    Parameters
    ----------
    job : tuple
        Folder, group, name of the case, refinement, Case.

    Returns
    -------
    tuple
        Row of numbers, rows of curves, and "" or a line that says why there are none.
    """
    folder, group, name, refinement, case = job
    try:
        result = open_result(folder / RESULT)
    except InputError as error:
        return None, [], str(error)
    if not result.complete:
        return None, [], f"{folder}: stopped at t = {result.time[-1]:.3f} s, see its run.log"
    first = {"case": name, "refinement": refinement, "cell_size_mm": 1e3 * case.grid.cell_size}
    lines = [tables.curve_row(first, of) for of in curves(result, GROUPS[group][name], refinement)]
    return first | scalars(result, cost(folder)), lines, ""
