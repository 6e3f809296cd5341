"""`blind make`: sealed cases with hidden causes."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_quiet, add_scheduler, add_workers
from fvcollapse.files.plain_numbers import whole_number


def add_parser(commands: Any) -> None:
    """Add `blind make` to the commands of `blind`."""
    parser = commands.add_parser("make", help="make sealed cases", description=execute.__doc__)
    parser.add_argument(
        "--cases", metavar="N", type=whole_number, required=True, help="number of cases"
    )
    parser.add_argument(
        "--out",
        metavar="FOLDER",
        type=Path,
        required=True,
        help="one folder per case, and the seal",
    )
    parser.add_argument(
        "--labels", metavar="FILE", type=Path, help="default <FOLDER>.labels.json, beside it"
    )
    add_workers(parser)
    add_scheduler(parser)
    add_quiet(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Make experiments that hide an effect, two, none, or a cause outside the catalogue; continue them."""
    from fvcollapse.blind.seal import refuse_count
    from fvcollapse.studies.workers import Resources, refuse_workers

    refuse_workers(arguments.workers)
    refuse_count(arguments.cases)
    from fvcollapse.blind.make import make  # loads the compiler

    seal = make(
        arguments.cases,
        arguments.out,
        arguments.labels,
        resources=Resources(arguments.workers, arguments.scheduler, arguments.quiet),
    )
    print(seal)
    return 0
