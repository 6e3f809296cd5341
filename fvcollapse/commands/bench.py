"""`bench`: the cost of fixed cases."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force, add_quiet
from fvcollapse.console.interruption import raised_interrupt
from fvcollapse.files.plain_numbers import decimal_number


def add_parser(commands: Any) -> None:
    """Add `bench` to the commands."""
    parser = commands.add_parser(
        "bench", help="measure the cost of fixed cases", description=execute.__doc__
    )
    parser.add_argument("names", metavar="NAME", nargs="*", help="cases; default all to 3 mm")
    parser.add_argument("--finest", action="store_true", help="without names: also 1.5 mm")
    parser.add_argument(
        "--effects", action="store_true", help="the cost of each effect instead; names are effects"
    )
    parser.add_argument(
        "--end", metavar="SECONDS", type=decimal_number, help="cut the collapses short"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the report as JSON")
    add_force(parser)
    add_quiet(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Run fixed cases, each in a process of its own; print times, sweeps, memory and the bound."""
    from fvcollapse.output.question import claim_file

    claim_file(arguments.json, arguments.force)
    from fvcollapse.studies.bench import run_bench, table

    with raised_interrupt():  # ends the processes of the cases
        report = run_bench(
            arguments.names,
            arguments.json,
            arguments.quiet,
            arguments.effects,
            arguments.end,
            arguments.finest,
        )
    print(table(report))
    return 0
