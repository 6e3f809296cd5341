"""`examples`: the case and the experiments that come with the package."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force


def add_parser(commands: Any) -> None:
    """Add `examples` to the commands."""
    parser = commands.add_parser(
        "examples",
        help="write the case and the experiments that come with the package",
        description=execute.__doc__,
    )
    parser.add_argument(
        "folder",
        metavar="FOLDER",
        type=Path,
        nargs="?",
        default=Path(),
        help="in which `runs` is made; default: the present folder",
    )
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Write the case and the experiments of the READMEs into FOLDER/runs, where their commands expect them."""
    from fvcollapse.files.atomic import write_atomic
    from fvcollapse.files.shipped import shipped_files
    from fvcollapse.files.targets import has_contents, make_folder
    from fvcollapse.output.question import claim_file

    runs = arguments.folder / "runs"
    contents = {runs / name: path.read_bytes() for name, path in shipped_files().items()}
    missing = {path: data for path, data in contents.items() if not has_contents(path, data)}
    for path in missing:  # all of them before the first is written
        if path.parent.is_dir():
            claim_file(path, arguments.force)
    for path, data in missing.items():
        make_folder(path.parent)
        write_atomic(path, data, running=False)
    experiments = sum(path.name == "experiment.toml" for path in contents)
    print(f"{runs}: 1 case, {experiments} experiments, {len(missing)} files written")
    return 0
