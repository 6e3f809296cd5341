"""Tables of the cost of runs for the README files, from the stored reports of the benchmark."""

from fvcollapse.studies.bench.case_list import NO_EFFECT
from runs.readme_stamps import solver_line
from runs.readme_tables import stored, table

TERMS = (
    "implicit solve",
    "surface",
    "recording and the rest",
    "momentum advection",
    "continuation of the velocity",
    "energy budget",
    "geometry",
)
SWEEP = ("coefficients", "assembly", "factorisation", "substitution")
WIDTHS = {"w10cm": "10 cm", "winf": "∞"}


def bench_rows():
    """Cases of the benchmark in their order, the finest grid from a report of its own."""
    rows = stored("bench", "bench.json")["cases"]
    known = {row["name"] for row in rows}
    rows += [row for row in stored("bench", "finest.json")["cases"] if row["name"] not in known]
    order = {family: place for place, family in enumerate(dict.fromkeys(map(family_of, rows)))}
    return sorted(rows, key=lambda row: (order[family_of(row)], -row["cell_size"]))


def family_of(row):
    """Slope and width of a case of the benchmark."""
    return row["name"].rpartition("_")[0]


def case_words(row):
    """A case of the benchmark in words."""
    slope, width = family_of(row).split("_")
    return f"{slope.removesuffix('deg')}°, {WIDTHS[width]}, {cell_words(row)}"


def cell_words(row):
    """The cell size of a case."""
    return f"{1000 * row['cell_size']:g} mm"


def cost_of_cases():
    """What whole runs cost."""
    heading = (
        "case",
        "time loop (s)",
        "command (s)",
        "steps",
        "sweeps",
        "µs per cell and step",
        "memory (MB)",
    )
    return table(
        heading,
        [
            (
                case_words(row),
                f"{row['wall_s']:.1f}",
                f"{row['command_s']:.1f}",
                str(row["steps"]),
                str(row["sweeps"]),
                f"{row['us_per_cell_and_step']:.1f}",
                f"{row['memory_mb']:.0f}",
            )
            for row in bench_rows()
        ],
    )


def reference_rows():
    """The case at 22 degrees and w = 10 cm on all grids, from coarse to fine."""
    return [row for row in bench_rows() if family_of(row) == "22deg_w10cm"]


def cost_shares():
    """Where the time of a run goes, in %."""
    rows = [
        (cell_words(row), *(f"{100 * row['share'][term]:.0f}" for term in TERMS))
        for row in reference_rows()
    ]
    return table(("cell", *TERMS), rows)


def cost_of_sweeps():
    """Time of the parts of a sweep, and its ratio to the bound of memory traffic."""
    rows = [
        (
            cell_words(row),
            *(
                f"{1e3 * row['sweep_s'][name]:.2f} ms, {row['over_bound'][name]:.0f}"
                for name in SWEEP
            ),
        )
        for row in reference_rows()
    ]
    return table(("cell", *SWEEP), rows)


def cost_of_effects():
    """Time loop with an effect over that without any."""
    rows = stored("bench", "effects.json")["cases"]
    return table(
        ("effect", "cost factor"),
        [
            (f"`{row['name']}`", f"{row['cost_factor']:.2f}")
            for row in rows
            if not row["name"].startswith(NO_EFFECT)
        ],
    ) + solver_line("bench/effects.json")
