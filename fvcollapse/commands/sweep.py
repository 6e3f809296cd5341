"""`sweep`: the product of variations of a case."""

import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import (
    add_case,
    add_dry_run,
    add_force,
    add_quiet,
    add_scheduler,
    add_workers,
)


def add_parser(commands: Any) -> None:
    """Add `sweep` to the commands."""
    parser = commands.add_parser(
        "sweep", help="run a case at all combinations of values", description=execute.__doc__
    )
    add_case(parser)
    parser.add_argument(
        "--vary",
        dest="variations",
        metavar="section.key=a,b,c",
        action="append",
        required=True,
        help="values of one key; may be repeated",
    )
    add_workers(parser)
    add_scheduler(parser)
    add_quiet(parser)
    add_dry_run(parser)
    add_force(parser)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, required=True, help="one folder per point inside"
    )
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Run a case at all combinations of values; continue what is there; write sweep.csv."""
    from fvcollapse.case.case import load_case

    case = load_case(arguments.case, arguments.overrides)
    from fvcollapse.files.targets import refuse_file
    from fvcollapse.studies.estimate import plan_of
    from fvcollapse.studies.sweep import TABLE, all_points, parse_variation, sweep, table
    from fvcollapse.studies.workers import Resources

    variations: dict[str, list] = {}
    for text in arguments.variations:
        key, values = parse_variation(text)
        variations.setdefault(key, []).extend(values)
    refuse_file(arguments.out)
    if arguments.dry_run:
        points = all_points(case, variations, str(arguments.case))
        print(plan_of([point.case for point in points]).line(arguments.workers))
        return 0
    rows = sweep(
        case,
        variations,
        arguments.out,
        Resources(arguments.workers, arguments.scheduler, arguments.quiet),
        source=str(arguments.case),
        force=arguments.force,
    )
    print(table(rows))
    print(arguments.out / TABLE)
    failed = [row for row in rows if row["status"] != "complete"]
    for row in failed:
        print(f"{row['point']}: {row['problem']}", file=sys.stderr)
    return 1 if failed else 0
