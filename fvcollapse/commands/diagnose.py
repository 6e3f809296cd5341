"""`diagnose`: the gap between experiments and a model."""

from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import (
    add_dry_run,
    add_force,
    add_quiet,
    add_scheduler,
    add_workers,
)
from fvcollapse.commands.diagnose_each import diagnose_each
from fvcollapse.commands.parser import MissingArguments, nearest
from fvcollapse.errors import InputError
from fvcollapse.files.plain_numbers import decimal_number, whole_number


def add_parser(commands: Any) -> None:
    """Add `diagnose` to the commands."""
    parser = commands.add_parser(
        "diagnose",
        help="where experiments and model differ, which effect causes it, how far adding it helps",
        description=execute.__doc__,
    )
    add_experiments(parser)
    add_settings(parser)
    add_workers(parser, 2)
    add_scheduler(parser)
    add_quiet(parser)
    add_dry_run(parser)
    parser.add_argument(
        "--each",
        action="store_true",
        help="diagnose each experiment, or each in a folder of them, by itself, into <FOLDER>/<its name>; summary.csv"
        " has all answers",
    )
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="folder of the report; needed without --dry-run"
    )
    add_force(parser)
    parser.set_defaults(command=execute)


def add_experiments(parser: Any) -> None:
    """The experiments, the case to compare them with, and the part that each of them has."""
    parser.add_argument(
        "experiments", metavar="EXPERIMENT", nargs="+", type=Path, help="experiment folders"
    )
    parser.add_argument(
        "--case", metavar="CASE.toml", type=Path, help="what is believed; default: no effects"
    )
    parser.add_argument(
        "--hold-out",
        metavar="EXPERIMENT",
        nargs="+",
        type=Path,
        default=[],
        help="experiments that only test what was found",
    )
    parser.add_argument(
        "--controls",
        metavar="EXPERIMENT",
        nargs="+",
        type=Path,
        default=[],
        help="experiments in which nothing is hidden: they teach the discrepancy of the model",
    )


def add_settings(parser: Any) -> None:
    """How the experiments are compared."""
    parser.add_argument(
        "--effects", metavar="a,b,...", help="only these of the catalogue; default all"
    )
    parser.add_argument(
        "--cell-size",
        metavar="VALUE",
        type=decimal_number,
        help="of the coarser of two grids [m]; default a twelfth of the height",
    )
    parser.add_argument(
        "--seed", metavar="N", type=whole_number, default=0, help="of all draws; default 0"
    )
    parser.add_argument(
        "--cache", metavar="FOLDER", type=Path, help="where finished runs are kept and found"
    )


def execute(arguments: Namespace) -> int:
    """Compare experiments with a model and its possible effects; continue what is there; write a report."""
    from fvcollapse.diagnosis.report import FILE_NAME

    if arguments.each:
        arguments.experiments = inside(arguments.experiments)
    refuse_unread(arguments)
    if arguments.dry_run:
        return print_plan(arguments)
    from fvcollapse.diagnosis.report.page import PAGE  # heavy, and not needed to refuse bad input

    if arguments.each:
        list(questions(arguments))  # all of them are checked before the first is diagnosed
        return diagnose_each(
            arguments.experiments,
            arguments.out,
            lambda experiment, folder: asked(arguments, [experiment], folder),
            arguments.force,
        )
    print_answer(asked(arguments, arguments.experiments, arguments.out))
    print(f"\n{arguments.out / FILE_NAME}\n{arguments.out / PAGE}")
    return 0


