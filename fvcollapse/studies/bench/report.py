"""The report of the benchmark: growth of the cost with refinement, and the table."""

from collections.abc import Iterator
from typing import Any

import numpy as np

GROWTH_FROM = 0.006  # m; the growth of the cost with refinement begins here
COLUMNS = {  # heading: how the figure of a case is written
    "case": lambda case: case["name"],
    "to s": lambda case: f"{case['end_s']:g}",
    "loop s": lambda case: f"{case['wall_s']:.2f}",
    "command s": lambda case: f"{case['command_s']:.2f}",
    "steps": lambda case: str(case["steps"]),
    "sweeps": lambda case: str(case["sweeps"]),
    "solves": lambda case: str(case["linear_iterations"]),
    "us/cell/step": lambda case: f"{case['us_per_cell_and_step']:.2f}",
    "bound s": lambda case: f"{case['bound_s']:.3f}",
    "MB": lambda case: "-" if case["memory_mb"] is None else f"{case['memory_mb']:.0f}",
}


def growth(rows: list[dict]) -> Any:
    """How the cost of a cell and step grows from 6 mm cells on, per slope and width: fitted exponent, total ratio.

    The exponent n is that of cost ~ (1/cell size)^n, by least squares over all sizes that were run.
    """
    families: dict = {}
    for row in rows:
        if row["cell_size"] <= GROWTH_FROM:
            families.setdefault(row["name"].rpartition("_")[0], []).append(row)
    found = {}
    for name, members in families.items():
        if len(members) > 1:
            size = np.log([row["cell_size"] for row in members])
            cost = np.log([row["us_per_cell_and_step"] for row in members])
            finest, coarsest = np.argmin(size), np.argmax(size)
            found[name] = {
                "exponent": -float(np.polyfit(size, cost, 1)[0]),
                "ratio": float(np.exp(cost[finest] - cost[coarsest])),
                "cell_size": [float(np.exp(size[coarsest])), float(np.exp(size[finest]))],
            }
    return found


def table(report: dict) -> str:
    """The report as aligned plain text."""
    rows = rows_of(report["cases"])
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(f"{word:>{w}}" for word, w in zip(row, widths, strict=True)) for row in rows]
    return "\n".join([*lines, *lines_below(report)])


def rows_of(cases: list[dict]) -> list:
    """Cells of the table: a heading, and a row for each case."""
    factors = all("cost_factor" in case for case in cases)
    rows = [[*COLUMNS, "cost factor"] if factors else list(COLUMNS)]
    for case in cases:
        row = [write(case) for write in COLUMNS.values()]
        rows.append([*row, f"{case['cost_factor']:.2f}"] if factors else row)
    return rows


def lines_below(report: dict) -> Iterator[str]:
    """What the report says beside the rows of the cases."""
    if "compilation" in report:
        cold, warm = (report["compilation"][name] for name in ("cold_s", "warm_s"))
        yield f"\nfirst start {cold:.1f} s, later {warm:.2f} s"
    if "sweep_of_8" in report:
        yield f"two cores on a sweep of 8 runs: {report['sweep_of_8']['ratio']:.2f} times one core"
    for name, found in report.get("growth", {}).items():
        coarse, fine = (1e3 * size for size in found["cell_size"])
        yield (
            f"{name}: a cell and step cost {found['ratio']:.2f} times as much at {fine:.2g} as at {coarse:.2g} mm; "
            f"exponent {found['exponent']:.2f}"
        )
    for case in report["cases"]:
        parts = ", ".join(f"{part} {ratio:.0f}" for part, ratio in case["over_bound"].items())
        yield f"{case['name']}: parts of a sweep over its bound: {parts}"
        share = sorted(case["share"].items(), key=lambda item: -item[1])
        yield f"{case['name']}: " + ", ".join(f"{term} {100 * s:.0f} %" for term, s in share)
