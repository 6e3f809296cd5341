"""`new experiment`: an experiment folder to fill in."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force


def add_parser(commands: Any) -> None:
    """Add `new experiment` to the commands of `new`."""
    parser = commands.add_parser(
        "experiment", help="an experiment folder to fill in", description=execute.__doc__
    )
    parser.add_argument("folder", metavar="FOLDER", type=Path, help="folder to make")
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Write an experiment.toml with every key as a comment, and name the CSV files that belong beside it."""
    from fvcollapse.files.atomic import write_atomic
    from fvcollapse.files.targets import make_folder
    from fvcollapse.measure.experiment import SETTINGS
    from fvcollapse.measure.experiment_template import experiment_template
    from fvcollapse.output.question import claim_file

    path = arguments.folder / SETTINGS
    if arguments.folder.exists():
        claim_file(path, arguments.force)
    make_folder(arguments.folder)
    write_atomic(path, experiment_template().encode(), running=False)
    print(path)
    return 0
