"""The command line: parses, calls one function per command, turns errors into an exit status.

0 done; 1 the computation failed (what was computed is kept); 2 bad input; 130, 143, 129 ended by Ctrl-C,
SIGTERM, SIGHUP. Errors are one line on stderr. The commands import what they need themselves, so that
`--help` is instant. Where results may be written says `question`, what a signal does `interruption`, what
is done where nothing can be printed `streams`.
"""

import argparse
import os
import sys
import textwrap
from math import isfinite
from pathlib import Path

from fvcollapse.console.interruption import ended_at_once, exit_status, raised_interrupt
from fvcollapse.console.streams import guarded_streams
from fvcollapse.errors import FvcollapseError, InputError, one_line
from fvcollapse.files.overwriting import FORCE, RULE
from fvcollapse.files.plain_numbers import decimal_number, whole_number
from fvcollapse.version import __version__


def main(argv=None):
    """Run one command; return its exit status."""
    with ended_at_once(), guarded_streams() as final:
        try:
            status = outcome(argv)
        except SystemExit as end:  # --help and --version
            status = end.code or 0
        return final(status)


def outcome(argv):
    """Exit status of one command; an error is one line on stderr."""
    # no command opens a window, whatever the notebooks of the user need
    os.environ["MPLBACKEND"] = "agg"
    try:
        arguments = command_line().parse_args(argv)
        return arguments.command(arguments)
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except MemoryError as error:
        print(f"out of memory: {one_line(error)}; larger cells need less", file=sys.stderr)
        return 1
    except KeyboardInterrupt as error:
        print("interrupted", file=sys.stderr)
        return exit_status(error)


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, as all others."""

    def error(self, message):
        """Refuse the arguments."""
        usage = f"the arguments listed by `{self.prog} --help`"
        raise InputError("command line", self.prog, one_line(message), usage)


def command_line():
    """The parser of all commands; each sets `command` to its function."""
    parser = Parser(
        prog="fvcollapse", description="Granular column collapse on a slope.", epilog=RULE
    )
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    add_run(commands)
    add_plot(commands)
    add_verify(commands)
    add_converge(commands)
    add_bench(commands)
    add_sweep(commands)
    add_blind(commands)
    add_diagnose(commands)
    add_import_curves(commands)
    add_keys(commands)
    return parser


def add_case(parser):
    """A case file, and changes to it."""
    parser.add_argument("case", metavar="CASE.toml", type=Path, help="case file")
    parser.add_argument(
        "--set",
        dest="overrides",
        metavar="section.key=value",
        action="append",
        default=[],
        help="change one key of the case; may be repeated",
    )


def add_force(parser):
    """The option to overwrite, and the rule that it lifts."""
    parser.add_argument("--force", action="store_true", help=FORCE)
    parser.epilog = RULE


def add_run(commands):
    """`run`: one simulation."""
    parser = commands.add_parser("run", help="run one simulation", description=run.__doc__)
    add_case(parser)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="result folder; default out/<name of the case>"
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="continue also to another end, or with other outputs",
    )
    add_force(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    parser.set_defaults(command=run)


def run(arguments):
    """Run one simulation and print its summary."""
    from fvcollapse.case.case import load_case

    case = load_case(arguments.case, arguments.overrides)
    from fvcollapse.output.run import run_case  # heavy, and not needed to refuse a bad case
    from fvcollapse.output.run_folder import holds_run

    folder = arguments.out or Path("out") / arguments.case.stem
    resume = arguments.resume or holds_run(case, folder)
    result = run_case(case, folder, resume, quiet=arguments.quiet, force=arguments.force)
    print(result.summary_table())
    return 0


def add_plot(commands):
    """`plot`: pictures and an animation."""
    parser = commands.add_parser(
        "plot", help="draw pictures and an animation of a result", description=plot.__doc__
    )
    parser.add_argument(
        "results", metavar="RESULT", nargs="+", type=Path, help="result.h5, or the folder it is in"
    )
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, help="folder; default `pictures` beside the result"
    )
    add_force(parser)
    parser.set_defaults(command=plot)


def plot(arguments):
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


def add_verify(commands):
    """`verify`: the analytic problems."""
    parser = commands.add_parser(
        "verify", help="compare the solver with exact solutions", description=verify.__doc__
    )
    parser.add_argument(
        "names", metavar="NAME", nargs="*", help="verification problems; default all"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the table as JSON")
    parser.add_argument(
        "--markdown",
        metavar="FILE",
        type=Path,
        help="write it by term of the equations, for a page",
    )
    add_force(parser)
    parser.set_defaults(command=verify)


def verify(arguments):
    """Solve flows with an exact solution on several grids; print errors and orders (0: all pass)."""
    from fvcollapse.verification import verify as verify_problems

    rows = verify_problems(arguments.names, arguments.json, arguments.markdown, arguments.force)
    return 0 if all(row["passed"] for row in rows) else 1


def add_converge(commands):
    """`converge`: one case at several values of one numerical parameter."""
    parser = commands.add_parser(
        "converge",
        help="refine one numerical parameter; observed order and GCI of each observable",
        description=converge.__doc__,
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
    parser.add_argument(
        "--workers", metavar="N", type=whole_number, default=1, help="processes; default 1"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    parser.set_defaults(command=converge)


def converge(arguments):
    """Run a case at three or more values of one parameter; print and write the convergence."""
    from fvcollapse.case.case import load_case

    case = load_case(arguments.case, arguments.overrides)
    from fvcollapse.output.question import claim_file
    from fvcollapse.studies.refinement import AXES, refine
    from fvcollapse.studies.refinement_report import NAME, table, write_report

    axis = next(name for name in AXES if getattr(arguments, name) is not None)
    values = getattr(arguments, axis)
    folder = arguments.out or Path("out") / f"{arguments.case.stem}_{axis}"
    claim_file(arguments.json, arguments.force, copy_of=folder / f"{NAME}.json")
    records = refine(
        case,
        axis,
        values,
        folder,
        workers=arguments.workers,
        quiet=arguments.quiet,
        source=str(arguments.case),
        force=arguments.force,
    )
    paths = write_report(records, axis, case, folder, arguments.json)
    print(f"\n{table(records, axis, case)}\n")
    for path in paths:
        print(path)
    finished = next(iter(records.values()))[axis]
    return 0 if len(finished) == len(values) else 1


def add_bench(commands):
    """`bench`: what runs cost."""
    parser = commands.add_parser(
        "bench", help="measure the cost of fixed cases", description=bench.__doc__
    )
    parser.add_argument("names", metavar="NAME", nargs="*", help="cases; default all to 3 mm")
    parser.add_argument("--finest", action="store_true", help="without names: also 1.5 mm")
    parser.add_argument(
        "--effects", action="store_true", help="the cost of each effect instead; names are effects"
    )
    parser.add_argument(
        "--end", metavar="SECONDS", type=decimal_number, help="cut the collapses short"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the report as JSON")
    add_force(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    parser.set_defaults(command=bench)


def bench(arguments):
    """Run fixed cases, each in a process of its own; print times, sweeps, memory and the bound."""
    from fvcollapse.output.question import claim_file

    claim_file(arguments.json, arguments.force)
    from fvcollapse.studies.bench import run_bench, table

    with raised_interrupt():  # ends the processes of the cases
        report = run_bench(
            arguments.names,
            arguments.json,
            arguments.quiet,
            arguments.effects,
            arguments.end,
            arguments.finest,
        )
    print(table(report))
    return 0


def add_workers(parser, default=1):
    """Where many runs are made."""
    parser.add_argument(
        "--workers",
        metavar="N",
        type=whole_number,
        default=default,
        help=f"processes; default {default}",
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask scheduler, whose workers run the cases"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")


def add_sweep(commands):
    """`sweep`: the product of variations of a case."""
    parser = commands.add_parser(
        "sweep", help="run a case at all combinations of values", description=sweep.__doc__
    )
    add_case(parser)
    parser.add_argument(
        "--vary",
        dest="variations",
        metavar="section.key=a,b,c",
        action="append",
        required=True,
        help="values of one key; may be repeated",
    )
    add_workers(parser)
    add_force(parser)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, required=True, help="one folder per point inside"
    )
    parser.set_defaults(command=sweep)


def sweep(arguments):
    """Run a case at all combinations of values; continue what is there; write sweep.csv."""
    from fvcollapse.case.case import load_case

    case = load_case(arguments.case, arguments.overrides)
    from fvcollapse.studies.sweep import TABLE, parse_variation, sweep, table

    variations = {}
    for text in arguments.variations:
        key, values = parse_variation(text)
        variations.setdefault(key, []).extend(values)
    rows = sweep(
        case,
        variations,
        arguments.out,
        workers=arguments.workers,
        scheduler=arguments.scheduler,
        quiet=arguments.quiet,
        source=str(arguments.case),
        force=arguments.force,
    )
    print(table(rows))
    print(arguments.out / TABLE)
    failed = [row for row in rows if row["status"] != "complete"]
    for row in failed:
        print(f"{row['point']}: {row['problem']}", file=sys.stderr)
    return 1 if failed else 0


def add_blind(commands):
    """`blind make` and `blind score`: sealed cases with hidden causes, and the scores of answers."""
    parser = commands.add_parser(
        "blind",
        help="make sealed synthetic cases, score the answers to them",
        description="The blind check of the diagnosis.",
    )
    parts = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    add_blind_make(parts)
    add_blind_score(parts)


def add_blind_make(parts):
    """`blind make`."""
    parser = parts.add_parser("make", help="make sealed cases", description=blind_make.__doc__)
    parser.add_argument(
        "--cases", metavar="N", type=whole_number, required=True, help="number of cases"
    )
    parser.add_argument(
        "--out",
        metavar="FOLDER",
        type=Path,
        required=True,
        help="one folder per case, and the seal",
    )
    parser.add_argument(
        "--labels", metavar="FILE", type=Path, help="default <FOLDER>.labels.json, beside it"
    )
    add_workers(parser)
    parser.set_defaults(command=blind_make)


def blind_make(arguments):
    """Make experiments that hide an effect, two, none, or a cause outside the catalogue; continue them."""
    from fvcollapse.blind.make import make

    seal = make(
        arguments.cases,
        arguments.out,
        arguments.labels,
        workers=arguments.workers,
        scheduler=arguments.scheduler,
        quiet=arguments.quiet,
    )
    print(seal)
    return 0


def add_blind_score(parts):
    """`blind score`."""
    parser = parts.add_parser("score", help="score answers", description=blind_score.__doc__)
    parser.add_argument(
        "folder", metavar="FOLDER", type=Path, help="the cases, or their seal alone"
    )
    parser.add_argument("answers", metavar="ANSWERS.json", type=Path, help="answers to the cases")
    parser.add_argument("--labels", metavar="FILE", type=Path, required=True, help="sealed labels")
    parser.add_argument(
        "--against",
        metavar="FILE",
        type=Path,
        action="append",
        default=[],
        help="other answers to the same cases; may be repeated",
    )
    parser.add_argument(
        "--separability", metavar="FILE", type=Path, help="{case: d}, to score what data can tell"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write there, print a table")
    add_force(parser)
    parser.set_defaults(command=blind_score)


def blind_score(arguments):
    """Open the seal and score the answers: all scores as JSON, with intervals and baselines."""
    from fvcollapse.output.question import claim_file

    claim_file(arguments.json, arguments.force)
    from fvcollapse.blind.score import score, scores_text, table, write_scores

    scores = score(
        arguments.folder,
        arguments.answers,
        arguments.labels,
        arguments.against,
        arguments.separability,
    )
    if arguments.json is None:
        print(scores_text(scores), end="")
        return 0
    write_scores(arguments.json, scores)
    print(table(scores))
    return 0


def add_diagnose(commands):
    """`diagnose`: the gap between experiments and a model."""
    parser = commands.add_parser(
        "diagnose",
        help="where experiments and model differ, which effect causes it, how far adding it helps",
        description=diagnose.__doc__,
    )
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
    add_workers(parser, 2)
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, required=True, help="folder of the report"
    )
    add_force(parser)
    parser.set_defaults(command=diagnose)


def diagnose(arguments):
    """Compare experiments with a model and its possible effects; continue what is there; write a report."""
    from fvcollapse.diagnosis.diagnose import diagnose as diagnose_all
    from fvcollapse.diagnosis.report import FILE_NAME
    from fvcollapse.diagnosis.report.page import PAGE
    from fvcollapse.diagnosis.report.sentences import answer

    effects = arguments.effects
    report = diagnose_all(
        arguments.experiments,
        arguments.case,
        arguments.hold_out,
        None if effects is None else [name.strip() for name in effects.split(",")],
        arguments.workers,
        arguments.scheduler,
        arguments.out,
        arguments.cell_size,
        arguments.seed,
        controls=arguments.controls,
        cache=arguments.cache,
        quiet=arguments.quiet,
        force=arguments.force,
    )
    for sentence in answer(report):
        print(textwrap.fill(sentence, 100))
    print()
    ranked = sorted(report.verdict.probability.items(), key=lambda item: -item[1])
    width = max(len(name) for name, _ in ranked)
    for name, chance in ranked:
        print(f"{name:<{width}}  {chance:6.3f}")
    print(f"\n{arguments.out / FILE_NAME}\n{arguments.out / PAGE}")
    return 0


def add_import_curves(commands):
    """`import-curves`: files of a digitising tool as an experiment folder."""
    parser = commands.add_parser(
        "import-curves",
        help="make an experiment folder of digitised curves",
        description=import_curves.__doc__,
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
    parser.add_argument(
        "--set",
        dest="settings",
        metavar="section.key=value",
        action="append",
        default=[],
        help="a key of the new experiment.toml; may be repeated",
    )
    parser.add_argument(
        "--out", metavar="FOLDER", type=Path, required=True, help="experiment folder"
    )
    add_force(parser)
    parser.set_defaults(command=import_curves)


def import_curves(arguments):
    """Write digitised curves (x, y without header; any column and decimal mark) as an experiment."""
    from fvcollapse.measure.digitised import Source, missing_settings, write_experiment

    sources = [
        Source(name, path, None)
        for name, path in (("front", arguments.front), ("volume", arguments.volume))
        if path is not None
    ]
    for option, name in (("profile", "profiles"), ("interface", "interface")):
        sources += [Source(name, *timed(option, text)) for text in getattr(arguments, option)]
    units = arguments.length_unit, arguments.time_unit, arguments.volume_unit
    changes = {"settings": arguments.settings, "force": arguments.force}
    for path in write_experiment(sources, arguments.out, *units, **changes):
        print(path)
    missing = missing_settings(arguments.out)
    if missing:
        print(f"still to be filled in: {missing}")
    return 0


def timed(option, text):
    """(path, time [s]) of T=FILE."""
    time, _, path = text.partition("=")
    try:
        number = decimal_number(time)
    except ValueError:
        number = float("nan")
    if not (isfinite(number) and path):
        raise InputError("command line", f"--{option}", repr(text), "T=FILE with a time T in s")
    return Path(path), number


def add_keys(commands):
    """`keys`: the table of case keys."""
    parser = commands.add_parser(
        "keys", help="list the keys of a case file", description=keys.__doc__
    )
    parser.add_argument(
        "--experiment", action="store_true", help="those of experiment.toml instead"
    )
    parser.set_defaults(command=keys)


def keys(arguments):
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


if __name__ == "__main__":
    sys.exit(main())
