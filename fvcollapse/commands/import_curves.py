"""`import-curves`: files of a digitising tool as an experiment folder."""

from argparse import Namespace
from math import isfinite
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force
from fvcollapse.errors import InputError
from fvcollapse.files.plain_numbers import decimal_number


def add_parser(commands: Any) -> None:
    """Add `import-curves` to the commands."""
    parser = commands.add_parser(
        "import-curves",
        help="make an experiment folder of digitised curves",
        description=execute.__doc__,
    )
    for option, what in (("--front", "time and front position"), ("--volume", "time and change")):
        parser.add_argument(option, metavar="FILE", type=Path, help=f"{what}, in two columns")
    for option, what in (("--profile", "x and thickness"), ("--interface", "x and height")):
        parser.add_argument(
            option,
            metavar="T=FILE",
            action="append",
            default=[],
            help=f"{what} at the time T [s], in two columns; may be repeated",
        )
    for option, choices in (
        ("--length-unit", ("m", "dm", "cm", "mm")),
        ("--time-unit", ("s", "ms")),
        ("--volume-unit", ("1", "%%")),
    ):
        parser.add_argument(
            option,
            choices=[choice.replace("%%", "%") for choice in choices],
            default=choices[0],
            help=f"of the files: {', '.join(choices)}; default {choices[0]}",
        )
    add_settings(parser)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, required=True, help="experiment folder"
    )
    add_force(parser)
    parser.set_defaults(command=execute)


def add_settings(parser: Any) -> None:
    """Where a front counts from, and the keys of the new experiment."""
    parser.add_argument(
        "--front-from",
        choices=("wall", "gate"),
        default="wall",
        help="where the positions of --front count from; gate: geometry.length_0 is added; default wall",
    )
    parser.add_argument(
        "--set",
        dest="settings",
        metavar="section.key=value",
        action="append",
        default=[],
        help="a key of the new experiment.toml; may be repeated",
    )


def execute(arguments: Namespace) -> int:
    """Write digitised curves (x, y; up to three header lines; any column and decimal mark) as an experiment."""
    from fvcollapse.measure.digitised import (
        Units,
        missing_settings,
        read_ranges,
        write_experiment,
    )

    units = Units(arguments.length_unit, arguments.time_unit, arguments.volume_unit)
    changes = {"settings": arguments.settings, "force": arguments.force}
    written = write_experiment(sources_of(arguments), arguments.out, units, **changes)
    for path in written:
        print(path)
    for line in read_ranges(written):
        print(line)
    missing = missing_settings(arguments.out)
    if missing:
        print(f"still to be filled in: {missing}")
    return 0


def sources_of(arguments: Namespace) -> list:
    """The digitised files that are named, as `Source`s."""
    from fvcollapse.measure.digitised import Source, gate_position

    from_gate = arguments.front_from == "gate"
    origin = gate_position(arguments.settings, arguments.out) if from_gate else 0.0
    named = (("front", arguments.front, origin), ("volume", arguments.volume, 0.0))
    sources = [Source(name, path, None, place) for name, path, place in named if path is not None]
    for option, name in (("profile", "profiles"), ("interface", "interface")):
        sources += [Source(name, *timed(option, text)) for text in getattr(arguments, option)]
    return sources


def timed(option: str, text: str) -> tuple:
    """(path, time [s]) of T=FILE."""
    time, _, path = text.partition("=")
    try:
        number = decimal_number(time)
    except ValueError:
        number = float("nan")
    if not (isfinite(number) and path):
        raise InputError("command line", f"--{option}", repr(text), "T=FILE with a time T in s")
    return Path(path), number
