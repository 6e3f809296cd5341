"""`compare`: a run beside another run, or beside an experiment."""

import csv
import io
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force, result_file

TABLE = "differences.csv"


def add_parser(commands: Any) -> None:
    """Add `compare` to the commands."""
    parser = commands.add_parser(
        "compare",
        help="a run beside another run or an experiment: overlay and table of differences",
        description=execute.__doc__,
    )
    parser.add_argument("run", metavar="RUN", type=Path, help="result.h5, or the folder it is in")
    parser.add_argument("other", metavar="OTHER", type=Path, help="another run, or an experiment")
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="default out/compare_<run>_<other>"
    )
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Compare a run with another run or with an experiment; print the differences, write them and a picture."""
    from fvcollapse.measure.experiment import SETTINGS, load_experiment
    from fvcollapse.output.question import claim_folder
    from fvcollapse.output.result import open_result

    result = open_result(result_file(arguments.run))
    other: Any = None
    experiment: Any = None
    if (arguments.other / SETTINGS).exists():
        experiment = load_experiment(arguments.other)
    else:
        other = open_result(result_file(arguments.other))
    from fvcollapse.draw.comparison import draw_comparison  # heavy, and not needed to refuse a file
    from fvcollapse.measure.comparison import (
        COLUMNS,
        between_runs,
        remarks,
        table,
        to_experiment,
    )

    names = [named(path) for path in (arguments.run, arguments.other)]
    folder = arguments.out or Path("out") / f"compare_{'_'.join(names)}"
    rows = to_experiment(result, experiment) if experiment else between_runs(result, other)
    question = {"run": str(arguments.run.resolve()), "other": str(arguments.other.resolve())}
    claim_folder(folder, "compare", question, arguments.force)
    picture = draw_comparison(folder, names, result, other, experiment)
    print(table(rows, names))
    for remark in remarks(names, result, other, experiment):
        print(remark)
    for path in (write_table(rows, COLUMNS, folder), picture):
        print(path)
    return 0


def named(path: Path) -> str:
    """Name of a run or an experiment: that of its folder."""
    path = path.resolve()
    return path.parent.name if path.suffix == ".h5" else path.name


def write_table(rows: list, columns: Sequence[str], folder: Path) -> Path:
    """Write the differences as CSV; the path."""
    from fvcollapse.files.atomic import write_atomic

    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([columns, *rows])
    path = folder / TABLE
    write_atomic(path, stream.getvalue().encode())
    return path
