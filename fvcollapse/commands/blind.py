"""`blind`: the blind check of the diagnosis."""

from typing import Any

from fvcollapse.commands import blind_make, blind_score
from fvcollapse.commands.parser import add_commands


def add_parser(commands: Any) -> None:
    """Add `blind` to the commands."""
    parser = commands.add_parser(
        "blind",
        help="make sealed synthetic cases, score the answers to them",
        description="The blind check of the diagnosis.",
    )
    parts = add_commands(parser)
    blind_make.add_parser(parts)
    blind_score.add_parser(parts)
