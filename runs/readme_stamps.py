"""Which solver made the stored tables, for the README of the studies."""

from runs.readme_tables import table
from runs.remake import files_of
from runs.remake_tasks import TASKS
from runs.stamps import ROOT, digest, read_stamps

OLDER = "none: made before stamps were kept, by an earlier solver, or changed since"


def made_by():
    """Tasks by the version of the solver that their stamps name; figures, which follow, are left out."""
    stamps, rows = read_stamps(), {}
    for task in TASKS:
        if not task.reads:
            rows.setdefault(solver_of(task, stamps), []).append(task.name)
    solvers = sorted(rows, key=lambda solver: (solver == OLDER, solver))
    lines = [
        (f"`{solver}`" if solver != OLDER else solver, told(rows[solver])) for solver in solvers
    ]
    return table(("stamp", "tables"), lines)


def solver_of(task, stamps):
    """The code that the stamps of all tables of a task name."""
    found = {stamped_code(name, stamps) for name in files_of(task.makes)}
    return found.pop() if len(found) == 1 else OLDER


def stamped_code(name, stamps):
    """The code that the stamp of a table names, `OLDER` if there is none or the table has changed since."""
    stamp = stamps.get(name)
    valid = stamp and (ROOT / name).exists() and stamp["content"] == digest(ROOT / name)
    return stamp["code"] if valid else OLDER


def told(names):
    """Names of tasks, those of one study together."""
    studies = {}
    for name in names:
        study, _, part = name.partition(" ")
        studies.setdefault(study, []).append(f"`{part}`" if part else "all")
    return "; ".join(f"{study}: {', '.join(parts)}" for study, parts in studies.items())


def solver_line(*names):
    """A paragraph that names the solver of some tables below `runs`; it ends a generated part."""
    stamps = read_stamps()
    found = {stamped_code(f"runs/{name}", stamps) for name in names}
    solver = (
        "an earlier solver"
        if OLDER in found
        else "solver " + ", ".join(f"`{of}`" for of in sorted(found))
    )
    tables = ", ".join(f"`{name}`" for name in names)
    return f"\nMade by {solver}: {tables}.\n"