def refuse_unread(arguments: Namespace) -> None:
    """Refuse folders, files and names that are wrong by themselves, before the solver is loaded.

    Raises
    ------
    InputError, OutputError
    """
    from fvcollapse.case.case import load_case
    from fvcollapse.files.targets import refuse_file
    from fvcollapse.measure.experiment import load_experiment

    if arguments.out is None and not arguments.dry_run:
        where = "see `fvcollapse diagnose --help`"
        raise MissingArguments("command line", "fvcollapse diagnose", "--out", where)
    for folder in (*arguments.experiments, *arguments.hold_out, *arguments.controls):
        load_experiment(folder)
    if arguments.case is not None:
        load_case(arguments.case)
    refuse_effects(effects_of(arguments))
    if arguments.out is not None:
        refuse_file(arguments.out)


def inside(folders: list[Path]) -> list[Path]:
    """The experiments in these folders: themselves, or those that they hold."""
    from fvcollapse.measure.experiment import SETTINGS

    found: list[Path] = []
    for folder in folders:
        held = sorted(path.parent for path in folder.glob(f"*/{SETTINGS}"))
        found += [folder] if (folder / SETTINGS).exists() or not held else held
    return found


def refuse_effects(names: list[str] | None) -> None:
    """Refuse a name that is no effect of the catalogue, with the one that was perhaps meant.

    Raises
    ------
    InputError
    """
    from fvcollapse.diagnosis.levels import applicable_effects

    try:
        applicable_effects({}, names)
    except InputError as error:
        meant = nearest(error.found.strip("'\""), error.allowed.split(", "))
        hint = f"; did you mean {meant}?" if meant else ""
        raise InputError(error.file, error.key, error.found, f"{error.allowed}{hint}") from None


def asked(arguments: Namespace, experiments: list, folder: Path) -> Any:
    """The report of some experiments, with the settings of the command."""
    from fvcollapse.diagnosis.diagnose import diagnose as diagnose_all

    return diagnose_all(
        experiments,
        arguments.case,
        arguments.hold_out,
        effects_of(arguments),
        arguments.workers,
        arguments.scheduler,
        folder,
        arguments.cell_size,
        arguments.seed,
        controls=arguments.controls,
        cache=arguments.cache,
        quiet=arguments.quiet,
        force=arguments.force,
    )


def effects_of(arguments: Namespace) -> list[str] | None:
    """Names of the effects that are to be tried; None for all."""
    effects = arguments.effects
    return None if effects is None else [name.strip() for name in effects.split(",")]


def print_answer(report: Any) -> None:
    """Print the headline, the answer and the probability of every hypothesis."""
    from fvcollapse.diagnosis.report.sentences import answer, headline
    from fvcollapse.diagnosis.report.words import hypothesis_name, wrapped

    for line in (headline(report), *answer(report)):
        print(wrapped(line, 100))
    print()
    ranked = sorted(report.verdict.probability.items(), key=lambda item: -item[1])
    width = max(len(hypothesis_name(name)) for name, _ in ranked)
    for name, chance in ranked:
        print(f"{hypothesis_name(name):<{width}}  {chance:6.3f}")


def questions(arguments: Namespace) -> Iterator[Any]:
    """The `Question` of all experiments, or of each one."""
    from fvcollapse.diagnosis.diagnose import ask

    groups = [[one] for one in arguments.experiments] if arguments.each else [arguments.experiments]
    for group in groups:
        yield ask(
            group,
            arguments.hold_out,
            arguments.controls,
            arguments.case,
            arguments.cell_size,
            arguments.seed,
        )


def print_plan(arguments: Namespace) -> int:
    """Print what is odd, how many runs there would be, and how long they take; nothing is written."""
    from fvcollapse.diagnosis.oddities import coarse_grid, oddities_of, tell
    from fvcollapse.diagnosis.plan import plan_diagnosis

    for question in questions(arguments):
        compared = (*question.experiments, *question.held_out, *question.controls)
        tell([*oddities_of(compared), *coarse_grid(question)])
        plan = plan_diagnosis(question, effects_of(arguments), cache=arguments.cache)
        name = f"{question.experiments[0].name}: " if arguments.each else ""
        print(f"{name}{plan.line(arguments.workers)}")
    return 0
