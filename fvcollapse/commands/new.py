"""`new`: commented templates of a case, an experiment, an effect."""

from typing import Any

from fvcollapse.commands import new_case, new_effect, new_experiment
from fvcollapse.commands.parser import add_commands


def add_parser(commands: Any) -> None:
    """Add `new` to the commands."""
    parser = commands.add_parser(
        "new",
        help="write a commented template of a case, an experiment or an effect",
        description="Write a commented template to fill in.",
    )
    parts = add_commands(parser)
    for part in (new_case, new_experiment, new_effect):
        part.add_parser(parts)
