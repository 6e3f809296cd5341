"""`cache`: the cache of runs."""

from argparse import Namespace
from pathlib import Path
from typing import Any


def add_parser(commands: Any) -> None:
    """Add `cache` to the commands."""
    parser = commands.add_parser(
        "cache", help="where the cache of runs is, how large; prune it", description=execute.__doc__
    )
    parser.add_argument(
        "--cache", metavar="FOLDER", type=Path, help="another one than that of this user"
    )
    parser.add_argument(
        "--prune",
        action="store_true",
        help="remove the runs that the present solver cannot use: of other versions, or damaged",
    )
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Print where finished runs are kept, how many and how large; with --prune remove those of no use."""
    from fvcollapse.studies.cache_size import cache_size, prune

    if arguments.prune:
        print(prune(arguments.cache).line("removed"))
    print(cache_size(arguments.cache).line("kept"))
    return 0
