"""`verify`: the solver against exact solutions."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force


def add_parser(commands: Any) -> None:
    """Add `verify` to the commands."""
    parser = commands.add_parser(
        "verify", help="compare the solver with exact solutions", description=execute.__doc__
    )
    parser.add_argument(
        "names", metavar="NAME", nargs="*", help="verification problems; default all"
    )
    parser.add_argument("--list", action="store_true", help="print the names and what they test")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the table as JSON")
    parser.add_argument(
        "--markdown",
        metavar="FILE",
        type=Path,
        help="write it by term of the equations, for a page",
    )
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Solve flows with an exact solution on several grids; print errors and orders (0: all pass)."""
    if arguments.list:
        return print_problems()
    from fvcollapse.verification import verify as verify_problems

    rows = verify_problems(arguments.names, arguments.json, arguments.markdown, arguments.force)
    return 0 if all(row["passed"] for row in rows) else 1


def print_problems() -> int:
    """Print the name of every problem and the term of the equations that it tests."""
    from fvcollapse.verification.problems.all import PROBLEMS

    width = max(len(problem.name) for problem in PROBLEMS)
    for problem in PROBLEMS:
        print(f"{problem.name:<{width}}  {problem.term.words}")
    return 0
