"""The paper, figure by figure: run every case, write the tables, the statements and the figures.

    python -m runs.paper.study [--workers 2] [--data out/paper] [--cell-size 0.006] [GROUP …]

Each run goes into its own folder below --data. What is finished there is not run again and what was
interrupted continues, so the same command goes on after a stop; give another folder after a change
of the solver. The tables, `runs/paper/<group>/*.csv`, are written from the folders at the end, then
`statements.csv`, `statements.md` and the figures `plots/figures/paper_*`. Groups: all, or those
that are named.
"""

import argparse
import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from pathlib import Path

from tqdm import tqdm

from fvcollapse.errors import FvcollapseError, InputError, OutputError
from fvcollapse.members import run_members
from runs.paper import tables
from runs.paper.cases import GROUPS, runs
from runs.paper.members import rows_of_run, run_one


def main(argv=None):
    """Run the study; return the exit status: 0 done, 1 some run failed, 2 bad input, 130 stopped."""
    try:
        arguments = parse(argv)
        wanted = runs(arguments.groups or GROUPS, arguments.cell_size)
        compute(wanted, arguments.data, arguments.workers)
        missing = write_tables(wanted, arguments.data, arguments.tables, arguments.workers)
        if not arguments.no_figures:
            draw_conclusions(arguments.tables)
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("interrupted; the same command goes on", file=sys.stderr)
        return 130
    for line in missing:
        print(line, file=sys.stderr)
    return 1 if missing else 0


def parse(argv):
    """The arguments, checked."""
    parser = argparse.ArgumentParser(
        prog="python -m runs.paper.study", description=__doc__.split("\n")[0]
    )
    parser.add_argument(
        "groups", metavar="GROUP", nargs="*", help=f"of {', '.join(GROUPS)}; default all"
    )
    parser.add_argument("--workers", type=int, default=2, help="processes; default 2")
    parser.add_argument("--data", type=Path, default=Path("out/paper"), help="folder of the runs")
    parser.add_argument("--cell-size", type=float, default=0.006, help="coarsest cells [m]; 0.006")
    parser.add_argument("--tables", type=Path, default=tables.HERE, help="folder of the tables")
    parser.add_argument("--no-figures", action="store_true", help="stop after the tables")
    arguments = parser.parse_args(argv)
    for group in arguments.groups:
        if group not in GROUPS:
            raise InputError("command line", "GROUP", group, ", ".join(GROUPS))
    if arguments.workers < 1:
        raise InputError("command line", "--workers", f"{arguments.workers}", "a whole number >= 1")
    return arguments


def compute(wanted, data, workers):
    """Run what is not finished, the costliest first, with a bar over the runs."""
    try:
        data.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(data, error, running=False) from None
    # run_members starts from the end
    order = sorted(wanted, key=lambda run: expense(wanted[run][-1]), reverse=workers == 1)
    cases = {data / run: wanted[run][-1] for run in order}
    with tqdm(total=len(cases), unit="run", smoothing=0.0) as bar:

        def tell(line):
            bar.set_postfix_str(Path(line.removesuffix(": done")).name, refresh=False)
            bar.update()

        run_members(cases, min(workers, len(cases)), run=run_one, tell=tell)


def expense(case):
    """What a run costs, in any unit: time steps, cells, and band of the matrix."""
    steps = case.time.end * (1.0 + 0.0034 / case.grid.cell_size)
    return steps * case.grid.cell_size**-2.5 * (1.0 + case.geometry.slope_angle_deg / 10.0)


def write_tables(wanted, data, folder, workers):
    """Write the tables of all groups that were asked for; return a line for each run that is missing."""
    missing, of_group = [], {}
    for (group, *_), (row, lines, problem) in zip(
        wanted.values(), extracted(wanted, data, workers), strict=True
    ):
        if problem:
            missing.append(problem)
            continue
        found, curve_lines = of_group.setdefault(group, ([], []))
        found.append(row)
        curve_lines += lines
    for group, (found, curve_lines) in of_group.items():
        tables.write(folder / group / tables.SCALARS, tuple(found[0]), found)
        tables.write(folder / group / tables.CURVES, tables.HEAD, curve_lines)
    return missing


def extracted(wanted, data, workers):
    """What `rows_of_run` gives for each run, in their order, with a bar."""
    jobs = [(data / run, *about) for run, about in wanted.items()]
    with ExitStack() as stack:
        bar = stack.enter_context(tqdm(total=len(jobs), unit="table row"))
        over = map
        if workers > 1:
            pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"))
            over = stack.enter_context(pool).map
        for found in over(rows_of_run, jobs):
            bar.update()
            yield found


def draw_conclusions(folder):
    """Statements and figures from the tables alone."""
    from plots import paper
    from runs.paper import statements

    statements.main(folder)
    paper.main(folder)


if __name__ == "__main__":
    sys.exit(main())
