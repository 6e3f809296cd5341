"""`converge`: one case at several values of one numerical parameter."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_case, add_dry_run, add_force, add_quiet, add_workers
from fvcollapse.files.plain_numbers import decimal_number


def add_parser(commands: Any) -> None:
    """Add `converge` to the commands."""
    parser = commands.add_parser(
        "converge",
        help="refine one numerical parameter; observed order and GCI of each observable",
        description=execute.__doc__,
    )
    add_case(parser)
    axes = parser.add_mutually_exclusive_group(required=True)
    for option, what in (
        ("--cell-size", "cell sizes [m]"),
        ("--time-step", "longest time steps [s]"),
        ("--shear-rate-min", "shear rates of the regularisation [1/s]"),
        ("--tolerance", "tolerances of the nonlinear iteration"),
    ):
        axes.add_argument(option, metavar="VALUE", nargs="+", type=decimal_number, help=what)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="default out/<name of the case>_<parameter>"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the table there as well")
    add_force(parser)
    add_workers(parser)
    add_quiet(parser)
    add_dry_run(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Run a case at three or more values of one parameter; print and write the convergence."""
    from fvcollapse.case.case import load_case

    case = load_case(arguments.case, arguments.overrides)
    from fvcollapse.files.targets import refuse_file
    from fvcollapse.output.question import claim_file
    from fvcollapse.studies.estimate import plan_of
    from fvcollapse.studies.refinement import AXES, Series, checked_values, member_case, refine
    from fvcollapse.studies.workers import Resources

    axis = next(name for name in AXES if getattr(arguments, name) is not None)
    values = getattr(arguments, axis)
    source, folder = str(arguments.case), arguments.out
    folder = folder or Path("out") / f"{arguments.case.stem}_{axis}"
    members = [member_case(case, axis, value, source) for value in checked_values(axis, values)]
    refuse_file(folder)
    if arguments.dry_run:
        print(plan_of(members).line(arguments.workers))
        return 0
    from fvcollapse.studies.refinement_report import NAME, table, write_report  # draws: heavy

    claim_file(arguments.json, arguments.force, copy_of=folder / f"{NAME}.json")
    records = refine(
        Series(case, axis, values, source),
        folder,
        Resources(arguments.workers, quiet=arguments.quiet),
        force=arguments.force,
    )
    paths = write_report(records, axis, case, folder, arguments.json)
    print(f"\n{table(records, axis, case)}\n")
    for path in paths:
        print(path)
    finished = next(iter(records.values()))[axis]
    return 0 if len(finished) == len(values) else 1
