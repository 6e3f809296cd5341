"""Proof against theory: flows with an exact solution, run through the solver of the collapse."""

import difflib
import json
import math
from pathlib import Path

from fvcollapse.errors import InputError, OutputError, refuse_bad_target


def problem_names():
    """Names of all verification problems."""
    from fvcollapse.verification.problems import PROBLEMS

    return [problem.name for problem in PROBLEMS]


def verify(names=None, json_path=None, markdown_path=None):
    """Solve the named verification problems (all, if none are named); print and write the table.

    Parameters
    ----------
    names : sequence of str, optional
        Problems, as in `problem_names()`.
    json_path : str or Path, optional
        Where to write the list of rows.
    markdown_path : str or Path, optional
        Where to write the table term, file, problem, error.

    Returns
    -------
    list of dict
        One row per problem: name, grids, error_l1, error_l2, error_linf, observed_order,
        expected_order, tolerance, passed.
    """
    from fvcollapse.verification.problem import solve
    from fvcollapse.verification.problems import PROBLEMS
    from fvcollapse.verification.terms import markdown_table

    by_name = {problem.name: problem for problem in PROBLEMS}
    for name in names or ():
        if name not in by_name:
            near = difflib.get_close_matches(name, by_name, n=1, cutoff=0.0)[0]
            raise InputError(
                "command line", "NAME", name, f"a verification problem; the closest is {near}"
            )
    for path in (json_path, markdown_path):
        refuse_bad_target(path)
    rows = []
    print(HEADING)
    for name in names or by_name:
        rows.append(solve(by_name[name]))
        print(table_line(rows[-1]), flush=True)
    if json_path is not None:
        write_text(json.dumps(finite(rows), indent=1, allow_nan=False) + "\n", Path(json_path))
    if markdown_path is not None:
        write_text(markdown_table(rows), Path(markdown_path))
    return rows


HEADING = (
    f"{'problem':30s} {'grids':>16s} {'L1':>9s} {'L2':>9s} {'Linf':>9s} "
    f"{'order':>6s} {'expected':>9s} "
    f"{'tolerance':>10s}"
)


def table_line(row):
    """One row of the table; the norms are those of the finest grid."""
    grids = " ".join(str(cells) for cells in row["grids"])
    norms = " ".join(f"{row[name][-1]:9.1e}" for name in ("error_l1", "error_l2", "error_linf"))
    orders = [row["observed_order"], row["expected_order"]]
    observed, expected = ("-" if order is None else f"{order:.2f}" for order in orders)
    verdict = "pass" if row["passed"] else "FAIL"
    ends = f"{observed:>6s} {expected:>9s} {row['tolerance']:10.1e} {verdict}"
    return f"{row['name']:30s} {grids:>16s} {norms} {ends}"


def finite(value):
    """The same nested lists and dicts with null in the place of NaN and infinity, for JSON."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_text(text, path):
    """Write a table.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(path, error, running=True) from None
