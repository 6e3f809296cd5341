"""One way to call a study, and one engine for its runs.

    python -m runs.<study>.study PART… [--data FOLDER] [--workers N] [--cell-size H]

A study names its parts and what each does. `--data` holds measured or published data that it reads, `--out`
gets what is large (runs, films, pages), `--tables` what is small and stays. What is finished is not computed
again and what was interrupted continues with the same command.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tqdm import tqdm

from fvcollapse.case.case import Case
from fvcollapse.errors import FvcollapseError, InputError, NumericalError, OutputError
from fvcollapse.output.result import open_result
from fvcollapse.output.run_folder import RESULT
from fvcollapse.studies.cache import RunCache
from fvcollapse.studies.cache_folder import default_folder
from fvcollapse.studies.members import run_member, run_members
from runs.table import RUNS, read_table, write_table

COST = "cpu_s.txt"  # CPU time of all parts of a run [s], the resumed ones added
FAILURE = "failure.txt"  # why a run failed


@dataclass(frozen=True)
class Study:
    """What a study consists of.

    Attributes
    ----------
    name : str
        Folder below `runs`.
    about : str
        Docstring of the study; its first line is shown by --help.
    parts : dict
        Part -> function (options) that does it and returns None, or lines that say what is missing.
    need_data : tuple of str
        Parts for which `--data` must be given.
    uses : tuple of str
        Of "cache" (folder of the cache of runs) and "cell_size": options beside --out, --tables, --workers.
    cell_size : float or None
        Default of `--cell-size` [m]; None: that of the part.
    all_parts : bool
        Whether no part at all means every part.
    together : callable or None
        Function (options) that does all parts that are asked for, in the place of those of `parts`.
    add_options : callable or None
        Function (parser) that adds options of this study.
    """

    name: str
    about: str
    parts: dict
    need_data: tuple = ()
    uses: tuple = ("cache", "cell_size")
    cell_size: float | None = None
    all_parts: bool = False
    together: Callable | None = None
    add_options: Callable | None = None
    tables: Path = field(init=False)

    def __post_init__(self):
        object.__setattr__(self, "tables", RUNS / self.name)


# -- the call ------------------------------------------------------------------------------------


def main(study, argv=None):
    """Do the parts of a `Study` that are asked for.

    Returns
    -------
    int
        Exit status: 0 done, 1 a run failed or is missing, 2 bad input, 130 interrupted.
    """
    try:
        options = parse(study, argv)
        missing = list(do_parts(study, options))
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("interrupted; the same command goes on", file=sys.stderr)
        return 130
    for line in missing:
        print(line, file=sys.stderr)
    return 1 if missing else 0


def do_parts(study, options):
    """Do the parts; yield a line for everything that is missing."""
    if study.together is not None:
        yield from study.together(options) or ()
        return
    for part in options.parts:
        yield from study.parts[part](options) or ()


def parse(study, argv=None):
    """The options of a call, checked.

    Raises
    ------
    InputError
    """
    parser = argparse.ArgumentParser(
        prog=f"python -m runs.{study.name}.study", description=study.about.splitlines()[0]
    )
    names = ", ".join(study.parts)
    about = f"of {names}" + ("; default all" if study.all_parts else "")
    parser.add_argument("parts", metavar="PART", nargs="*", help=about)
    out = Path("out") / study.name
    where = {"type": Path, "metavar": "FOLDER"}
    if study.need_data:
        parser.add_argument("--data", **where, help="data that the study reads")
    parser.add_argument("--out", **where, default=out, help=f"runs, films, pages; {out}")
    parser.add_argument("--tables", **where, default=study.tables, help="tables and reports")
    if "cache" in study.uses:
        parser.add_argument("--cache", **where, help="folder of the cache of runs")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes; default 2")
    if "cell_size" in study.uses:
        words = "that of the part" if study.cell_size is None else f"{study.cell_size:g}"
        parser.add_argument("--cell-size", type=float, metavar="H", help=f"[m]; default {words}")
    parser.set_defaults(data=None, cache=None, cell_size=study.cell_size)
    if study.add_options is not None:
        study.add_options(parser)
    options = parser.parse_args(argv)
    options.parts = options.parts or (list(study.parts) if study.all_parts else [])
    check(study, options)
    return options


def check(study, options):
    """Refuse parts that do not exist, and values out of range."""
    wrong = [part for part in options.parts if part not in study.parts]
    if wrong or not options.parts:
        refuse("PART", wrong[0] if wrong else "none", ", ".join(study.parts))
    if options.workers < 1:
        refuse("--workers", f"{options.workers}", "a whole number >= 1")
    size = options.cell_size
    if size is not None and not 0.0 < size < math.inf:
        refuse("--cell-size", f"{size:g}", "a number > 0, finite")
    needing = [part for part in options.parts if part in study.need_data]
    if needing and options.data is None:
        refuse("--data", "none", f"the folder of the data that {needing[0]} reads")
    if options.data is not None and not options.data.is_dir():
        refuse("--data", f"{options.data}", "a folder")


def refuse(key, found, allowed):
    """Raise the `InputError` of an option."""
    raise InputError("command line", key, found, allowed)


def one_of(key, names):
    """The function that reads one of some names of an option; any other is refused."""

    def read(name):
        if name not in names:
            refuse(key, name, ", ".join(names))
        return name

    return read


# -- the runs ------------------------------------------------------------------------------------


def run_in_folders(cases, workers):
    """Run what is not finished of {folder: Case}, the costliest first, with a bar.

    A run that fails is left as it is, and `failure.txt` beside it says why; the others go on. The next
    call tries again from its last checkpoint.

    Raises
    ------
    OutputError, KeyboardInterrupt
        What is finished is kept; the next call continues.
    """
    for parent in {Path(folder).parent for folder in cases}:
        try:
            parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(parent, error, running=False) from None
    # with several workers, run_members starts from the end
    order = sorted(cases, key=lambda folder: expense(cases[folder]), reverse=workers == 1)
    with tqdm(total=len(cases), unit="run", smoothing=0.0) as bar:

        def tell(line):
            bar.set_postfix_str(Path(line.removesuffix(": done")).name, refresh=False)
            bar.update()

        ordered = {folder: cases[folder] for folder in order}
        run_members(ordered, max(1, min(workers, len(cases))), run=run_one, tell=tell)


def run_one(case, folder, quiet=True):
    """Run a case into its folder, or continue it, and add its CPU time to `cpu_s.txt`."""
    start, folder = time.process_time(), Path(folder)
    try:
        run_member(case, folder, quiet)
        (folder / FAILURE).unlink(missing_ok=True)
    except NumericalError as error:
        (folder / FAILURE).write_text(f"{error}\n", encoding="utf-8")
    finally:
        if folder.is_dir():
            spent = cost(folder) + time.process_time() - start
            (folder / COST).write_text(f"{spent:.2f}\n", encoding="utf-8")


def expense(case):
    """What a run costs, in any unit: time steps, cells, and band of the matrix."""
    steps = case.time.end * (1.0 + 0.0034 / case.grid.cell_size)
    return steps * case.grid.cell_size**-2.5 * (1.0 + case.geometry.slope_angle_deg / 10.0)


def cost(folder):
    """CPU time spent on a run so far [s]."""
    path = Path(folder) / COST
    return float(path.read_text(encoding="utf-8")) if path.exists() else 0.0


def finished_run(folder):
    """(Result, "") of a run that reached its end, else (None, a line that says why there is none)."""
    folder = Path(folder)
    try:
        result = open_result(folder / RESULT)
    except InputError as error:
        return None, str(error)
    if result.complete:
        return result, ""
    failure = folder / FAILURE
    reason = failure.read_text(encoding="utf-8").strip() if failure.exists() else "see its run.log"
    return None, f"{folder}: stopped at t = {result.time[-1]:.3f} s: {reason}"


def run_settings(path, settings, folder, workers):
    """Run the cases that are missing in a table, for a study whose cases are changes of the default case.

    Parameters
    ----------
    path : Path
        Table with a column `name`.
    settings : dict
        Name -> {key: value}.
    folder : Path
        Of the runs, one folder each.
    workers : int

    Yields
    ------
    name, first, result, problem
        `first` are the first cells of a row (name and settings); result and problem see `finished_run`.
    """
    done = {row["name"] for row in read_table(path)}
    cases = {name: Case().replace(**keys) for name, keys in settings.items() if name not in done}
    run_in_folders({folder / name: case for name, case in cases.items()}, workers)
    for name in cases:
        first = {"name": name, "settings": json.dumps(settings[name])}
        yield name, first, *finished_run(folder / name)


def add_rows(path, rows):
    """Add rows to a table that has a column `name`; a row of the same name is replaced."""
    table = {row["name"]: row for row in read_table(path)} | {row["name"]: row for row in rows}
    if table:
        write_table(path, table.values())


def run_cached(cases, options):
    """{name: Result} of {name: Case} through the cache of runs; results are thinned (see `fvcollapse.studies.cache`).

    Raises
    ------
    NumericalError
        A run failed; it is named.
    """
    cache = RunCache(options.cache or default_folder())
    runs = cache.run_all(cases, options.workers, quiet=False)
    for name, error in runs.failures.items():
        raise NumericalError(f"{name}: {error.what}", error.where, error.time)
    return runs.results
