"""`keys`: the keys of a case file or an experiment.toml."""

from argparse import Namespace
from typing import Any


def add_parser(commands: Any) -> None:
    """Add `keys` to the commands."""
    parser = commands.add_parser(
        "keys", help="list the keys of a case file", description=execute.__doc__
    )
    parser.add_argument(
        "--experiment", action="store_true", help="those of experiment.toml instead"
    )
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Print every key of the case file with its default, unit, range and meaning."""
    if arguments.experiment:
        from fvcollapse.measure.experiment_keys import describe_keys
    else:
        from fvcollapse.case.case import describe_keys

    rows = [("key", "default", "unit", "meaning; allowed")]
    rows += [
        (info.name, info.default, info.unit, f"{info.description}; {info.allowed}")
        for info in describe_keys()
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    for row in rows:
        first = "  ".join(word.ljust(width) for word, width in zip(row[:3], widths, strict=True))
        print(f"{first}  {row[3]}")
    return 0
