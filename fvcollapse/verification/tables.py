"""The rows of `verify` as a table on the screen, as Markdown by term of the equations, and as JSON."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fvcollapse.verification.terms import TERMS

if TYPE_CHECKING:
    from fvcollapse.verification.problem import Problem


HEADING = (
    f"{'problem':39s} {'grids':>16s} {'L1':>9s} {'L2':>9s} {'Linf':>9s} "
    f"{'order':>6s} {'expected':>9s} "
    f"{'tolerance':>10s}"
)
MARKDOWN_HEADING = (
    "| term | file | problem | grids | error L2 / L∞, finest grid | order (expected) or bound |\n"
    "|---|---|---|---|---|---|"
)


def table_line(row: dict) -> str:
    """One row of the table; the norms are those of the finest grid."""
    grids = " ".join(str(cells) for cells in row["grids"])
    norms = " ".join(f"{row[name][-1]:9.1e}" for name in ("error_l1", "error_l2", "error_linf"))
    orders = [row["observed_order"], row["expected_order"]]
    observed, expected = ("-" if order is None else f"{order:.2f}" for order in orders)
    verdict = "pass" if row["passed"] else "FAIL"
    ends = f"{observed:>6s} {expected:>9s} {row['tolerance']:10.1e} {verdict}"
    return f"{row['name']:39s} {grids:>16s} {norms} {ends}"


def markdown_table(rows: list[dict], problems: "Mapping[str, Problem]") -> str:
    """The rows as a table equation term → file → problem → measured error.

    Parameters
    ----------
    rows : list of dict
        From `problem.solve`.
    problems : dict
        {name: Problem}, of these rows at least.
    """
    lines = [MARKDOWN_HEADING]
    for term in TERMS:
        of_term = (row for row in rows if problems[row["name"]].term == term)
        lines += [markdown_line(problems[row["name"]], row) for row in of_term]
    return "\n".join(lines) + "\n"


def markdown_line(problem: "Problem", row: dict) -> str:
    """One problem of the table."""
    grids = ", ".join(str(cells) for cells in row["grids"])
    judged = f"≤ {row['tolerance']:.1e}: {problem.source}"
    if row["expected_order"] is not None:
        observed = row["observed_order"]
        judged = "none" if observed is None else f"{observed:.2f}"
        judged += f" ({row['expected_order']:g})"
    verdict = "" if row["passed"] else " **fails**"
    errors = f"{row['error_l2'][-1]:.1e} / {row['error_linf'][-1]:.1e}"
    term, name = problem.term, row["name"]
    return f"| {term.words} | `{term.file}` | {name} | {grids} | {errors} | {judged}{verdict} |"


def json_text(rows: list[dict]) -> str:
    """The rows as JSON, with null in the place of NaN and infinity."""
    return json.dumps(finite(rows), indent=1, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """The same nested lists and dicts with None in the place of NaN and infinity."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
