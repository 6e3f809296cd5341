"""The tables of what loses right names, and of what is taken for what, for the README of the blind check."""

import numpy as np

from fvcollapse.blind.next_scores import over_worlds
from fvcollapse.blind.outcomes import class_of
from fvcollapse.blind.score import SEPARABLE
from fvcollapse.diagnosis.names import NONE, UNKNOWN
from runs.readme_tables import stored, table
from runs.table import RUNS, read_table

RUNGS = {
    "as_sealed": "nothing: the cases are like those of a sealed suite",
    "closures": "closures of real grains: effects act by their closures of the catalogue",
    "physics": "physics of the world, and the smooth error of the model",
    "numerics": "other numerics: the truth is computed on the finer grid of the diagnosis",
    "measurement": "three quarters or more of the errors of measurement, set-up and material",
}


def losses():
    """Right first names of the same cases, with one thing after the other taken out."""
    rows = [numbers_of(row) for row in read_table(RUNS / "blind" / "losses.csv")]
    rungs = {rung: [row for row in rows if row["rung"] == rung] for rung in RUNGS}
    first = next(iter(rungs.values()))
    single = [row for row in first if class_of(row["truth"]) == "single"]
    heading = (
        "taken out, beside all above",
        f"single effects ({len(single)})",
        "gain by it",
        "d ≥ 3",
        f"all ({len(first)})",
        "gain by it",
        "none, unknown called so",
        "names in the set (truth in it)",
        "all, by the largest evidence alone",
    )
    lines, before = [], None
    for rung, words in RUNGS.items():
        lines.append((words, *line_of(rungs[rung], before)))
        before = rungs[rung]
    return table(heading, lines)


def numbers_of(row):
    """A row of the table with numbers as such."""
    names = ("right", "p_truth", "set_holds_truth", "names", "right_by_evidence")
    d = float(row["d"]) if row["d"] else 0.0
    return row | {name: float(row[name]) for name in names} | {"d": d}


def line_of(rows, before):
    """Cells of one rung; `before`: the rows of the one above, or None."""
    of_single = [single(each) for each in (rows, before)]
    far = [row for row in of_single[0] if row["d"] >= SEPARABLE]
    called = [
        f"{sum(row['verdict'] == name for row in rows if row['truth'] == name)} of "
        f"{sum(row['truth'] == name for row in rows)}"
        for name in (NONE, UNKNOWN)
    ]
    held = mean(rows, "set_holds_truth")
    return (
        percent(mean(of_single[0])),
        gain(*of_single),
        f"{percent(mean(far))} of {len(far)}",
        percent(mean(rows)),
        gain(rows, before),
        ", ".join(called),
        f"{mean(rows, 'names'):.1f} ({percent(held)})",
        percent(mean(rows, "right_by_evidence")),
    )


def single(rows):
    """Rows of single effects; None stays None."""
    return rows and [row for row in rows if class_of(row["truth"]) == "single"]


def mean(rows, name="right"):
    """Mean of a column."""
    return float(np.mean([row[name] for row in rows]))


def gain(rows, before):
    """Gain of right first names over the same cases before, with the 95 % interval of a bootstrap over worlds."""
    if before is None:
        return "–"
    earlier = {row["case"]: row["right"] for row in before}
    gained = [row["right"] - earlier[row["case"]] for row in rows]
    found = over_worlds(gained, [row["world"] for row in rows])
    value, low, high = (100 * found[name] for name in ("value", "low", "high"))
    return f"{value:+.0f} % [{low:+.0f}, {high:+.0f}]"


def percent(value):
    """A share in whole per cent."""
    return f"{100 * value:.0f} %"


def confusion():
    """First names that the sealed causes get, with controls."""
    counts = stored("blind", "scores.json")["controls"]["confusion"]
    truths = sorted(counts, key=lambda name: ("+" in name, name == UNKNOWN, name == NONE, name))
    lines = []
    for truth in truths:
        firsts = counts[truth]
        wrong = {name: count for name, count in firsts.items() if name != truth}
        row = f"{sum(firsts.values())}", f"{firsts.get(truth, 0)}"
        lines.append((truth, *row, listed(wrong)))
    return table(("hidden", "cases", "first name right", "first name otherwise"), lines)


def listed(counts):
    """Names with their counts, the most frequent first."""
    ordered = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
    return ", ".join(f"{name} {count}" for name, count in ordered)
