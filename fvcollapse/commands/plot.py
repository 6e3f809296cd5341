"""`plot`: pictures and an animation of results."""

import os
from pathlib import Path

from fvcollapse.commands.arguments import add_force


def add_parser(commands):
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
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments):
    """Draw the standard pictures and an animation of each result; print the files written."""
    results = [result_file(path) for path in arguments.results]
    folders = [arguments.out] * len(results)
    if arguments.out and len(results) > 1:
        folders = [arguments.out / name for name in distinct_names(results)]
    from fvcollapse.draw.pictures import claim_pictures, draw_all

    places = [
        folder or path.parent / "pictures" for path, folder in zip(results, folders, strict=True)
    ]
    for result, folder in zip(results, places, strict=True):
        claim_pictures(result, folder, arguments.force)
    for result, folder in zip(results, places, strict=True):
        for path in draw_all(result, folder):
            print(path)
    return 0


def result_file(path):
    """The result file that a path means: itself, or `result.h5` in a folder."""
    from fvcollapse.files.regular import refuse_unreadable

    result = path / "result.h5" if os.path.isdir(path) else path
    refuse_unreadable(result, "a result.h5, or a folder that holds one")
    return result


def distinct_names(results):
    """One folder name per result file: the name of its folder, numbered if two are the same."""
    names = [result.resolve().parent.name for result in results]
    if len(set(names)) == len(names):
        return names
    return [f"{number}-{name}" for number, name in enumerate(names, start=1)]
