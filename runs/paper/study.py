"""The paper, figure by figure: run every case, write the tables and the statements.

    python -m runs.paper.study [PART …] [--workers 2] [--cell-size 0.006] [--finest 3]

A part is a group of cases, on the bed on which grains slide or on a rough one (`rough/<group>`,
`rough_thin_layer/<group>`), or `finer`: cases behind a statement that cannot be told, on finer grids until it is
decided or the grid is --finest times finer. `slow_phase` and `volume` are searches with tables of their own. Default
all. The runs stay below --out. The tables, `runs/paper/<part>/*.csv` (of `finer` also `<bed>/finer`), are written from
them, then `statements.csv` and `statements.md`. The figures follow from the tables: `python -m plots.paper`. Give
another --out after a change of the solver.
"""

import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial

from tqdm import tqdm

from runs.paper import statements
from runs.paper.beds import BEDS, FINER, finer_runs, parts, runs
from runs.paper.cases import SENSITIVITIES
from runs.paper.finer import finer
from runs.paper.members import rows_of_run
from runs.paper.slow_phase import search as search_slow_phase
from runs.paper.volume import search as search_volume
from runs.study import Study, run_in_folders
from runs.study import main as call
from runs.table import CURVE, CURVES, LABELS, RUN, SCALARS, write_table

MOST, FINEST = 80, 3.0  # runs of finer, and the largest refinement that they have
SEARCHES = {
    "slow_phase": search_slow_phase,
    "volume": search_volume,
}  # no statement reads their tables


def do_parts(options):
    """Run what is asked for, and write all that follows; return a line for each missing run."""
    missing = do_groups(options) if set(options.parts) - set(SEARCHES) else []
    return missing + [
        line for part in SEARCHES if part in options.parts for line in SEARCHES[part](options)
    ]


def do_groups(options):
    """Run the groups of cases, and write tables and statements; return a line for each missing run."""
    wanted = runs(options.parts, options.cell_size)
    missing = run_and_write(wanted, options) if wanted else []
    if FINER in options.parts:
        for bed in BEDS:  # chosen anew
            write_table(options.tables / bed / FINER / SCALARS, [], RUN)
            write_table(options.tables / bed / FINER / CURVES, [], (*RUN, *CURVE))
    settled, tables = statements.main(options.tables)
    return missing + (refine(settled, tables, options) if FINER in options.parts else [])


def refine(settled, tables, options):
    """Run the cases behind statements that cannot be told on finer and finer grids; return what is missing."""
    chosen, missing = [], []
    while True:
        more = [key for key in finer(settled, tables, options.finest) if key not in chosen]
        more = more[: max(0, options.most - len(chosen))]
        if not more:
            return missing
        chosen += more
        missing = run_and_write(finer_runs(chosen, options.cell_size), options)
        settled, tables = statements.main(options.tables)


def run_and_write(wanted, options):
    """Run what is not finished, and write the tables; return a line for each missing run."""
    run_in_folders({options.out / at: run.case for at, run in wanted.items()}, options.workers)
    return write_tables(wanted, options)


def write_tables(wanted, options):
    """Write the tables of the groups; return a line for each run that is missing."""
    missing, of_group = [], {}
    found = extracted(wanted, options.out, options.workers)
    for run, (row, lines, problem) in zip(wanted.values(), found, strict=True):
        if problem:
            missing.append(problem)
            continue
        numbers, curves = of_group.setdefault((run.bed, run.group), ([], []))
        numbers.append(row)
        curves += lines
    for (bed, group), (numbers, curves) in of_group.items():
        write_table(options.tables / bed / group / SCALARS, numbers)
        write_table(options.tables / bed / group / CURVES, curves, (*RUN, *CURVE))
        if group == "sensitivity":
            write_labels(options.tables / group / LABELS)
    return missing


def write_labels(path):
    """Write what each case of the sensitivities changes, in words."""
    rows = (
        {"case": f"{name}_a22_winf", "label": words} for name, (words, _) in SENSITIVITIES.items()
    )
    write_table(path, rows)


def extracted(wanted, out, workers):
    """What `rows_of_run` gives for each run, in their order, with a bar."""
    jobs = [(out / at, run) for at, run in wanted.items()]
    with ExitStack() as stack:
        bar = stack.enter_context(tqdm(total=len(jobs), unit="table row"))
        over = map
        if workers > 1:
            pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"))
            over = stack.enter_context(pool).map
        for found in over(rows_of_run, jobs):
            bar.update()
            yield found


def add_options(parser):
    """Add the option of this study."""
    parser.add_argument(
        "--finest",
        type=float,
        default=FINEST,
        metavar="R",
        help=f"cell size over that of the finest grid that may be chosen; default {FINEST:g}",
    )
    parser.add_argument(
        "--most",
        type=int,
        default=MOST,
        metavar="N",
        help=f"runs of finer, those nearest to a decision first; default {MOST}",
    )


STUDY = Study(
    "paper",
    __doc__,
    dict.fromkeys([*parts(), FINER, *SEARCHES]),
    uses=("cell_size",),
    cell_size=0.006,
    all_parts=True,
    together=do_parts,
    add_options=add_options,
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
