"""`run`: one simulation."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_case, add_dry_run, add_force, add_quiet, result_file


def add_parser(commands: Any) -> None:
    """Add `run` to the commands."""
    parser = commands.add_parser("run", help="run one simulation", description=execute.__doc__)
    add_case(parser)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="result folder; default out/<name of the case>"
    )
    parser.add_argument(
        "--from",
        dest="deposit",
        metavar="RUN",
        type=Path,
        help="start from the deposit of another run (result.h5, or its folder), without a gate",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="continue also to another end, or with other outputs",
    )
    add_force(parser)
    add_quiet(parser)
    add_dry_run(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Run one simulation and print its summary."""
    from fvcollapse.case.case import load_case
    from fvcollapse.files.targets import refuse_file

    case = load_case(arguments.case, arguments.overrides)
    if arguments.deposit is not None:
        from fvcollapse.output.deposit import from_deposit
        from fvcollapse.output.result import open_result

        case = from_deposit(open_result(result_file(arguments.deposit)), case)
    folder = arguments.out or Path("out") / arguments.case.stem
    refuse_file(folder)
    if arguments.dry_run:
        from fvcollapse.studies.estimate import plan_of

        print(plan_of([case]).line())
        return 0
    from fvcollapse.output.run import run_case  # heavy, and not needed to refuse a bad case
    from fvcollapse.output.run_folder import holds_run

    resume = arguments.resume or holds_run(case, folder)
    result = run_case(case, folder, resume, quiet=arguments.quiet, force=arguments.force)
    print(result.summary_table())
    return 0
