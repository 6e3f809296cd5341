"""`plot`: pictures and an animation of results."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force, result_file
from fvcollapse.errors import InputError
from fvcollapse.files.plain_numbers import decimal_number

FORMATS, ANIMATIONS = ("png", "pdf", "svg"), ("gif", "mp4", "none")
DPI_LEAST, DPI_MOST = 20, 1200


def add_parser(commands: Any) -> None:
    """Add `plot` to the commands."""
    parser = commands.add_parser(
        "plot", help="draw pictures and an animation of a result", description=execute.__doc__
    )
    parser.add_argument(
        "results", metavar="RESULT", nargs="+", type=Path, help="result.h5, or the folder it is in"
    )
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="folder; default `pictures` beside the result"
    )
    parser.add_argument("--upright", action="store_true", help="rotate: gravity points down")
    parser.add_argument(
        "--times",
        metavar="SECONDS",
        nargs="+",
        type=decimal_number,
        default=[],
        help="times of the panels; the nearest stored ones are taken",
    )
    parser.add_argument(
        "--fields",
        metavar="FIELD",
        nargs="+",
        default=["speed", "pressure"],
        help="fields to draw (speed pressure shear_rate viscosity inertial_number, …)",
    )
    parser.add_argument("--format", choices=FORMATS, default="png", help="of the pictures")
    parser.add_argument("--dpi", metavar="N", type=int, default=130, help="dots per inch")
    parser.add_argument("--animation", choices=ANIMATIONS, default="gif", help="default gif")
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Draw the standard pictures and an animation of each result; print the files written."""
    results = [result_file(path) for path in arguments.results]
    folders = [arguments.out] * len(results)
    if arguments.out and len(results) > 1:
        folders = [arguments.out / name for name in distinct_names(results)]
    if not DPI_LEAST <= arguments.dpi <= DPI_MOST:
        allowed = f"{DPI_LEAST} to {DPI_MOST}"
        raise InputError("command line", "--dpi", str(arguments.dpi), allowed)
    from fvcollapse.draw.look import Look
    from fvcollapse.draw.pictures import claim_pictures, draw_all, refuse_look

    times, fields = tuple(arguments.times), tuple(dict.fromkeys(arguments.fields))
    file_kinds = arguments.format, arguments.dpi, arguments.animation
    look = Look(arguments.upright, times, fields, *file_kinds)
    places = [
        folder or path.parent / "pictures" for path, folder in zip(results, folders, strict=True)
    ]
    for result in results:  # all of them before the first folder is made
        refuse_look(result, look)
    for result, folder in zip(results, places, strict=True):
        claim_pictures(result, folder, arguments.force)
    for result, folder in zip(results, places, strict=True):
        for path in draw_all(result, folder, look):
            print(path)
    return 0


def distinct_names(results: list[Path]) -> list[str]:
    """One folder name per result file: the name of its folder, numbered if two are the same."""
    names = [result.resolve().parent.name for result in results]
    if len(set(names)) == len(names):
        return names
    return [f"{number}-{name}" for number, name in enumerate(names, start=1)]
