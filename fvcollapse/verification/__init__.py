"""Verification: flows with an exact solution, run through the solver of the collapse."""

import difflib
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from fvcollapse.console.interruption import deferred_interrupt
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.question import claim_file
from fvcollapse.verification.names import CPU_TIME, NAMES


def verify(
    names: Sequence[str] | None = None,
    json_path: str | Path | None = None,
    markdown_path: str | Path | None = None,
    force: bool = False,
) -> list[dict]:
    """Solve the named verification problems (all, if none are named); print and write the table.

    Parameters
    ----------
    names : sequence of str, optional
        Problems, as in `verification.names.NAMES`.
    json_path : str or Path, optional
        Where to write the list of rows.
    markdown_path : str or Path, optional
        Where to write the table term, file, problem, error.

    Returns
    -------
    list of dict
        One row per problem: name, grids, error_l1, error_l2, error_linf, observed_order,
        expected_order, tolerance, passed.

    Raises
    ------
    InputError
        A name is that of no problem, or a path cannot be written.
    KeyboardInterrupt
        After what was solved until then has been written.
    """
    asked = [named(name) for name in names or NAMES]
    for path in (json_path, markdown_path):
        claim_file(path, force)
    from fvcollapse.verification.problem import solve  # these load the solver
    from fvcollapse.verification.problems.all import PROBLEMS
    from fvcollapse.verification.tables import HEADING, json_text, markdown_table, table_line

    problems = {problem.name: problem for problem in PROBLEMS}
    chosen = [problems[name] for name in asked]
    rows: list[dict] = []
    print(cost(asked), file=sys.stderr, flush=True)
    print(HEADING)
    try:
        with heeded_between_steps():
            for problem in chosen:
                rows.append(solve(problem))
                print(table_line(rows[-1]), flush=True)
    except KeyboardInterrupt:
        print(f"stopped after {len(rows)} of {len(chosen)} problems", file=sys.stderr)
        raise
    finally:
        for path, text in (
            (json_path, json_text(rows)),
            (markdown_path, markdown_table(rows, problems)),
        ):
            if path is not None and rows:
                write_atomic(Path(path), text.encode())
    return rows


@contextmanager
def heeded_between_steps() -> Iterator[None]:
    """Defer Ctrl-C to the end of a time step of the flow that is running."""
    from fvcollapse.verification.flows import INTERRUPTED

    with deferred_interrupt() as interrupted:
        token = INTERRUPTED.set(interrupted)
        try:
            yield
        finally:
            INTERRUPTED.reset(token)


def cost(names: Sequence[str]) -> str:
    """How many problems are solved, and how long all of them take."""
    return (
        f"{len(names)} of {len(NAMES)} problems (the whole set takes {CPU_TIME}, compilation aside)"
    )


def named(name: str) -> str:
    """The name of a problem, if there is one of that name.

    Raises
    ------
    InputError
        One line with the closest name, if one is close.
    """
    if name not in NAMES:
        near = difflib.get_close_matches(name, NAMES, n=1)
        closest = f"the closest is {near[0]}" if near else "`fvcollapse verify --list` has them"
        allowed = f"a verification problem; {closest}"
        raise InputError("command line", "NAME", name, allowed)
    return name
