"""What the tables hold of one run of the study."""

from runs.paper.cases import GROUPS
from runs.paper.curves import curves
from runs.paper.scalars import scalars
from runs.study import cost, finished_run
from runs.table import curve_row


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
    result, problem = finished_run(folder)
    if result is None:
        return None, [], problem
    first = {"case": name, "refinement": refinement, "cell_size_mm": 1e3 * case.grid.cell_size}
    lines = [curve_row(first, of) for of in curves(result, GROUPS[group][name], refinement)]
    return first | scalars(result, cost(folder)), lines, ""
