"""`new case`: a case file with every key as a comment."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force


def add_parser(commands: Any) -> None:
    """Add `new case` to the commands of `new`."""
    parser = commands.add_parser(
        "case", help="a case file with every key as a comment", description=execute.__doc__
    )
    parser.add_argument("path", metavar="CASE.toml", type=Path, help="file to write")
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Write a case file in which every key is a comment with its default, unit, meaning and range."""
    from fvcollapse.case.template import case_template
    from fvcollapse.files.atomic import write_atomic
    from fvcollapse.files.targets import make_folder
    from fvcollapse.output.question import claim_file

    if arguments.path.parent.exists():
        claim_file(arguments.path, arguments.force)
    make_folder(arguments.path.parent)
    write_atomic(arguments.path, case_template().encode(), running=False)
    print(arguments.path)
    return 0
