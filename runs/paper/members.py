"""What the tables hold of one run of the study."""

from runs.paper.curves import curves
from runs.paper.scalars import scalars
from runs.study import cost, finished_run
from runs.table import curve_row


def rows_of_run(job):
    """The rows of the tables of one run.

    Parameters
    ----------
    job : (Path, Run)
        Its folder, and what was run.

    Returns
    -------
    tuple
        Row of numbers, rows of curves, and "" or a line that says why there are none.
    """
    folder, run = job
    result, problem = finished_run(folder)
    if result is None:
        return None, [], problem
    size = 1e3 * run.case.grid.cell_size
    first = {"case": run.name, "refinement": run.refinement, "cell_size_mm": size}
    lines = [curve_row(first, of) for of in curves(result, run.member, run.refinement)]
    return first | scalars(result, cost(folder)), lines, ""
