"""`new effect`: the module of an effect to fill in."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force


def add_parser(commands: Any) -> None:
    """Add `new effect` to the commands of `new`."""
    parser = commands.add_parser(
        "effect", help="the module of an effect to fill in", description=execute.__doc__
    )
    parser.add_argument("name", metavar="NAME", help="of the effect, such as rolling_friction")
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, default=Path(), help="default: the present folder"
    )
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Write NAME.py, an effect that changes one key of the case and can be run as it is; print what follows."""
    from fvcollapse.effects.template import effect_template
    from fvcollapse.files.atomic import write_atomic
    from fvcollapse.files.targets import make_folder
    from fvcollapse.output.question import claim_file

    text = effect_template(arguments.name)
    path = arguments.out / f"{arguments.name}.py"
    if arguments.out.exists():
        claim_file(path, arguments.force)
    make_folder(arguments.out)
    write_atomic(path, text.encode(), running=False)
    print(path)
    print(
        f'Put it into fvcollapse/effects and "{arguments.name}" into NAMES of fvcollapse/effects/catalogue.py'
    )
    return 0
