"""Arguments that several commands share."""

import os
from pathlib import Path
from typing import Any

from fvcollapse.files.plain_numbers import whole_number

# the rule of `output.question`, as the help states it
RULE = (
    "Results are never overwritten without --force. The same question asked again continues: it finds "
    "its own results, finishes what is missing and renews its tables and pictures. A folder or file "
    "with anything else in it is refused before anything is computed."
)


def add_case(parser: Any) -> None:
    """The case file, and changes to it."""
    parser.add_argument("case", metavar="CASE.toml", type=Path, help="case file")
    parser.add_argument(
        "--set",
        dest="overrides",
        metavar="section.key=value",
        action="append",
        default=[],
        help="change one key of the case; may be repeated",
    )


def result_file(path: Path) -> Path:
    """The result file that a path means: itself, or `result.h5` in a folder.

    Raises
    ------
    InputError
        There is no such file.
    """
    from fvcollapse.files.regular import refuse_unreadable

    result = path / "result.h5" if os.path.isdir(path) else path
    refuse_unreadable(result, "a result.h5, or a folder that holds one")
    return result


def add_force(parser: Any) -> None:
    """The option to overwrite, and the rule that it lifts."""
    parser.add_argument(
        "--force",
        action="store_true",
        help="replace results of another question that are in the way",
    )
    parser.epilog = RULE


def add_workers(parser: Any, default: int = 1) -> None:
    """The number of processes that make many runs."""
    parser.add_argument(
        "--workers",
        metavar="N",
        type=whole_number,
        default=default,
        help=f"processes; default {default}",
    )


def add_scheduler(parser: Any) -> None:
    """The cluster that makes many runs, in place of processes of this machine."""
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask scheduler, whose workers run the cases"
    )


def add_dry_run(parser: Any) -> None:
    """The option that only says what would be run."""
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="only print the number of runs and the time they take",
    )


def add_quiet(parser: Any) -> None:
    """The option without a progress bar."""
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
